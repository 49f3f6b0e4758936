/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The control loop on core 1: one control cycle in each wrap interrupt of a reserved PWM slice.
 *
 * Tick: the tick's slice and the slices of the outputs start with one write to a register, and do not stop while the
 * target runs.  If the control period is a whole number of PWM periods, each tick comes at a wrap of the outputs'
 * slices.  A level that a cycle writes takes effect at the next wrap of its slice (RP2040 data sheet 4.5.2.6: TOP and
 * CC are taken over at the wrap).  The counter repeats by itself, so a tick can be late but is never lost.
 *
 * Isolation: the interrupt is enabled on core 1 only.  Core 1 has its own vector table and sleeps between ticks, so no
 * handler that core 0 installs can run there.
 *
 * Missed ticks: two wraps before one interrupt look the same as one wrap.  The microsecond timer shows how many there
 * were.
 *
 * Requests of core 0 (to stop, or to keep out of flash) are answered after the outputs of a cycle.
 */
#include <string.h>

#include "epg/port.h"
#include "epg/ticks.h"
#include "parts.h"

#if PICO_RP2040
#define WRAP_IRQ PWM_IRQ_WRAP
#define WRAP_ENABLE (&pwm_hw->inte)
#else
/* RP2350 has two wrap interrupts.  The SDK's pwm_set_irq_enabled(), and so most programs, use number 0. */
#define WRAP_IRQ PWM_IRQ_WRAP_1
#define WRAP_ENABLE (&pwm_hw->irq_ctrl[1].inte)
#endif

/**
 * Bytes of core 1's stack; epg_pico_status() reports how many have been used.  528 bytes were measured on RP2040 with
 * JIWY, all commands of the console, and USB flooded.  The rest is for models that need more: the memory bank SCRATCH_X
 * contains nothing else.
 */
#ifndef EPG_PICO_CONTROL_STACK_SIZE
#define EPG_PICO_CONTROL_STACK_SIZE 3072
#endif

/** Milliseconds without a control cycle after which the watchdog resets the chip; at least four control periods. */
#ifndef EPG_PICO_WATCHDOG_MS
#define EPG_PICO_WATCHDOG_MS 100
#endif

/** The longest write to flash.  If core 1 must wait longer, it no longer feeds the watchdog. */
#define HOLD_LIMIT_US 5000000U

/** Core 1 must have started all peripherals within this time, or have stopped. */
#define START_TIMEOUT_US 500000U

/** Resolution of the microsecond timer: the difference of two readings is off by up to this time. */
#define TIMER_NS 1000

/* Erratum RP2040-E1: the watchdog of the RP2040 counts twice per microsecond. */
#if PICO_RP2040
#define WATCHDOG_STEPS_PER_US 2U
#else
#define WATCHDOG_STEPS_PER_US 1U
#endif

#define VECTORS (16U + NUM_IRQS)

typedef enum state { STATE_OFF, STATE_STARTING, STATE_FAILED, STATE_RUNNING, STATE_STOPPING, STATE_STOPPED } state_t;

static atomic_uint state;

/*
 * A hold: core 0 asks core 1 to wait in RAM while flash is written.  Each of the two words has one writer, so no lock
 * is needed.  A request is a number, 0 for none.  Its answer is (request << 1) | granted.
 */
static atomic_uint hold_request; /* written by core 0 */
static atomic_uint hold_answer;  /* written by core 1 */

static struct {
    const epg_pico_target_t *pico;
    epg_control_t *control;
    const epg_application_t *application;
    epg_mcu_ticks_t ticks;
    uint32_t tick_bit;
    uint32_t watchdog_load; /* value of the LOAD register; 0: the watchdog is off */
    uint32_t silence_limit; /* control cycles without a turn of the communication side */
    epg_fault_t fault;      /* fault that ended the run before the last reset */
} loop;

/* Aligned to a power of two, as VTOR requires; 512 bytes are enough for the tables of both chips. */
static exception_handler_t vectors[VECTORS] __attribute__((aligned(512)));
static_assert(sizeof vectors <= 512, "the alignment of a vector table");

/* The SDK's linker scripts put this section at the end of SCRATCH_X, a memory bank that core 0 does not use. */
static uint32_t stack[EPG_PICO_CONTROL_STACK_SIZE / sizeof(uint32_t)]
    __attribute__((section(".stack1.epg"), aligned(32)));
const epg_mcu_stack_t epg_family_control_stack = {.bottom = stack, .top = stack + sizeof stack / sizeof stack[0]};

/* The tick ------------------------------------------------------------------------------------------------------ */

static inline void feed_watchdog(void)
{
    if (loop.watchdog_load > 0U) {
        watchdog_hw->load = loop.watchdog_load;
    }
}

static inline uint32_t pass_ticks(uint64_t now_ns)
{
    return epg_mcu_ticks_pass(&loop.ticks, now_ns, TIMER_NS);
}

