/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The control thread: a meta-IRQ thread that the tick's interrupt releases, and that runs one control cycle per tick.
 *
 * A meta-IRQ thread runs before every other thread, cooperative ones too, as soon as no interrupt is being served.
 *
 * The tick repeats by itself, so it can be late but is never lost.  The number of passed ticks follows from the time of
 * the newest one.
 *
 * The tick and the system clock may drift apart by some parts per million, because the driver of SysTick loses clocks
 * when it sets a new timeout.  The due time of a cycle is therefore the measured time of its tick, not a multiple of
 * the period.
 *
 * Other interrupts may delay the thread in some cycles.  On RP2040 and RP2350 the tick's interrupt therefore reads the
 * inputs (inputs.c), so that they are always read at the same distance from the tick.
 */
#include <string.h>

#include <zephyr/kernel.h>

#include "epg/port.h"
#include "parts.h"

BUILD_ASSERT(CONFIG_NUM_METAIRQ_PRIORITIES >= 1,
             "EPG's control thread has the highest priority: CONFIG_NUM_METAIRQ_PRIORITIES must be 1 or more");

#ifdef CONFIG_FPU_SHARING
#define THREAD_OPTIONS K_FP_REGS
#else
#define THREAD_OPTIONS 0
#endif

/** The control thread must answer a request to hold within two periods and this time. */
#define ANSWER_US 10000U

static K_THREAD_STACK_DEFINE(stack, CONFIG_EPG_CONTROL_STACK_SIZE);
static struct k_thread thread;
static K_SEM_DEFINE(ticks, 0, 1);

static struct {
    epg_control_t *control;
    const epg_application_t *application;
    uint64_t due_ns; /* time of the newest tick that was handled */
    uint64_t period_ns;
} loop;

/** The target's application, with functions of this platform in place of read() and write(). */
static epg_application_t wrapped;

static bool running; /* the thread exists */
static atomic_bool stopping;
static atomic_bool waiting; /* the thread waits for a tick */
static atomic_bool sampled; /* the newest tick has read the inputs; it does so only while `waiting` is true */

/* Holding: the communication thread requests it; the control thread answers at the next tick. */
static atomic_bool hold_requested;
static atomic_bool hold_granted;
static K_SEM_DEFINE(hold_answered, 0, 1);

void epg_zephyr_control_tick(void)
{
    const bool sample = IS_ENABLED(CONFIG_EPG_TICK_PICO_PWM) && atomic_load(&waiting);
    if (sample) {
        epg_zephyr_inputs_sample();
    }
    atomic_store(&sampled, sample);
    k_sem_give(&ticks);
}

/** The number of ticks since `loop.due_ns`.  The newest one was at `newest_ns`, and becomes the new `loop.due_ns`. */
static inline uint32_t pass_ticks(uint64_t newest_ns)
{
    const int64_t half = (int64_t)(loop.period_ns / 2U);
    const int64_t since = (int64_t)(newest_ns - loop.due_ns);
    if (since < half) {
        return 0U; /* this tick was already counted in the cycle before */
    }
    loop.due_ns = newest_ns;
    if (since < half + (int64_t)loop.period_ns) {
        return 1U;
    }
    return (uint32_t)((uint64_t)(since + half) / loop.period_ns);
}

/** True while no cycle must run.  The target is disabled then, so its outputs are safe and stay safe. */
static bool held(void)
{
    if (!atomic_load(&hold_requested)) {
        atomic_store(&hold_granted, false);
        return false;
    }
    if (!atomic_load(&hold_granted) && !loop.control->enabled) {
        atomic_store(&hold_granted, true);
        k_sem_give(&hold_answered);
    }
    return atomic_load(&hold_granted);
}

/**
 * Writes the outputs, at the output delay, with interrupts locked.  No interrupt can come between two writes, so all
 * levels take effect at the same wrap of the PWM.  It takes 3 us for JIWY, and 13 us in a cycle in which both motors
 * change their direction (RP2040 at 125 MHz).
 */
static void write_locked(void)
{
    const unsigned int key = irq_lock();
    loop.application->write();
    irq_unlock(key);
}

/** In a cycle, read() comes after requests to enable and before the outputs, which is the right place for the check. */
static void read_and_check_outputs(void)
{
    loop.application->read();
    epg_zephyr_outputs_check(loop.control);
}

/** Outputs are written with interrupts locked only if no driver can wait. */
static const epg_application_t *wrap(const epg_application_t *application)
{
    wrapped = *application;
    wrapped.read = read_and_check_outputs;
    if (epg_zephyr_outputs_are_registers()) {
        wrapped.write = write_locked;
    }
    return &wrapped;
}

