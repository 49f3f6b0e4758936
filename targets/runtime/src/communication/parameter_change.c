/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Model parameters: the communication side's part.
 */
#include "epg/parameters.h"

#include "epg/finite.h"

bool epg_parameters_idle(epg_parameters_t *parameters)
{
    return epg_handover_here(&parameters->handover);
}

bool epg_parameters_can_be(const epg_parameters_t *parameters, size_t index, double value)
{
    if (index >= parameters->count || !epg_is_finite(value)) {
        return false;
    }
    const epg_parameter_limits_t *limits = parameters->limits;
    return limits == NULL || (value >= limits[index].minimum && value <= limits[index].maximum);
}

void epg_parameters_prepare(epg_parameters_t *parameters, size_t index, double value)
{
    parameters->values[index] = value;
    parameters->wanted[index] = true;
    if (parameters->news != NULL) {
        parameters->news[index] = EPG_PARAMETER_NEW;
    }
}

void epg_parameters_request(epg_parameters_t *parameters)
{
    epg_handover_give(&parameters->handover);
}

bool epg_parameters_change(epg_parameters_t *parameters, const epg_parameter_change_t *changes, size_t count)
{
    if (count == 0 || !epg_handover_here(&parameters->handover)) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        if (!epg_parameters_can_be(parameters, changes[i].index, changes[i].value)) {
            return false;
        }
    }
    for (size_t i = 0; i < count; i++) {
        epg_parameters_prepare(parameters, changes[i].index, changes[i].value);
    }
    epg_parameters_request(parameters);
    return true;
}

double epg_parameters_value(const epg_parameters_t *parameters, size_t index)
{
    return parameters->values[index];
}
