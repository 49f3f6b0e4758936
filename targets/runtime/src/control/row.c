/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The row of a stream that a control cycle gives.
 *
 * It is not a part of control.c, so that a cycle without a stream does not save registers for it.
 */
#include "row.h"

#include "epg/jog.h"
#include "epg/parameters.h"
#include "epg/telemetry.h"

/** Sets the values about the loop before the row of a stream is taken. */
static void set_loop_values(epg_control_t *control, uint64_t tick_ns)
{
    const uint64_t total = control->statistics.computation_total;
    const uint64_t computation = control->application->telemetry->number == 0U ? 0U : total - control->loop_total;
    const uint64_t lateness = control->sampled_ns > tick_ns ? control->sampled_ns - tick_ns : 0U;
    control->loop[EPG_LOOP_LATENESS] = (double)epg_statistics_saturated(lateness);
    control->loop[EPG_LOOP_COMPUTATION] = (double)epg_statistics_saturated(computation);
    control->loop_total = total;
}

/** Sets the values for a replay before the row of a stream is taken. */
static void set_replay_values(epg_control_t *control)
{
    epg_parameters_t *parameters = control->application->parameters;
    const uint32_t cycle =
        control->enabled ? epg_statistics_saturated(control->statistics.cycles - control->first_cycle + 1U) : 0U;
    epg_parameter_told_t told = {0};
    size_t untold = 0;
    if (parameters != NULL) {
        if (control->application->telemetry->number == 0U) { /* the log has changes from the time before the stream */
            if (cycle != 1U) {
                epg_parameter_log_clear(parameters);
            }
            parameters->log.lost = false;
        }
        told = epg_parameter_log_tell(parameters);
        untold = parameters->log.untold;
        parameters->log.now = cycle > 0U ? cycle + 1U : 0U; /* of changes in the next cycle */
    }
    control->replay[EPG_REPLAY_CYCLE] = (double)cycle;
    control->replay[EPG_REPLAY_PARAMETER] = told.lost ? -1.0 : told.any ? (double)(told.index + 1U) : 0.0;
    control->replay[EPG_REPLAY_VALUE] = told.value;
    control->replay[EPG_REPLAY_ACTED] = (double)told.acted;
    control->replay[EPG_REPLAY_UNTOLD] = (double)untold;
}

void epg_control_put_row(epg_control_t *control, uint64_t tick_ns)
{
    const epg_application_t *application = control->application;
    set_loop_values(control, tick_ns);
    set_replay_values(control);
    if (application->jog != NULL) {
        epg_jog_observe(application->jog);
    }
    epg_telemetry_put(application->telemetry, tick_ns);
}