static void cycle(void)
{
    uint64_t now_ns;
    const uint32_t passed = pass_ticks(epg_zephyr_tick_newest_ns(&now_ns));
    if (passed == 0U) {
        return;
    }
    if (held()) {
        epg_zephyr_watchdog_feed(0);
        return;
    }
    epg_native_sim_before_cycle(loop.due_ns);
    epg_control_cycle(loop.control, loop.due_ns, passed - 1U);
    epg_native_sim_after_cycle();
    epg_zephyr_watchdog_feed(epg_control_silence(loop.control));
}

static void run(void *first, void *second, void *third)
{
    ARG_UNUSED(first);
    ARG_UNUSED(second);
    ARG_UNUSED(third);
    for (;;) {
        atomic_store(&waiting, true);
        (void)k_sem_take(&ticks, K_FOREVER);
        atomic_store(&waiting, false);
        if (atomic_load(&stopping)) {
            loop.application->safe();
            return;
        }
        /* False after a cycle that ended late, and if another tick has come before this thread could run: then the tick
         * has not read the inputs, and the cycle reads them. */
        epg_zephyr_inputs_use(atomic_load(&sampled));
        cycle();
        epg_zephyr_inputs_use(false);
    }
}

epg_zephyr_error_t epg_zephyr_control_start(const epg_zephyr_target_t *zephyr, epg_fault_t fault)
{
    const epg_application_t *application = zephyr->target->application;
    memset(&loop, 0, sizeof loop);
    loop.control = zephyr->target->control;
    loop.application = application;
    loop.period_ns = application->period_ns;
    atomic_store(&stopping, false);
    atomic_store(&hold_requested, false);
    atomic_store(&hold_granted, false);
    atomic_store(&sampled, false);
    k_sem_reset(&ticks);

    epg_zephyr_device_refused = false;
    if (!epg_zephyr_outputs_start()) {
        return EPG_ZEPHYR_ERROR_DEVICE;
    }
    epg_native_sim_starting();
    epg_control_start(loop.control, wrap(application));
    epg_native_sim_started();
    if (fault != EPG_FAULT_NONE) {
        epg_control_fault(loop.control, fault, EPG_NO_COMPONENT);
    }
    if (epg_zephyr_device_refused) {
        return EPG_ZEPHYR_ERROR_DEVICE;
    }
    epg_zephyr_error_t error = epg_zephyr_watchdog_start(loop.period_ns);
    if (error == EPG_ZEPHYR_OK) {
        error = epg_zephyr_tick_start(&zephyr->tick, loop.period_ns);
    }
    if (error != EPG_ZEPHYR_OK) {
        epg_zephyr_watchdog_stop();
        return error;
    }
    uint64_t now_ns;
    loop.due_ns = epg_zephyr_tick_newest_ns(&now_ns);
    (void)k_thread_create(&thread, stack, K_THREAD_STACK_SIZEOF(stack), run, NULL, NULL, NULL, K_HIGHEST_THREAD_PRIO,
                          THREAD_OPTIONS, K_NO_WAIT);
    (void)k_thread_name_set(&thread, "epg_control");
    running = true;
    return EPG_ZEPHYR_OK;
}

bool epg_zephyr_control_calls(void)
{
    return running && k_current_get() == &thread;
}

void epg_zephyr_control_stop(void)
{
    if (running) {
        atomic_store(&stopping, true);
        k_sem_give(&ticks);
        (void)k_thread_join(&thread, K_FOREVER); /* this ends soon: it has a higher priority than this thread */
        epg_zephyr_tick_stop();
        epg_zephyr_watchdog_stop();
        running = false;
    }
}

bool epg_zephyr_control_hold(void)
{
    if (!running) {
        return true;
    }
    k_sem_reset(&hold_answered);
    atomic_store(&hold_requested, true);
    const uint64_t timeout_us = 2U * loop.period_ns / 1000U + ANSWER_US;
    if (k_sem_take(&hold_answered, K_USEC(timeout_us)) == 0) {
        return true;
    }
    atomic_store(&hold_requested, false);
    return false;
}

void epg_zephyr_control_release(void)
{
    atomic_store(&hold_requested, false);
}

void epg_zephyr_control_stack(uint32_t *size, uint32_t *used)
{
    *size = CONFIG_EPG_CONTROL_STACK_SIZE;
    *used = running ? epg_zephyr_stack_used(&thread, CONFIG_EPG_CONTROL_STACK_SIZE) : 0U;
}
