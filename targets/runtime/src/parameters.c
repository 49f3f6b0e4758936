/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Model parameters: the control side's part and the communication side's part.
 */
#include "epg/parameters.h"

#include "epg/finite.h"

void epg_parameters_apply(epg_parameters_t *parameters, bool running)
{
    if (!epg_handover_there(&parameters->handover)) {
        return;
    }
    for (size_t i = 0; i < parameters->change_count; i++) {
        const epg_parameter_change_t *change = &parameters->changes[i];
        parameters->applied[change->index] = change->value;
        parameters->changed[change->index] = true;
        if (running) {
            parameters->set(change->index, change->value);
        }
    }
    epg_handover_return(&parameters->handover);
}

void epg_parameters_restore(const epg_parameters_t *parameters)
{
    for (size_t i = 0; i < parameters->count; i++) {
        if (parameters->changed[i]) {
            parameters->set(i, parameters->applied[i]);
        }
    }
}

/* Communication side ------------------------------------------------------------------------------------------- */

bool epg_parameters_idle(epg_parameters_t *parameters)
{
    return epg_handover_here(&parameters->handover);
}

bool epg_parameters_change(epg_parameters_t *parameters, const epg_parameter_change_t *changes, size_t count)
{
    if (count == 0 || count > EPG_PARAMETER_CHANGES || !epg_handover_here(&parameters->handover)) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        if (changes[i].index >= parameters->count || !epg_is_finite(changes[i].value)) {
            return false;
        }
    }
    for (size_t i = 0; i < count; i++) {
        parameters->changes[i] = changes[i];
        parameters->values[changes[i].index] = changes[i].value;
    }
    parameters->change_count = count;
    epg_handover_give(&parameters->handover);
    return true;
}

double epg_parameters_value(const epg_parameters_t *parameters, size_t index)
{
    return parameters->values[index];
}