/** Waits in RAM while core 0 writes to flash.  The target is disabled, so its outputs are safe and stay safe. */
static void __not_in_flash_func(wait_in_hold)(uint32_t request)
{
    const uint32_t begin_us = timer_hw->timerawl;
    while (atomic_load(&hold_request) == request) {
        if (timer_hw->timerawl - begin_us < HOLD_LIMIT_US) {
            feed_watchdog();
        }
    }
    /* Do not count ticks during the hold as missed: the loop was stopped on purpose. */
    pwm_hw->intr = loop.tick_bit;
    (void)pass_ticks(epg_pico_timer_us() * 1000U);
}

/** Answers a request of core 0, after the outputs of a cycle: to wait while flash is written, or to stop. */
static void __not_in_flash_func(answer)(uint32_t request)
{
    if (request != 0U && atomic_load(&hold_answer) >> 1 != request) {
        const bool granted = !loop.control->enabled;
        atomic_store(&hold_answer, request << 1 | (granted ? 1U : 0U));
        if (granted) {
            wait_in_hold(request);
        }
    }
    if (atomic_load(&state) == STATE_STOPPING) {
        loop.application->safe();
        hw_clear_bits(WRAP_ENABLE, loop.tick_bit);
        atomic_store(&state, STATE_STOPPED);
    }
}

static void __not_in_flash_func(on_wrap)(void)
{
    const epg_pico_tick_t *tick = &loop.pico->tick;
    /* Clear the interrupt before the time is read.  A later wrap then raises the interrupt again. */
    pwm_hw->intr = loop.tick_bit;
    const uint32_t count = pwm_hw->slice[tick->slice].ctr;
    const uint64_t now_ns = epg_pico_timer_us() * 1000U;
    const uint32_t passed = pass_ticks(now_ns);
    if (passed == 0U) {
        return;
    }

    /* The slice's counter shows, to one clock, how long ago its last wrap was.  It is used only if it agrees with the
     * timer: if they differ, the slice has wrapped again since the interrupt. */
    const uint32_t fine_ns = epg_pico_clocks_to_ns(count * tick->prescaler);
    const int64_t difference = (int64_t)(loop.ticks.due_ns + fine_ns - now_ns);
    const bool agree = difference > -2 * TIMER_NS && difference < 2 * TIMER_NS;
    epg_pico_cycle_clock_begin(agree ? loop.ticks.due_ns + fine_ns : now_ns);
    epg_control_cycle(loop.control, loop.ticks.due_ns, passed - 1U);
    epg_pico_cycle_clock_end();

    if (epg_control_silence(loop.control) < loop.silence_limit) {
        feed_watchdog();
    }
    const uint32_t request = atomic_load_explicit(&hold_request, memory_order_relaxed);
    if (request != 0U || atomic_load_explicit(&state, memory_order_relaxed) != STATE_RUNNING) {
        answer(request);
    }
}

/* Core 1 --------------------------------------------------------------------------------------------------------- */

/** All work of core 1 is done in the wrap interrupt.  If this were inlined, core 1 would read flash after each cycle. */
static void __attribute__((noreturn)) __no_inline_not_in_flash_func(sleep_between_ticks)(void)
{
    for (;;) {
        __wfi();
    }
}

/** Starts the slices of the tick and of the outputs.  The time is read just before: a read of flash between would take
 * microseconds, by which all ticks would seem late. */
static void __attribute__((noreturn)) __no_inline_not_in_flash_func(start_ticks)(void)
{
    loop.ticks.due_ns = epg_pico_timer_us() * 1000U;
    hw_set_bits(&pwm_hw->en, epg_pico_output_slices | loop.tick_bit);
    sleep_between_ticks();
}

static void start_watchdog(void)
{
    const uint32_t periods_ms = (uint32_t)(4 * loop.ticks.period_ns / 1000000);
    const uint32_t timeout_ms = periods_ms > EPG_PICO_WATCHDOG_MS ? periods_ms : EPG_PICO_WATCHDOG_MS;
    watchdog_enable(timeout_ms, true);
    loop.watchdog_load = timeout_ms * 1000U * WATCHDOG_STEPS_PER_US;
    const int64_t silence = (int64_t)EPG_FAMILY_SERVICE_TIMEOUT_MS * 1000000 / loop.ticks.period_ns;
    loop.silence_limit = silence < 4 ? 4U : (uint32_t)silence;
}

static void core1_main(void)
{
    memcpy(vectors, (const void *)(uintptr_t)scb_hw->vtor, sizeof vectors);
    vectors[16 + WRAP_IRQ] = on_wrap;
    scb_hw->vtor = (uintptr_t)vectors;
    epg_family_guard_faults();

    const epg_pico_tick_t *tick = &loop.pico->tick;
    epg_pico_resource_taken = false;
    epg_pico_output_slices = 0;
    epg_control_start(loop.control, loop.application);
    if (loop.fault != EPG_FAULT_NONE) {
        epg_control_fault(loop.control, loop.fault, EPG_NO_COMPONENT);
    }
    if (epg_pico_resource_taken) {
        atomic_store(&state, STATE_FAILED);
        sleep_between_ticks();
    }

    epg_pico_cycle_clock_start(loop.pico->clock);
    pwm_slice_hw_t *slice = &pwm_hw->slice[tick->slice];
    slice->csr = 0;
    slice->div = (uint32_t)tick->prescaler << PWM_CH0_DIV_INT_LSB;
    slice->top = tick->top;
    slice->ctr = 0;
    pwm_hw->intr = loop.tick_bit;
    hw_set_bits(WRAP_ENABLE, loop.tick_bit);
    irq_set_priority(WRAP_IRQ, PICO_HIGHEST_IRQ_PRIORITY);
    irq_set_enabled(WRAP_IRQ, true);
    start_watchdog();

    atomic_store(&state, STATE_RUNNING);
    start_ticks();
}

