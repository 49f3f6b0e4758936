/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The changes of parameters that a stream tells.
 */
#include "epg/parameter_log.h"

#include "epg/parameters.h"

void epg_parameter_log_clear(epg_parameters_t *parameters)
{
    epg_parameter_log_t *log = &parameters->log;
    for (size_t i = 0; i < parameters->count && log->acted != NULL; i++) {
        log->acted[i] = 0U;
    }
    log->untold = 0;
    log->lost = false;
}

/** Notes that parameter `index` has its value since `cycle`. */
static void note(epg_parameter_log_t *log, size_t index, uint32_t cycle)
{
    if (log->acted[index] == 0U) {
        log->untold++;
    } else if (log->acted[index] != cycle) {
        log->lost = true;
    }
    log->acted[index] = cycle;
}

void epg_parameter_log_add(epg_parameters_t *parameters, size_t index)
{
    if (parameters->log.acted != NULL && parameters->log.now > 0U) {
        note(&parameters->log, index, parameters->log.now);
    }
}

void epg_parameter_log_restart(epg_parameters_t *parameters)
{
    epg_parameter_log_t *log = &parameters->log;
    if (log->acted == NULL) {
        return;
    }
    log->lost = log->lost || log->untold > 0;
    for (size_t i = 0; i < parameters->count; i++) {
        log->acted[i] = 0U;
    }
    log->untold = 0;
    for (size_t i = 0; i < parameters->count; i++) {
        if (parameters->changed[i]) {
            note(log, i, 1U);
        }
    }
}

epg_parameter_told_t epg_parameter_log_tell(epg_parameters_t *parameters)
{
    epg_parameter_log_t *log = &parameters->log;
    epg_parameter_told_t told = {.lost = log->lost};
    log->lost = false;
    while (log->untold > 0 && !told.any) {
        log->next = log->next + 1U < parameters->count ? log->next + 1U : 0U;
        if (log->acted[log->next] > 0U) {
            told.any = true;
            told.index = log->next;
            told.value = parameters->applied[log->next];
            told.acted = log->acted[log->next];
            log->acted[log->next] = 0U;
            log->untold--;
        }
    }
    return told;
}
