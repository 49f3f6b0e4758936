/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Starts and stops a target, and runs its communication side.
 */
#include "epg/family.h"
#include "epg/serve.h"

/**
 * Bytes at the bottom of the main stack that a guard region of the MPU may cover, including the alignment of the
 * region.  A write there would be a fault.
 */
#define GUARD 64U
/** Bytes below the stack pointer that must not be painted: the painting function uses them as its own stack. */
#define IN_USE 128U
/** Time between two measurements of the stacks. */
#define STACKS_PERIOD_US 250000U
/** Time between two calls of epg_family_check_running(). */
#define CHECK_PERIOD_US 1000000U

static const epg_family_target_t *running;
static epg_mcu_error_t error;
static epg_mcu_error_t transport_error;
static epg_mcu_clock_t wrong_clock;
static epg_mcu_priority_t wrong_priority;
static epg_fault_t fault;

/** Runs before main(), once per reset: later code may change the registers that hold the cause of the reset. */
static void __attribute__((constructor)) ask_for_the_cause_of_the_reset(void)
{
    fault = epg_family_fault_before_reset();
}

static void report_stacks(void)
{
    epg_mcu_status_t status;
    epg_mcu_status(&status);
    epg_control_t *control = running->target->control;
    epg_control_report_stack(control, EPG_STACK_CONTROL, status.control_stack_used, status.control_stack_size);
    epg_control_report_stack(control, EPG_STACK_COMMUNICATION, status.service_stack_used, status.service_stack_size);
}

/** One turn of the communication side; called at least once per millisecond. */
static void serve(void)
{
    static uint32_t stacks_us;
    static uint32_t checked_us;
    static bool reported;
    const epg_family_target_t *chip = running;
    epg_control_alive(chip->target->control);
    epg_serve(chip->target->middleware, chip->transport);
    epg_serve(chip->target->console, chip->console_transport);
    const uint32_t now_us = epg_family_time_us();
    if (!reported || now_us - stacks_us >= STACKS_PERIOD_US) {
        reported = true;
        stacks_us = now_us;
        report_stacks();
    }
    if (now_us - checked_us >= CHECK_PERIOD_US) {
        checked_us = now_us;
        epg_family_check_running();
    }
}

void epg_mcu_serve_others(void (*rest)(void))
{
    const epg_family_target_t *chip = running;
    const epg_transport_t *transport = chip->transport;
    epg_serve_flush(transport);
    rest();
    epg_control_alive(chip->target->control);
    epg_serve(NULL, transport);
    epg_serve(chip->target->console, chip->console_transport);
}

static void paint_main_stack(void)
{
    static bool painted;
    if (!painted) {
        const uint32_t *here; /* in a task of FreeRTOS, the stack pointer in use is not that of the main stack, MSP */
        __asm volatile("mrs %0, msp" : "=r"(here));
        epg_mcu_stack_paint(epg_family_main_stack.bottom + GUARD / sizeof(uint32_t), here - IN_USE / sizeof(uint32_t));
        painted = true;
    }
}

static epg_mcu_error_t start(const epg_family_target_t *chip)
{
    if (running != NULL) {
        return EPG_MCU_ERROR_RUNNING;
    }
    const epg_mcu_error_t impossible = epg_family_check_start(chip);
    if (impossible != EPG_MCU_OK) {
        return impossible;
    }
    paint_main_stack();
    epg_family_guard_faults();
    transport_error = EPG_MCU_ERROR_RESOURCE;
    if (!epg_serve_start_transport(chip->transport, chip->transport_title) ||
        !epg_serve_start_transport(chip->console_transport, "EPG console")) {
        return transport_error;
    }
    const epg_mcu_error_t failed = epg_family_control_start(chip, fault);
    if (failed != EPG_MCU_OK) {
        return failed;
    }
    epg_serve_start_middleware(chip->target, chip->target->middleware, chip->transport);
    epg_serve_start_middleware(chip->target, chip->target->console, chip->console_transport);
    running = chip;
    if (!epg_mcu_service_start(serve)) {
        epg_family_control_stop();
        running = NULL;
        return EPG_MCU_ERROR_RESOURCE;
    }
    return EPG_MCU_OK;
}

void epg_mcu_report(epg_mcu_error_t problem)
{
    error = problem;
}

void epg_mcu_refuse(epg_mcu_error_t reason)
{
    transport_error = reason;
}

bool epg_mcu_check_clock(const char *name, uint32_t expected_hz, uint32_t found_hz)
{
    if (found_hz != expected_hz) {
        wrong_clock = (epg_mcu_clock_t){.name = name, .expected_hz = expected_hz, .found_hz = found_hz};
        return false;
    }
    return true;
}

const epg_mcu_clock_t *epg_mcu_wrong_clock(void)
{
    return &wrong_clock;
}

void epg_mcu_report_priority(epg_mcu_priority_t priority)
{
    wrong_priority = priority;
}

const epg_mcu_priority_t *epg_mcu_wrong_priority(void)
{
    return &wrong_priority;
}

bool epg_mcu_start(const epg_family_target_t *chip)
{
    wrong_clock = (epg_mcu_clock_t){0};
    wrong_priority = (epg_mcu_priority_t){0};
    error = start(chip);
    return error == EPG_MCU_OK;
}

bool epg_mcu_stop(void)
{
    if (running == NULL) {
        return true;
    }
    if (!epg_mcu_service_stop()) {
        error = EPG_MCU_ERROR_CALLER;
        return false;
    }
    epg_family_control_stop();
    running = NULL;
    return true;
}

void epg_mcu_status(epg_mcu_status_t *status)
{
    const epg_mcu_stack_t *control = &epg_family_control_stack;
    const epg_mcu_stack_t *main_stack = &epg_family_main_stack;
    *status = (epg_mcu_status_t){
        .error = error,
        .after_watchdog = fault != EPG_FAULT_NONE,
        .control_stack_size = (uint32_t)((uintptr_t)control->top - (uintptr_t)control->bottom),
        .control_stack_used = epg_mcu_stack_used(control, 0),
        .main_stack_size = (uint32_t)((uintptr_t)main_stack->top - (uintptr_t)main_stack->bottom),
        .main_stack_used = epg_mcu_stack_used(main_stack, GUARD),
    };
    epg_mcu_service_stack(&status->service_stack_size, &status->service_stack_used);
    const epg_transport_t *transport = running == NULL ? NULL : running->transport;
    if (transport != NULL && transport->lost != NULL) {
        status->transport_lost = transport->lost(transport->stream.context);
    }
}
