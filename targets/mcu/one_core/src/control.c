/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The control loop: one control cycle in each interrupt of the tick's timer.
 *
 * Isolation: the tick has priority 0.  Every other interrupt has a lower one, which is checked at the start and once per
 * second.  BASEPRI, by which kernels mask interrupts, cannot mask priority 0 (Armv7-M ARM, B1.4.3).  No code of EPG sets
 * PRIMASK, which masks all interrupts.
 *
 * Missed ticks: two ticks before one interrupt look the same as one tick.  The family's clock shows how many there were.
 *
 * Floating point: the core saves the registers of the FPU when the cycle uses it first, because it has interrupted code
 * that may use it, too (B1.5.7).
 */
#include "control.h"

#include <string.h>

#include "epg/port.h"

/** Bytes of the control cycle's stack; epg_mcu_status() reports how many have been used. */
#ifndef EPG_ONE_CORE_CONTROL_STACK_SIZE
#define EPG_ONE_CORE_CONTROL_STACK_SIZE 3072
#endif

/** Milliseconds without a control cycle after which the watchdog resets the chip; at least four control periods. */
#ifndef EPG_ONE_CORE_WATCHDOG_MS
#define EPG_ONE_CORE_WATCHDOG_MS 100
#endif

/** Reads of a clock that stands still after which a stop no longer waits for the tick. */
#define READS_OF_A_DEAD_CLOCK 100000U

#define MILLISECOND_NS 1000000

typedef enum state { STATE_OFF, STATE_RUNNING, STATE_STOPPING, STATE_STOPPED, STATE_ENDED } state_t;

static atomic_uint state EPG_ONE_CORE_DATA;

/** Written by the communication side, cleared by the tick. */
static atomic_bool priority_is_wrong EPG_ONE_CORE_DATA;

/** Ticks for which the watchdog is fed although the communication side is silent: it writes to flash. */
static atomic_uint held_ticks EPG_ONE_CORE_DATA;

static struct {
    epg_control_t *control;
    const epg_application_t *application;
    int32_t interrupt;
    epg_one_core_handler_t replaced; /* the handler of that interrupt before the start */
    uint32_t silence_limit;          /* control cycles without a turn of the communication side */
    uint32_t ticks_to_pend;          /* ticks per millisecond, at least 1 */
    uint32_t until_pend;
    bool first; /* no tick has come yet */
} loop EPG_ONE_CORE_DATA;

static void (*volatile pend_service)(void) EPG_ONE_CORE_DATA;

/* Used from assembler. */
__attribute__((used, aligned(8)))
uint32_t epg_one_core_control_memory[EPG_ONE_CORE_CONTROL_STACK_SIZE / sizeof(uint32_t)] EPG_ONE_CORE_DATA;

const epg_mcu_stack_t epg_family_control_stack = {
    .bottom = epg_one_core_control_memory,
    .top = epg_one_core_control_memory + EPG_ONE_CORE_CONTROL_STACK_SIZE / sizeof(uint32_t),
};

/* The tick ------------------------------------------------------------------------------------------------------ */

static inline void pend(void)
{
    void (*const call)(void) = pend_service;
    if (call != NULL && --loop.until_pend == 0U) {
        loop.until_pend = loop.ticks_to_pend;
        call();
    }
}

static inline bool communication_lives(void)
{
    const unsigned int held = atomic_load_explicit(&held_ticks, memory_order_relaxed); /* one core: no barrier */
    if (held > 0U) {
        atomic_store(&held_ticks, held - 1U);
        return true;
    }
    return epg_control_silence(loop.control) < loop.silence_limit;
}

static inline void run_cycle(uint32_t missed)
{
    if (atomic_load_explicit(&priority_is_wrong, memory_order_relaxed)) {
        atomic_store(&priority_is_wrong, false);
        epg_control_fault(loop.control, EPG_FAULT_PRIORITY, EPG_NO_COMPONENT);
    }
    epg_one_core_cycle.runs = true;
    epg_control_cycle(loop.control, epg_one_core_cycle.ticks.due_ns, missed);
    epg_one_core_cycle.runs = false;
}

/* Called from assembler, on the control stack. */
void epg_one_core_on_tick(void);

