/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Access of the user's program to parameters.
 *
 * The communication side may change the same parameters (epg/parameters.h).  The control side makes the changes of both,
 * first those of the program, and gives the result to both.  The communication side must not take a result that is
 * older than its own last request; each result therefore has the number of requests that it contains.
 */
#include "epg/access.h"

/** True if the communication side changes the parameters, too. */
static bool is_shared(const epg_parameter_access_t *self)
{
    return self->own == NULL;
}

/** Publishes the values of all parameters, if the program or the communication side has changed one. */
static void publish(epg_parameter_access_t *self)
{
    epg_parameters_t *parameters = self->parameters;
    const unsigned int seen = atomic_load(&parameters->handover.returned);
    if (self->published && seen == self->seen) {
        return;
    }
    self->published = true;
    self->seen = seen;
    for (size_t i = 0; i < parameters->count; i++) {
        self->applied[i] = parameters->changed[i] ? parameters->applied[i] : parameters->table[i].value;
    }
    self->applied[parameters->count] = (double)seen;
    epg_exchange_write(&self->program, self->applied);
    if (is_shared(self)) {
        epg_exchange_write(&self->communication, self->applied);
    }
}

/** Makes the requested changes.  `running` is true if the model is initialised. */
static void change(epg_parameter_access_t *self, bool running)
{
    epg_parameters_t *parameters = self->parameters;
    /* After a restart of the target, the model has the generated values again. */
    const bool again = !self->published && !is_shared(self);
    const bool asked = epg_exchange_take(&self->requests, self->taken);
    bool any = false;
    for (size_t i = 0; i < parameters->count && (asked || again); i++) {
        self->which[i] = again && parameters->changed[i];
        if (asked && self->taken[i].count != self->counts[i]) {
            self->counts[i] = self->taken[i].count;
            parameters->applied[i] = self->taken[i].value;
            parameters->changed[i] = true;
            self->which[i] = true;
            epg_parameter_log_add(parameters, i);
        }
        any = any || self->which[i];
    }
    if (any && running) {
        parameters->set(parameters->applied, self->which);
    }
    self->published = self->published && !any;
}

/** Communication side: takes the results. */
static void inform(epg_parameter_access_t *self)
{
    epg_parameters_t *parameters = self->parameters;
    if (!epg_parameters_idle(parameters) || !epg_exchange_take(&self->communication, self->informed)) {
        return;
    }
    if (self->informed[parameters->count] != (double)atomic_load(&parameters->handover.given)) {
        return; /* it is older than the last request of this side; the one after that request follows */
    }
    for (size_t i = 0; i < parameters->count; i++) {
        if (parameters->values[i] != self->informed[i]) {
            parameters->values[i] = self->informed[i];
            if (parameters->news != NULL) {
                parameters->news[i] = EPG_PARAMETER_NEW;
            }
        }
    }
}

static bool act(epg_access_t *access, epg_control_t *control, epg_access_point_t point)
{
    epg_parameter_access_t *self = (epg_parameter_access_t *)access;
    const bool shared = is_shared(self);
    if (point == EPG_ACCESS_BEGIN) {
        change(self, control->model_valid);
    } else if (point == EPG_ACCESS_RESTORE && !shared) { /* the cycle itself restores those of the application */
        epg_parameters_restore(self->parameters);
    } else if (point == EPG_ACCESS_STEPPED || point == EPG_ACCESS_RESTED) {
        publish(self);
    } else if (point == EPG_ACCESS_TURN && shared) {
        inform(self);
    }
    return false;
}

static void clear(epg_access_t *access, const epg_application_t *application)
{
    epg_parameter_access_t *self = (epg_parameter_access_t *)access;
    self->parameters = is_shared(self) ? application->parameters : self->own;
    access->act = act;
    epg_exchange_clear(&self->requests);
    epg_exchange_clear(&self->program);
    epg_exchange_clear(&self->communication);
    self->any = false;
    self->published = false;
    for (size_t i = 0; i < self->parameters->count; i++) {
        self->given[i] = (epg_parameter_request_t){0};
        self->counts[i] = 0U;
    }
}

bool epg_access_set_parameter(epg_parameter_access_t *self, epg_control_t *control, size_t index, double value)
{
    if (!epg_access_join(&self->access, control, clear) || !epg_parameters_can_be(self->parameters, index, value)) {
        return false;
    }
    self->given[index].value = value;
    self->given[index].count++;
    epg_exchange_write(&self->requests, self->given);
    return true;
}

bool epg_access_get_parameter(epg_parameter_access_t *self, epg_control_t *control, size_t index, double *value)
{
    if (!epg_access_join(&self->access, control, clear)) {
        return false;
    }
    if (epg_exchange_take(&self->program, self->values)) {
        self->any = true;
    }
    if (self->any) {
        *value = self->values[index];
    }
    return self->any;
}
