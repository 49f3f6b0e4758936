/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Core 1: the control cycle in the wrap interrupt of a reserved PWM slice, and nothing else.
 *
 * The tick's slice and those of the motors start with one write and never stop, so a tick comes at an exact multiple
 * of the PWM periods, and what a cycle writes takes effect at an exact one (RP2040 data sheet 4.5.2.6: TOP and CC are
 * taken over at the wrap).  Nothing re-arms the tick, so it can be late but never lost.
 *
 * The interrupt is enabled on core 1 only, which sleeps between ticks with a vector table of its own: nothing that
 * core 0 installs can run here.  Whether a tick was missed is asked of the microsecond timer, not of the PWM.
 */
#include <string.h>

#include "epg/port.h"
#include "epg/ticks.h"
#include "parts.h"

#if PICO_RP2040
#define WRAP_IRQ PWM_IRQ_WRAP
#define WRAP_ENABLE (&pwm_hw->inte)
#else
/* The SDK's pwm_set_irq_enabled() and with it most programs use the other one. */
#define WRAP_IRQ PWM_IRQ_WRAP_1
#define WRAP_ENABLE (&pwm_hw->irq_ctrl[1].inte)
#endif

/**
 * Bytes of core 1's stack; epg_pico_status() tells how many are used.  Measured on RP2040 with JIWY, all the console
 * can do, and USB flooded: 528.  The rest is for models that need more: nothing else lies in SCRATCH_X.
 */
#ifndef EPG_PICO_CONTROL_STACK_SIZE
#define EPG_PICO_CONTROL_STACK_SIZE 3072
#endif

/** Milliseconds without a control cycle until the watchdog resets the chip; several periods where those are long. */
#ifndef EPG_PICO_WATCHDOG_MS
#define EPG_PICO_WATCHDOG_MS 100
#endif

/** How long a flash write may keep core 1 waiting before the watchdog is no longer fed. */
#define HOLD_LIMIT_US 5000000U

/** Until core 1 has started all peripherals and has had its first tick, and until it has stopped. */
#define START_TIMEOUT_US 500000U

/** Two readings of the microsecond timer differ by up to this from the true time between them. */
#define TIMER_NS 1000

/* RP2040-E1: its watchdog counts twice per microsecond. */
#if PICO_RP2040
#define WATCHDOG_STEPS_PER_US 2U
#else
#define WATCHDOG_STEPS_PER_US 1U
#endif

#define VECTORS (16U + NUM_IRQS)

typedef enum state { STATE_OFF, STATE_STARTING, STATE_FAILED, STATE_RUNNING, STATE_STOPPING, STATE_STOPPED } state_t;

static atomic_uint state;

/* Each word has one writer: a request is a number (0: none), an answer is (request << 1) | granted. */
static atomic_uint hold_request; /* core 0's */
static atomic_uint hold_answer;  /* core 1's */

static struct {
    const epg_pico_target_t *pico;
    epg_control_t *control;
    const epg_application_t *application;
    epg_mcu_ticks_t ticks;
    uint32_t tick_bit;
    uint32_t watchdog_load; /* 0: off */
    uint32_t silence_limit; /* control cycles */
    epg_fault_t fault;      /* that ended the run before this one */
} loop;

/* 512 bytes hold the tables of both chips; VTOR wants a power of two. */
static exception_handler_t vectors[VECTORS] __attribute__((aligned(512)));
static_assert(sizeof vectors <= 512, "the alignment of a vector table");

/* A section of the SDK's linker scripts: at the end of SCRATCH_X, a memory bank that core 0 leaves alone. */
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

/** Waits in RAM while core 0 writes to flash.  The outputs are safe and stay so. */
static void __not_in_flash_func(wait_in_hold)(uint32_t request)
{
    const uint32_t begin_us = timer_hw->timerawl;
    while (atomic_load(&hold_request) == request) {
        if (timer_hw->timerawl - begin_us < HOLD_LIMIT_US) {
            feed_watchdog();
        }
    }
    /* Ticks of this time are not missed: nobody waited for them. */
    pwm_hw->intr = loop.tick_bit;
    (void)pass_ticks(epg_pico_timer_us() * 1000U);
}

/** After the outputs of a cycle: what core 0 has asked for. */
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
    /* Before time is read: a wrap from here on is an interrupt of its own. */
    pwm_hw->intr = loop.tick_bit;
    const uint32_t count = pwm_hw->slice[tick->slice].ctr;
    const uint64_t now_ns = epg_pico_timer_us() * 1000U;
    const uint32_t passed = pass_ticks(now_ns);
    if (passed == 0U) {
        return;
    }

    /* The counter says to a clock how long ago the wrap was, the timer says whether it is that wrap's counter. */
    const uint32_t fine_ns = epg_pico_clocks_to_ns(count * tick->prescaler);
    const int64_t difference = (int64_t)(loop.ticks.due_ns + fine_ns - now_ns);
    const bool agree = difference > -2 * TIMER_NS && difference < 2 * TIMER_NS;
    epg_pico_cycle_clock_begin(agree ? loop.ticks.due_ns + fine_ns : now_ns);
    epg_control_cycle(loop.control, loop.ticks.due_ns, passed - 1U);
    epg_pico_cycle_clock_end();

    if (epg_control_silence(loop.control) < loop.silence_limit) {
        feed_watchdog();
    }
    const uint32_t request = atomic_load(&hold_request);
    if (request != 0U || atomic_load(&state) != STATE_RUNNING) {
        answer(request);
    }
}

/* Core 1 --------------------------------------------------------------------------------------------------------- */

/** Does nothing but sleep; interrupts do the rest. */
static void __attribute__((noreturn)) __not_in_flash_func(sleep_between_ticks)(void)
{
    for (;;) {
        __wfi();
    }
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
    loop.ticks.due_ns = epg_pico_timer_us() * 1000U;
    hw_set_bits(&pwm_hw->en, epg_pico_output_slices | loop.tick_bit);
    sleep_between_ticks();
}

/* Core 0 --------------------------------------------------------------------------------------------------------- */

/** True unless `address` is in flash, which a cycle must not touch. */
static bool in_ram(uintptr_t address)
{
    return address >= SRAM_BASE && address < SRAM_END;
}

/** Whether the linker script has put the control cycle into RAM: some of its code and its tables stand for it. */
static bool placed_in_ram(const epg_application_t *application)
{
    return in_ram((uintptr_t)&epg_control_cycle) && in_ram((uintptr_t)application) &&
           in_ram((uintptr_t)application->read) && in_ram((uintptr_t)application->write) &&
           in_ram((uintptr_t)application->safe) && in_ram((uintptr_t)application->model_step);
}

/** Waits until core 1 has left `from`; false after START_TIMEOUT_US. */
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
    if (clock_get_hz(clk_sys) != pico->clock) {
        return EPG_PICO_ERROR_CLOCK;
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

    /* RP2040 data sheet 2.1.5: at equal priority core 0's flood of accesses could delay core 1's by a clock each. */
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
        return !epg_pico_core1_taken(); /* else core 1 does nothing */
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