__attribute__((used)) void EPG_ONE_CORE_CODE epg_one_core_on_tick(void)
{
    const epg_family_target_t *target = epg_one_core_cycle.target;
    epg_mcu_ticks_t *ticks = &epg_one_core_cycle.ticks;
    epg_one_core_tick_clear(target); /* before the time is read: a later tick then raises the interrupt again */
    const unsigned int now = atomic_load(&state);
    if (now != STATE_RUNNING) {
        if (now == STATE_STOPPING) {
            loop.application->safe();
            atomic_store(&state, STATE_STOPPED);
        }
        return;
    }
    const uint64_t now_ns = epg_one_core_time_ns();
    if (loop.first) {
        const uint32_t since_ns = epg_one_core_tick_ns(target);
        loop.first = false;
        ticks->due_ns = now_ns - (since_ns == EPG_ONE_CORE_TICK_PASSED ? 0U : since_ns) - (uint64_t)ticks->period_ns;
    }
    const uint32_t passed = epg_mcu_ticks_pass(ticks, now_ns, EPG_ONE_CORE_TIME_NS);
    if (passed == 0U) {
        return;
    }
    run_cycle(passed - 1U);
    if (epg_mcu_stack_full(&epg_family_control_stack)) {
        epg_one_core_panic("the stack of the control cycle is too small");
    }
    if (atomic_load_explicit(&state, memory_order_relaxed) == STATE_ENDED) {
        epg_one_core_outputs_safe(); /* the program's fault handler has returned into the cycle */
    } else if (communication_lives()) {
        epg_one_core_watchdog_feed();
    }
    pend();
}

/*
 * The tick's interrupt: switches to the control stack, calls epg_one_core_on_tick(), and switches back.  Without this,
 * the cycle would run on the stack of the interrupt or of the service that it has interrupted.
 */
static void __attribute__((naked)) EPG_ONE_CORE_CODE on_tick(void)
{
    __asm__ volatile(".syntax unified\n"
                     "push {r4, lr}\n"
                     "mov r4, sp\n"
                     "ldr r0, =epg_one_core_control_memory\n"
                     "ldr r1, =%c[size]\n"
                     "add r0, r0, r1\n"
                     "mov sp, r0\n"
                     "ldr r0, =epg_one_core_on_tick\n"
                     "blx r0\n"
                     "mov sp, r4\n"
                     "pop {r4, pc}\n"
                     ".ltorg\n"
                     :
                     : [size] "i"(EPG_ONE_CORE_CONTROL_STACK_SIZE));
}
_Static_assert(EPG_ONE_CORE_CONTROL_STACK_SIZE % 8 == 0, "the alignment of a stack");

/* Start and stop --------------------------------------------------------------------------------------------------- */

/** Lets the core save the FPU's registers in every interrupt that uses it (Armv7-M ARM, B3.2.20 and B3.2.21). */
static void set_up_fpu(void)
{
#if __FPU_PRESENT && __FPU_USED
    SCB->CPACR |= 0xFU << 20U;
    __DSB();
    __ISB();
    FPU->FPCCR |= FPU_FPCCR_ASPEN_Msk | FPU_FPCCR_LSPEN_Msk;
    __DSB();
    __ISB();
#endif
}

static void start_watchdog(int64_t period_ns)
{
    const uint32_t periods_ms = (uint32_t)(4 * period_ns / MILLISECOND_NS);
    epg_one_core_watchdog_start(periods_ms > EPG_ONE_CORE_WATCHDOG_MS ? periods_ms : EPG_ONE_CORE_WATCHDOG_MS);
    const int64_t silence = (int64_t)EPG_FAMILY_SERVICE_TIMEOUT_MS * MILLISECOND_NS / period_ns;
    loop.silence_limit = silence < 4 ? 4U : (uint32_t)silence;
}

