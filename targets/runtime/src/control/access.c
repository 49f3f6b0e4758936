/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Access of the user's program to setpoints and values.
 */
#include "epg/access.h"

#include "epg/port.h"
#include "setpoint.h"

static bool reach(epg_access_t *first, epg_control_t *control, epg_access_point_t point)
{
    bool result = false;
    for (epg_access_t *access = first; access != NULL; access = access->next) {
        result = access->act(access, control, point) || result;
    }
    return result;
}

bool epg_access_join(epg_access_t *self, epg_control_t *control,
                     void (*clear)(epg_access_t *self, const epg_application_t *application))
{
    if (control->application == NULL) {
        return false;
    }
    epg_access_t *const first = atomic_load(&control->accesses);
    for (const epg_access_t *access = first; access != NULL; access = access->next) {
        if (access == self) {
            return true;
        }
    }
    clear(self, control->application);
    self->next = first;
    self->reach = reach;
    atomic_store(&control->accesses, self);
    return true;
}

/* Setpoints ------------------------------------------------------------------------------------------------------ */

static bool take_setpoints(epg_setpoint_access_t *self, const epg_application_t *application)
{
    bool taken = false;
    if (!epg_exchange_take(&self->exchange, self->taken)) {
        return false;
    }
    for (size_t i = 0; i < self->count; i++) {
        const epg_setpoint_sample_t *sample = &self->taken[i];
        if (sample->count == self->counts[i]) {
            continue;
        }
        self->counts[i] = sample->count;
        /* The newest message may have been received after this value was set: the later one counts. */
        if (sample->received_ns >= application->samples[i].received_ns) {
            taken = epg_setpoint_put(&application->setpoint_states[i], sample) || taken;
        }
    }
    return taken;
}

static void inform_of_setpoints(epg_setpoint_access_t *self, const epg_application_t *application)
{
    for (size_t i = 0; i < self->count && self->arrivals != NULL; i++) {
        const unsigned int arrivals = atomic_load(&self->arrivals[i]);
        if (arrivals != self->informed[i]) {
            self->informed[i] = arrivals;
            application->arrived(i);
        }
    }
}

static bool act_on_setpoints(epg_access_t *access, epg_control_t *control, epg_access_point_t point)
{
    epg_setpoint_access_t *self = (epg_setpoint_access_t *)access;
    if (point == EPG_ACCESS_BEGIN) {
        return take_setpoints(self, control->application);
    }
    if (point == EPG_ACCESS_STEPPED || point == EPG_ACCESS_RESTED) {
        control->statistics.setpoints_dropped += atomic_load(&self->dropped);
    } else if (point == EPG_ACCESS_TURN) {
        inform_of_setpoints(self, control->application);
    }
    return false;
}

static void clear_setpoints(epg_access_t *access, const epg_application_t *application)
{
    (void)application;
    epg_setpoint_access_t *self = (epg_setpoint_access_t *)access;
    access->act = act_on_setpoints;
    atomic_store(&self->dropped, 0U);
    epg_exchange_clear(&self->exchange);
    for (size_t i = 0; i < self->count; i++) {
        self->given[i] = (epg_setpoint_sample_t){0};
        self->counts[i] = 0U;
        if (self->arrivals != NULL) {
            self->informed[i] = atomic_load(&self->arrivals[i]);
        }
    }
}

bool epg_access_set(epg_setpoint_access_t *self, epg_control_t *control, size_t index, double value)
{
    if (!epg_access_join(&self->access, control, clear_setpoints)) {
        return false;
    }
    const bool accepted = epg_setpoint_accepts(&control->application->setpoints[index], value);
    if (accepted) {
        epg_setpoint_sample_t *sample = &self->given[index];
        sample->value = value;
        sample->received_ns = epg_port_time_ns();
        sample->count++;
        epg_exchange_write(&self->exchange, self->given);
    } else {
        atomic_store(&self->dropped, atomic_load(&self->dropped) + 1U); /* only the program writes it */
    }
    if (self->arrivals != NULL) {
        atomic_store(&self->arrivals[index], atomic_load(&self->arrivals[index]) + 1U);
    }
    return accepted;
}

/* Values --------------------------------------------------------------------------------------------------------- */

static bool act_on_values(epg_access_t *access, epg_control_t *control, epg_access_point_t point)
{
    epg_value_access_t *self = (epg_value_access_t *)access;
    if (point == EPG_ACCESS_STEPPED) {
        self->collect(self->given, control->time_ns);
        epg_exchange_write(&self->exchange, self->given);
    }
    return false;
}

static void clear_values(epg_access_t *access, const epg_application_t *application)
{
    (void)application;
    epg_value_access_t *self = (epg_value_access_t *)access;
    access->act = act_on_values;
    epg_exchange_clear(&self->exchange);
    self->any = false;
}

bool epg_access_values(epg_value_access_t *self, epg_control_t *control)
{
    if (!epg_access_join(&self->access, control, clear_values)) {
        return false;
    }
    if (epg_exchange_take(&self->exchange, self->taken)) {
        self->any = true;
    }
    return self->any;
}
