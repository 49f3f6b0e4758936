/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Starts and stops a target, and runs its communication side.
 */
#include <zephyr/kernel.h>
#include <zephyr/logging/log.h>

#include "epg/port.h"
#include "epg/serve.h"
#include "parts.h"

LOG_MODULE_REGISTER(epg, CONFIG_EPG_LOG_LEVEL);

/** Time between two measurements of the stacks. */
#define STACKS_PERIOD_NS 250000000U

static const epg_zephyr_target_t *running;
static epg_zephyr_error_t error;

static void report_stacks(epg_control_t *control)
{
    uint32_t size;
    uint32_t used;
    epg_zephyr_control_stack(&size, &used);
    epg_control_report_stack(control, EPG_STACK_CONTROL, used, size);
    epg_zephyr_communication_stack(&size, &used);
    epg_control_report_stack(control, EPG_STACK_COMMUNICATION, used, size);
}

/** One turn of the communication side; called at least once per millisecond. */
static void serve(void)
{
    static uint64_t stacks_ns;
    const epg_target_t *target = running->target;
    epg_control_alive(target->control);
    epg_serve(target->middleware, running->transport);
    epg_serve(target->console, running->console_transport);
    const uint64_t now_ns = epg_port_time_ns();
    if (stacks_ns == 0U || now_ns - stacks_ns >= STACKS_PERIOD_NS) {
        stacks_ns = now_ns;
        report_stacks(target->control);
    }
}

static void stop_middleware(const epg_middleware_t *middleware, const epg_transport_t *transport)
{
    if (middleware != NULL && middleware->stop != NULL) {
        middleware->stop();
        epg_serve_flush(transport);
    }
}

bool epg_zephyr_check_clock(const char *name, uint32_t expected_hz, uint32_t found_hz)
{
    if (found_hz != expected_hz) {
        LOG_ERR("%s has %u Hz, but the target was generated for %u Hz ('clocks' in its .tcf)", name, found_hz,
                expected_hz);
        return false;
    }
    return true;
}

static epg_zephyr_error_t start(const epg_zephyr_target_t *zephyr)
{
    const epg_target_t *target = zephyr->target;
    if (running != NULL) {
        return EPG_ZEPHYR_ERROR_RUNNING;
    }
    if (!epg_zephyr_devices_ready()) {
        return EPG_ZEPHYR_ERROR_DEVICE;
    }
    if (!epg_serve_start_transport(zephyr->transport, zephyr->transport_title) ||
        !epg_serve_start_transport(zephyr->console_transport, "EPG console")) {
        LOG_ERR("a transport cannot be started");
        return EPG_ZEPHYR_ERROR_DEVICE;
    }
    const epg_zephyr_error_t failed = epg_zephyr_control_start(zephyr, epg_zephyr_fault_before_reset());
    if (failed != EPG_ZEPHYR_OK) {
        LOG_ERR("the control loop cannot be started: %s", failed == EPG_ZEPHYR_ERROR_TICK
                                                              ? "its tick would have another period"
                                                              : "a device refuses its settings");
        return failed;
    }
    running = zephyr;
    epg_serve_start_middleware(target, target->middleware, zephyr->transport);
    epg_serve_start_middleware(target, target->console, zephyr->console_transport);
    epg_zephyr_communication_start(serve);
    return EPG_ZEPHYR_OK;
}

bool epg_zephyr_start(const epg_zephyr_target_t *zephyr)
{
    error = start(zephyr);
    return error == EPG_ZEPHYR_OK;
}

bool epg_zephyr_stop(void)
{
    if (running == NULL) {
        return true;
    }
    if (k_is_in_isr() || epg_zephyr_communication_calls() || epg_zephyr_control_calls()) {
        error = EPG_ZEPHYR_ERROR_CALLER;
        return false;
    }
    epg_zephyr_communication_stop();
    epg_zephyr_control_stop();
    stop_middleware(running->target->middleware, running->transport);
    stop_middleware(running->target->console, running->console_transport);
    running = NULL;
    return true;
}

void epg_zephyr_status(epg_zephyr_status_t *status)
{
    *status = (epg_zephyr_status_t){.error = error};
    epg_zephyr_control_stack(&status->control_stack_size, &status->control_stack_used);
    epg_zephyr_communication_stack(&status->communication_stack_size, &status->communication_stack_used);
    const epg_transport_t *transport = running == NULL ? NULL : running->transport;
    if (transport != NULL && transport->lost != NULL) {
        status->transport_lost = transport->lost(transport->stream.context);
    }
}