epg_mcu_error_t epg_family_control_start(const epg_family_target_t *target, epg_fault_t fault)
{
    if (atomic_load(&state) != STATE_OFF) {
        return EPG_MCU_ERROR_RUNNING;
    }
    const epg_mcu_priority_t wrong = epg_one_core_check_priorities();
    if (wrong.name != NULL) {
        epg_mcu_report_priority(wrong);
        return EPG_MCU_ERROR_PRIORITY;
    }
    const IRQn_Type interrupt = epg_one_core_tick_interrupt(target);
    if (NVIC_GetEnableIRQ(interrupt) != 0U) {
        return EPG_MCU_ERROR_RESOURCE;
    }
    const epg_application_t *application = target->target->application;
    const int64_t period_ns = (int64_t)application->period_ns;
    memset(&loop, 0, sizeof loop);
    loop.control = target->target->control;
    loop.application = application;
    loop.interrupt = (int32_t)interrupt;
    loop.first = true;
    loop.ticks_to_pend = period_ns < MILLISECOND_NS ? (uint32_t)(MILLISECOND_NS / period_ns) : 1U;
    loop.until_pend = loop.ticks_to_pend;
    epg_one_core_cycle = (epg_one_core_cycle_t){.target = target, .ticks = {.period_ns = period_ns}};
    atomic_store(&priority_is_wrong, false);
    atomic_store(&held_ticks, 0U);
    epg_mcu_stack_paint(epg_family_control_stack.bottom, epg_family_control_stack.top);
    set_up_fpu();
    (void)epg_one_core_time_ns();

    epg_control_start(loop.control, application);
    if (fault != EPG_FAULT_NONE) {
        epg_control_fault(loop.control, fault, EPG_NO_COMPONENT);
    }
    if (!epg_one_core_resources_free()) {
        epg_one_core_tick_stop(target);
        epg_one_core_outputs_safe();
        return EPG_MCU_ERROR_RESOURCE;
    }
    start_watchdog(period_ns);
    loop.replaced = epg_one_core_set_handler(interrupt, on_tick);
    NVIC_SetPriority(interrupt, 0U);
    atomic_store(&state, STATE_RUNNING);
    epg_one_core_tick_start(target);
    NVIC_ClearPendingIRQ(interrupt); /* of an old request, which the family has cleared in the timer */
    NVIC_EnableIRQ(interrupt);
    return EPG_MCU_OK;
}

/** Waits until the tick has made the outputs safe, at most four control periods.  A clock that stands still ends it, too. */
static void wait_for_tick(void)
{
    const uint64_t begin_ns = epg_one_core_time_ns();
    const uint64_t limit_ns = 4U * (uint64_t)epg_one_core_cycle.ticks.period_ns;
    uint64_t last_ns = begin_ns;
    uint32_t reads = 0;
    while (atomic_load(&state) == STATE_STOPPING && last_ns - begin_ns < limit_ns && reads < READS_OF_A_DEAD_CLOCK) {
        const uint64_t now_ns = epg_one_core_time_ns();
        reads = now_ns == last_ns ? reads + 1U : 0U;
        last_ns = now_ns;
    }
}

void epg_family_control_stop(void)
{
    unsigned int running = STATE_RUNNING;
    if (!atomic_compare_exchange_strong(&state, &running, STATE_STOPPING)) {
        return;
    }
    wait_for_tick();
    const IRQn_Type interrupt = (IRQn_Type)loop.interrupt;
    NVIC_DisableIRQ(interrupt);
    __DSB();
    __ISB();
    if (atomic_load(&state) == STATE_ENDED) {
        return;
    }
    if (atomic_load(&state) == STATE_STOPPING) {
        loop.application->safe(); /* there are no ticks: the timer does not run */
    }
    epg_one_core_tick_stop(epg_one_core_cycle.target);
    epg_one_core_outputs_safe();
    epg_one_core_watchdog_stop();
    NVIC_ClearPendingIRQ(interrupt);
    (void)epg_one_core_set_handler(interrupt, loop.replaced);
    atomic_store(&state, STATE_OFF);
}

bool epg_one_core_hold(void)
{
    if (atomic_load(&state) != STATE_RUNNING) {
        return true;
    }
    if (loop.control->enabled) {
        return false;
    }
    const int64_t ticks = (int64_t)EPG_ONE_CORE_HOLD_MS * MILLISECOND_NS / epg_one_core_cycle.ticks.period_ns;
    atomic_store(&held_ticks, (unsigned int)ticks + 1U);
    return true;
}

void epg_one_core_release(void)
{
    atomic_store(&held_ticks, 0U);
}

void epg_one_core_end(void)
{
    atomic_store(&state, STATE_ENDED);
}

void epg_family_check_running(void)
{
    const epg_mcu_priority_t wrong = epg_one_core_check_priorities();
    if (wrong.name != NULL) {
        epg_mcu_report_priority(wrong);
        atomic_store(&priority_is_wrong, true);
    }
}

int32_t epg_one_core_tick_in_use(void)
{
    const unsigned int now = atomic_load(&state);
    return now == STATE_OFF ? -16 : loop.interrupt;
}

void epg_one_core_pend_service(void (*pend_it)(void))
{
    pend_service = pend_it;
}

bool epg_one_core_slow(void)
{
    return epg_one_core_cycle.ticks.period_ns > MILLISECOND_NS;
}
