/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The control cycle: its order, the latching of faults, and its statistics.
 */
#include "epg/control.h"

#include <string.h>

#include "../sides.h"
#include "epg/port.h"
#include "row.h"
#include "setpoint.h"

void epg_control_start(epg_control_t *control, const epg_application_t *application)
{
    const bool again = control->application != NULL;
    const uint64_t stop_number = again ? control->stop_number : (uint64_t)epg_port_boot_id() << 32U;
    /* Without the latch: a stop before the start is kept. */
    memset(control, 0, offsetof(epg_control_t, latch));
    control->application = application;
    control->stop_number = stop_number;
    control->enabled = application->enable_at_start;
    control->fault_component = EPG_NO_COMPONENT;
    control->initialise = true;
    control->status_exchange.buffers = control->status_buffers;
    control->status_exchange.size = sizeof control->status_buffers[0];
    control->observer_exchange.buffers = control->observer_buffers;
    control->observer_exchange.size = sizeof control->observer_buffers[0];
    if (again) {
        epg_stop_count(control, EPG_STOP_START);
        control->latch.guard = 0U; /* the first cycle may be enabled: nothing has moved yet */
    }
    control->statistics.computation_min = UINT32_MAX; /* no cycle can take longer */
    control->setpoints_move = epg_setpoints_start(application);
    for (size_t i = 0; i < application->monitor_count; i++) {
        application->monitor_values[i] = 0.0;
    }
    if (application->monitor_exchange != NULL) {
        epg_exchange_clear(application->monitor_exchange);
    }
    if (application->history != NULL) {
        epg_history_clear(application->history);
    }
    if (application->capture != NULL) {
        epg_capture_clear(application->capture);
    }
    if (application->telemetry != NULL) {
        epg_telemetry_clear(application->telemetry);
    }
    if (application->jog != NULL) {
        epg_jog_clear(application->jog);
    }
    application->start();
    application->safe(); /* the first level of a peripheral need not be the safe one */
}

/** A word of the communication side that stands for itself: no other memory is read because of its value. */
static inline unsigned int newest(atomic_uint *word)
{
    return atomic_load_explicit(word, memory_order_relaxed);
}

void epg_control_fault(epg_control_t *control, epg_fault_t fault, uint16_t component)
{
    if (control->fault == EPG_FAULT_NONE) {
        control->fault = fault;
        control->fault_component = component;
        control->statistics.faults++;
        epg_stop_count(control, EPG_STOP_FAULT);
    } else {
        epg_stop_cancel(control); /* a request that came while the cause was there does not act when it has gone */
    }
    control->enabled = false;
}

/** Latches a fault of the whole target. */
static void latch(epg_control_t *control, epg_fault_t fault)
{
    epg_control_fault(control, fault, EPG_NO_COMPONENT);
}

static void clear_fault(epg_control_t *control)
{
    control->fault = EPG_FAULT_NONE;
    control->fault_component = EPG_NO_COMPONENT;
}

/** Enables the target.  `permitted` is false if the fail-safe input forbids that: then only the fault is cleared. */
static void enable(epg_control_t *control, unsigned int request, bool permitted, uint64_t now_ns)
{
    clear_fault(control);
    if (permitted) {
        control->enabled = true;
        control->leased = (request & EPG_ENABLE_LEASED) != 0U;
        control->initialise = true;
        control->consecutive_overruns = 0;
        epg_setpoints_enable(control->application, now_ns);
    }
}

/** Takes the newest stop and the newest request to enable. */
static void handle_requests(epg_control_t *control, bool permitted, uint64_t now_ns)
{
    unsigned int request = 0;
    if (control->enabled && atomic_load(&control->latch.pending) == 0U) {
        return; /* most cycles: an enabled target only looks for a stop */
    }
    if (epg_stop_take(control, &request)) {
        control->enabled = false;
    } else if (request != 0U) {
        enable(control, request, permitted, now_ns);
    }
}

/** Returns true if the lease has ended.  The difference modulo 2^32 has the right sign for 26 days. */
static bool is_over(epg_control_t *control, uint64_t now_ns)
{
    return (int32_t)((uint32_t)(now_ns >> EPG_LEASE_SHIFT) - atomic_load(&control->lease)) >= 0;
}

