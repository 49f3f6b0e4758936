/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The communication side's part of a target: setpoints and requests to the control cycle, and values from it.
 */
#include "../sides.h"
#include "epg/control.h"

bool epg_control_receive(epg_control_t *control, size_t index, double value, uint64_t received_ns, bool publish)
{
    const epg_application_t *application = control->application;
    if (application == NULL || index >= application->setpoint_count) {
        return false;
    }
    const bool accepted = epg_setpoint_accepts(&application->setpoints[index], value);
    if (accepted) {
        epg_setpoint_sample_t *sample = &application->received[index];
        sample->value = value;
        sample->received_ns = received_ns;
        sample->count = sample->count == UINT32_MAX ? 1U : sample->count + 1U; /* 0 means that there is none yet */
    } else {
        /* The Cortex-M0+ has no atomic read-modify-write.  None is needed: only this side writes the word. */
        atomic_store(&control->dropped, atomic_load(&control->dropped) + 1U);
        control->refused = (uint32_t)index + 1U;
    }
    if (publish) {
        epg_exchange_write(application->setpoint_exchange, application->received);
    }
    if (application->arrived != NULL) {
        application->arrived(index);
    }
    return accepted;
}

bool epg_control_monitor(epg_control_t *control, double *values)
{
    const epg_application_t *application = control->application;
    return application != NULL && application->monitor_exchange != NULL &&
           epg_exchange_read(application->monitor_exchange, values);
}

bool epg_control_status(epg_control_t *control, epg_status_t *status)
{
    return epg_exchange_read(&control->status_exchange, status);
}

bool epg_control_observe(epg_control_t *control, epg_status_t *status)
{
    atomic_store(&control->observed, true);
    return epg_exchange_read(&control->observer_exchange, status);
}

void epg_control_extend(epg_control_t *control, uint64_t until_ns)
{
    atomic_store(&control->lease, (unsigned int)(until_ns >> EPG_LEASE_SHIFT));
}

void epg_control_reset(epg_control_t *control)
{
    atomic_store(&control->reset, true);
}

void epg_control_count_reconnect(epg_control_t *control)
{
    atomic_store(&control->reconnects, atomic_load(&control->reconnects) + 1U);
}

void epg_control_alive(epg_control_t *control)
{
    const unsigned int alive = atomic_load(&control->alive) + 1U;
    atomic_store(&control->alive, alive == 0U ? 1U : alive); /* 0 means never */
    epg_reach(control, EPG_ACCESS_TURN);
}

void epg_control_report_stack(epg_control_t *control, unsigned int stack, uint32_t used, uint32_t size)
{
    if (stack < EPG_STACKS) {
        atomic_store(&control->stacks[stack].used, used);
        atomic_store(&control->stacks[stack].size, size);
    }
}
