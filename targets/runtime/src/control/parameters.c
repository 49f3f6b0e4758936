/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Model parameters: the control side's part.
 */
#include "epg/parameters.h"

void epg_parameters_apply(epg_parameters_t *parameters, bool running)
{
    if (!epg_handover_there(&parameters->handover)) {
        return;
    }
    for (size_t i = 0; i < parameters->count; i++) {
        if (parameters->wanted[i]) {
            parameters->applied[i] = parameters->values[i];
            parameters->changed[i] = true;
            epg_parameter_log_add(parameters, i);
        }
    }
    if (running) {
        parameters->set(parameters->applied, parameters->wanted);
    }
    for (size_t i = 0; i < parameters->count; i++) {
        parameters->wanted[i] = false;
    }
    epg_handover_return(&parameters->handover);
}

void epg_parameters_restore(const epg_parameters_t *parameters)
{
    bool any = false;
    for (size_t i = 0; i < parameters->count; i++) {
        any = any || parameters->changed[i];
    }
    if (any) {
        parameters->set(parameters->applied, parameters->changed);
    }
}