/** Takes new setpoints and requests, and does all checks that can disable the target before a sensor is read. */
static void command(epg_control_t *control, const epg_application_t *application, uint64_t now_ns)
{
    bool taken = application->setpoint_exchange != NULL && epg_exchange_has_news(application->setpoint_exchange) &&
                 epg_exchange_take(application->setpoint_exchange, application->samples) &&
                 epg_setpoints_take(application);
    if (epg_reach(control, EPG_ACCESS_BEGIN)) {
        taken = true;
    }
    const bool refused = application->fail_safe != NULL && !application->fail_safe();
    if (atomic_load_explicit(&control->reset, memory_order_relaxed)) {
        atomic_store(&control->reset, false); /* first, so that a request during this cycle is not lost */
        clear_fault(control);
    }
    handle_requests(control, !refused, now_ns);
    if (refused) {
        epg_control_fault(control, EPG_FAULT_FAIL_SAFE, application->fail_safe_component);
    }
    if (control->leased && control->enabled && is_over(control, now_ns)) {
        latch(control, EPG_FAULT_OPERATOR);
    }
    if (taken || control->setpoints_move) {
        const epg_setpoint_t *late = epg_setpoints_update(application, now_ns, &control->statistics);
        if (late != NULL && control->enabled) {
            epg_control_fault(control, EPG_FAULT_SETPOINT_TIMEOUT, late->component);
        }
    }
}

/** Steps the model if its step is due.  Returns true if it was stepped and all its values are finite. */
static bool run_model(epg_control_t *control)
{
    const epg_application_t *application = control->application;
    if (!application->inputs_finite()) {
        control->initialise = false;
        control->model_valid = false;
        latch(control, EPG_FAULT_NOT_FINITE);
        return false;
    }
    if (control->initialise) {
        application->model_init();
        if (application->parameters != NULL) {
            epg_parameters_restore(application->parameters);
        }
        epg_reach(control, EPG_ACCESS_RESTORE);
        control->initialise = false;
        control->model_valid = true;
        control->until_step = 0;
        control->first_cycle = control->statistics.cycles;
        if (application->parameters != NULL && control->enabled) {
            epg_parameter_log_restart(application->parameters);
        }
    }
    if (!control->model_valid) {
        return false;
    }
    if (control->until_step > 0) {
        control->until_step--;
        return false;
    }
    control->until_step = application->step_divider - 1U;
    application->model_step();
    if (!application->model_finite()) {
        control->model_valid = false;
        latch(control, EPG_FAULT_NOT_FINITE);
        return false;
    }
    if (application->model_stopped != NULL && application->model_stopped()) {
        control->model_valid = false;
        latch(control, EPG_FAULT_MODEL_STOPPED);
    }
    return true;
}

/** Drives the actuator that is moved by hand.  Returns true if there is one; the model must not be stepped then. */
static bool move_by_hand(epg_control_t *control, epg_jog_t *jog, uint64_t now_ns)
{
    if (jog == NULL) {
        return false;
    }
    if (!epg_handover_there(&jog->handover) ||
        !epg_jog_cycle(jog, !control->enabled && atomic_load(&control->latch.moves) != 0U, is_over(control, now_ns))) {
        return false;
    }
    /* Initialise the model after the movement.  A model that stopped after a fault stays stopped. */
    control->initialise = control->initialise || control->model_valid;
    return true;
}

/**
 * Waits for the output delay.  The time to compute the outputs varies from cycle to cycle; with this wait, they always
 * change at the same time after the tick.  Returns the duration of the wait in nanoseconds.
 */
static uint64_t wait_for_outputs(epg_control_t *control, const epg_application_t *application, uint64_t tick_ns)
{
    const uint64_t due_ns = tick_ns + application->output_delay_ns;
    const uint64_t now_ns = epg_port_time_ns();
    if (now_ns > due_ns) {
        control->statistics.outputs_late++;
        return 0;
    }
    epg_port_wait_until(due_ns);
    return epg_port_time_ns() - now_ns;
}

/** Writes the outputs that the model has computed.  Returns the duration of the wait for their delay in nanoseconds. */
static uint64_t write_outputs(epg_control_t *control, const epg_application_t *application, uint64_t tick_ns)
{
    uint64_t waited_ns = 0;
    if (application->prepare != NULL) {
        application->prepare();
    }
    if (application->output_delay_ns > 0U) {
        waited_ns = wait_for_outputs(control, application, tick_ns);
    }
    application->write();
    return waited_ns;
}

/** Passes the values of a step on to the communication side, and to the history. */
static void monitor(const epg_application_t *application)
{
    application->monitor(application->monitor_values);
    epg_exchange_write(application->monitor_exchange, application->monitor_values);
    if (application->history != NULL) {
        epg_history_add(application->history, application->monitor_values);
    }
}