/* Core 0 --------------------------------------------------------------------------------------------------------- */

/** True if `address` is in RAM.  The control cycle must not read flash. */
static bool in_ram(uintptr_t address)
{
    return address >= SRAM_BASE && address < SRAM_END;
}

/** True if the linker script has put the control cycle into RAM.  Some of its functions and tables are checked. */
static bool placed_in_ram(const epg_application_t *application)
{
    return in_ram((uintptr_t)&epg_control_cycle) && in_ram((uintptr_t)application) &&
           in_ram((uintptr_t)application->read) && in_ram((uintptr_t)application->write) &&
           in_ram((uintptr_t)application->safe) && in_ram((uintptr_t)application->model_step);
}

/** Waits until core 1 has changed `state` from `from` to another value.  False after START_TIMEOUT_US. */
static bool wait_while(state_t from)
{
    const uint32_t begin_us = timer_hw->timerawl;
    while (atomic_load(&state) == (unsigned int)from) {
        if (timer_hw->timerawl - begin_us > START_TIMEOUT_US) {
            return false;
        }
    }
    return true;
}

epg_pico_error_t epg_family_control_start(const epg_pico_target_t *pico, epg_fault_t fault)
{
    if (atomic_load(&state) != STATE_OFF) {
        return EPG_PICO_ERROR_RUNNING;
    }
    const epg_application_t *application = pico->target->application;
    if (!placed_in_ram(application)) {
        return EPG_PICO_ERROR_PLACEMENT;
    }
    memset(&loop, 0, sizeof loop);
    loop.pico = pico;
    loop.control = pico->target->control;
    loop.application = application;
    loop.ticks.period_ns = (int64_t)application->period_ns;
    loop.tick_bit = 1U << pico->tick.slice;
    loop.fault = fault;
    atomic_store(&hold_request, 0U);
    atomic_store(&hold_answer, 0U);
    atomic_store(&state, STATE_STARTING);

    /* Core 1's accesses to memory go first.  At equal priority each access of core 0 could delay one of core 1 by a
     * clock (RP2040 data sheet 2.1.5). */
    busctrl_hw->priority = BUSCTRL_BUS_PRIORITY_PROC1_BITS;
    epg_mcu_stack_paint(epg_family_control_stack.bottom, epg_family_control_stack.top);
    __real_multicore_reset_core1();
    __real_multicore_launch_core1_with_stack(core1_main, epg_family_control_stack.bottom, sizeof stack);
    if (wait_while(STATE_STARTING) && atomic_load(&state) == STATE_RUNNING) {
        return EPG_PICO_OK;
    }
    const bool failed = atomic_load(&state) == STATE_FAILED;
    epg_family_control_stop();
    return failed ? EPG_PICO_ERROR_RESOURCE : EPG_PICO_ERROR_CORE;
}

bool epg_pico_control_runs(void)
{
    return atomic_load(&state) != STATE_OFF;
}

void epg_family_control_stop(void)
{
    if (atomic_load(&state) == STATE_OFF) {
        return;
    }
    if (atomic_load(&state) == STATE_RUNNING) {
        atomic_store(&state, STATE_STOPPING);
        (void)wait_while(STATE_STOPPING);
    }
    watchdog_disable();
    __real_multicore_reset_core1();
    hw_clear_bits(WRAP_ENABLE, loop.tick_bit);
    epg_pico_outputs_start();
    epg_pico_quadrature_stop_all();
    hw_clear_bits(&pwm_hw->en, epg_pico_output_slices | loop.tick_bit);
    atomic_store(&state, STATE_OFF);
}

bool epg_pico_control_hold(uint32_t timeout_us)
{
    static uint32_t number;
    if (atomic_load(&state) != STATE_RUNNING) {
        return !epg_pico_core1_taken(); /* if the program does not use core 1 either, no code runs there */
    }
    number = (number + 1U) & 0x7FFFFFFFU;
    const uint32_t request = number == 0U ? ++number : number;
    const uint32_t begin_us = timer_hw->timerawl;
    atomic_store(&hold_request, request);
    while (atomic_load(&hold_answer) >> 1 != request && timer_hw->timerawl - begin_us <= timeout_us) {
        tight_loop_contents();
    }
    const bool granted = atomic_load(&hold_answer) == (request << 1 | 1U);
    if (!granted) {
        atomic_store(&hold_request, 0U);
    }
    return granted;
}

void epg_pico_control_release(void)
{
    atomic_store(&hold_request, 0U);
}
