/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Starting and stopping a target; what core 0 does for it.
 */
#include "../../../families/rp2/src/parts.h"
#include "epg/port.h"
#include "epg/serve.h"

/** Bytes at the bottom of core 0's stack that its guard may cover, rounded up to where the MPU can begin. */
#define GUARD 64U
/** Bytes below the stack pointer that painting must leave alone: it runs there. */
#define IN_USE 128U
/** How often stacks are looked at. */
#define STACKS_PERIOD_US 250000U

static const epg_pico_target_t *running;
static epg_pico_error_t error;
static epg_fault_t fault;

/** Once per reset, before anything else has a chance to change what tells. */
static void __attribute__((constructor)) ask_for_the_cause_of_the_reset(void)
{
    fault = epg_pico_fault_before_reset();
}

static void report_stacks(void)
{
    epg_pico_status_t status;
    epg_pico_status(&status);
    epg_control_t *control = running->target->control;
    epg_control_report_stack(control, EPG_STACK_CONTROL, status.control_stack_used, status.control_stack_size);
    epg_control_report_stack(control, EPG_STACK_COMMUNICATION, status.service_stack_used, status.service_stack_size);
}

/** One turn of the communication side. */
static void serve(void)
{
    static uint32_t stacks_us;
    static bool reported;
    const epg_pico_target_t *pico = running;
    epg_control_alive(pico->target->control);
    epg_serve(pico->target->middleware, pico->transport);
    epg_serve(pico->target->console, pico->console_transport);
    const uint32_t now_us = timer_hw->timerawl;
    if (!reported || now_us - stacks_us >= STACKS_PERIOD_US) {
        reported = true;
        stacks_us = now_us;
        report_stacks();
    }
}

void epg_pico_serve_others(void (*rest)(void))
{
    const epg_pico_target_t *pico = running;
    const epg_transport_t *transport = pico->transport;
    epg_serve_flush(transport);
    rest();
    epg_control_alive(pico->target->control);
    epg_serve(NULL, transport);
    epg_serve(pico->target->console, pico->console_transport);
}

static void paint_main_stack(void)
{
    static bool painted;
    if (!painted) {
        const uint32_t *here = (const uint32_t *)__builtin_frame_address(0);
        epg_pico_stack_paint(epg_pico_main_stack.bottom + GUARD / sizeof(uint32_t), here - IN_USE / sizeof(uint32_t));
        painted = true;
    }
}

static epg_pico_error_t start(const epg_pico_target_t *pico)
{
    if (running != NULL) {
        return EPG_PICO_ERROR_RUNNING;
    }
    if (epg_pico_core1_taken()) {
        return EPG_PICO_ERROR_CORE_TAKEN;
    }
    paint_main_stack();
    epg_pico_guard_faults();
    if (!epg_serve_start_transport(pico->transport, pico->transport_title) ||
        !epg_serve_start_transport(pico->console_transport, "EPG console")) {
        return EPG_PICO_ERROR_RESOURCE;
    }
    const epg_pico_error_t failed = epg_pico_control_start(pico, fault);
    if (failed != EPG_PICO_OK) {
        return failed;
    }
    epg_serve_start_middleware(pico->target, pico->target->middleware, pico->transport);
    epg_serve_start_middleware(pico->target, pico->target->console, pico->console_transport);
    running = pico;
    if (!epg_pico_service_start(serve)) {
        epg_pico_control_stop();
        running = NULL;
        return EPG_PICO_ERROR_RESOURCE;
    }
    return EPG_PICO_OK;
}

void epg_pico_report(epg_pico_error_t problem)
{
    error = problem;
}

bool epg_pico_start(const epg_pico_target_t *pico)
{
    error = start(pico);
    return error == EPG_PICO_OK;
}

bool epg_pico_stop(void)
{
    if (running == NULL) {
        return true;
    }
    if (!epg_pico_service_stop()) {
        error = EPG_PICO_ERROR_CALLER;
        return false;
    }
    epg_pico_control_stop();
    running = NULL;
    return true;
}

void epg_pico_status(epg_pico_status_t *status)
{
    const epg_pico_stack_t *control = &epg_pico_control_stack;
    const epg_pico_stack_t *main_stack = &epg_pico_main_stack;
    *status = (epg_pico_status_t){
        .error = error,
        .after_watchdog = fault != EPG_FAULT_NONE,
        .control_stack_size = (uint32_t)((uintptr_t)control->top - (uintptr_t)control->bottom),
        .control_stack_used = epg_pico_stack_used(control, 0),
        .main_stack_size = (uint32_t)((uintptr_t)main_stack->top - (uintptr_t)main_stack->bottom),
        .main_stack_used = epg_pico_stack_used(main_stack, GUARD),
    };
    epg_pico_service_stack(&status->service_stack_size, &status->service_stack_used);
    const epg_transport_t *transport = running == NULL ? NULL : running->transport;
    if (transport != NULL && transport->lost != NULL) {
        status->transport_lost = transport->lost(transport->stream.context);
    }
}