static void count_lateness(epg_control_t *control, uint64_t tick_ns, uint64_t begin_ns)
{
    const uint32_t lateness = begin_ns > tick_ns ? epg_statistics_saturated(begin_ns - tick_ns) : 0U;
    if (lateness > control->statistics.lateness_max) {
        control->statistics.lateness_max = lateness;
    }
}

/**
 * Counts a cycle that computed from `begin_ns` to `end_ns`.  Returns true if it was an overrun: it ended after the next
 * tick `next_ns`, or ticks before it were missed.
 */
static bool count_cycle(epg_control_t *control, uint64_t next_ns, uint64_t begin_ns, uint64_t end_ns, uint32_t missed)
{
    epg_statistics_t *statistics = &control->statistics;
    const uint32_t computation = epg_statistics_saturated(end_ns - begin_ns);

    statistics->cycles++;
    if (computation < statistics->computation_min) {
        statistics->computation_min = computation;
    }
    if (computation > statistics->computation_max) {
        statistics->computation_max = computation;
    }
    statistics->computation_total += computation;
    if (end_ns <= next_ns && missed == 0U) {
        return false;
    }
    statistics->overruns++;
    statistics->missed += missed;
    return true;
}

/** Counts the cycles since the communication side was alive.  If it was alive now, copies its report of the stacks. */
static void count_silence(epg_control_t *control)
{
    const unsigned int alive = newest(&control->alive);
    if (alive != control->alive_seen) {
        control->alive_seen = alive;
        control->silence = 0;
        for (unsigned int i = 0; i < EPG_STACKS; i++) {
            control->statistics.stacks[i].used = newest(&control->stacks[i].used);
            control->statistics.stacks[i].size = newest(&control->stacks[i].size);
        }
    } else if (alive != 0U && control->silence < UINT32_MAX) {
        control->silence++;
        if (control->silence > control->statistics.silence_max) {
            control->statistics.silence_max = control->silence;
        }
    }
}

/** Records the cycle, if a recording or a stream runs.  Streams use a part of the recordings' memory. */
static void record(epg_control_t *control, const epg_application_t *application, uint64_t tick_ns)
{
    if (epg_handover_there(&application->capture->handover)) {
        epg_capture_cycle(application->capture, tick_ns, control->fault != EPG_FAULT_NONE);
    }
    if (application->telemetry != NULL && epg_handover_there(&application->telemetry->handover)) {
        epg_control_put_row(control, tick_ns);
    }
}

static void publish_status(epg_control_t *control)
{
    control->statistics.reconnects = newest(&control->reconnects);
    epg_exchange_write(&control->status_exchange, &control->status);
    if (atomic_load_explicit(&control->observed, memory_order_relaxed)) {
        epg_exchange_write(&control->observer_exchange, &control->status);
    }
}

void epg_control_cycle(epg_control_t *control, uint64_t tick_ns, uint32_t missed)
{
    const epg_application_t *application = control->application;
    uint64_t begin_ns = epg_port_time_ns();

    control->sampled_ns = begin_ns;
    application->sample();
    count_lateness(control, tick_ns, begin_ns);
    control->time_ns = tick_ns;
    command(control, application, begin_ns);
    application->read();
    if (application->parameters != NULL && epg_handover_there(&application->parameters->handover)) {
        epg_parameters_apply(application->parameters, control->model_valid);
    }
    const bool jogging = move_by_hand(control, application->jog, begin_ns);
    const bool stepped = !jogging && run_model(control);
    if (jogging) {
        /* Only the actuator that is moved by hand is driven.  The others are safe, because the target is disabled. */
    } else if (!control->enabled) {
        application->safe();
    } else if (stepped) {
        begin_ns += write_outputs(control, application, tick_ns); /* waiting is not computation time */
    }
    if (stepped && application->monitor != NULL) {
        monitor(application);
    }
    control->statistics.setpoints_dropped = newest(&control->dropped);
    epg_reach(control, stepped ? EPG_ACCESS_STEPPED : EPG_ACCESS_RESTED);
    if (application->capture != NULL) {
        record(control, application, tick_ns);
    }

    const uint64_t next_ns = tick_ns + application->period_ns;
    const bool overrun = count_cycle(control, next_ns, begin_ns, epg_port_time_ns(), missed);
    if (!overrun) {
        control->consecutive_overruns = 0;
    } else if (++control->consecutive_overruns >= application->overrun_limit && application->overrun_limit > 0) {
        latch(control, EPG_FAULT_OVERRUN);
        application->safe();
    }
    count_silence(control);
    publish_status(control);
}

void epg_control_count_clamped(epg_control_t *control)
{
    control->statistics.clamped++;
}
