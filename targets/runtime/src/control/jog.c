/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Moving one actuator by hand: the control side's part.
 */
#include "epg/jog.h"

void epg_jog_clear(epg_jog_t *jog)
{
    jog->end = EPG_JOG_STOPPED;
    jog->running = false;
    epg_handover_clear(&jog->handover);
}

static void take_readings(const epg_jog_t *jog, epg_jog_reading_t *readings)
{
    for (size_t i = 0; i < jog->encoder_count; i++) {
        readings[i].count = jog->encoders[i].count();
        readings[i].position = jog->encoders[i].position();
    }
}

static void finish(epg_jog_t *jog, epg_jog_end_t end)
{
    take_readings(jog, jog->last);
    jog->end = end;
    jog->cycles = jog->elapsed;
    jog->running = false;
    epg_handover_return(&jog->handover);
}

bool epg_jog_cycle(epg_jog_t *jog, bool permitted, bool over)
{
    if (!epg_handover_there(&jog->handover)) {
        return false;
    }
    if (!jog->running) {
        take_readings(jog, jog->first);
        jog->elapsed = 0;
        if (!permitted) {
            finish(jog, EPG_JOG_REFUSED);
            return false;
        }
        jog->running = true;
    }
    if (!permitted || (jog->leased ? over : jog->elapsed == jog->cycles)) {
        finish(jog, permitted ? EPG_JOG_DONE : EPG_JOG_STOPPED);
        return false;
    }
    jog->elapsed++;
    jog->actuators[jog->actuator].drive(jog->duty);
    return true;
}

void epg_jog_observe(const epg_jog_t *jog)
{
    for (size_t i = 0; i < jog->actuator_count; i++) {
        if (jog->actuators[i].applied != NULL) {
            jog->values[i] = jog->actuators[i].applied();
        }
    }
    for (size_t i = 0; i < jog->encoder_count; i++) {
        jog->values[jog->actuator_count + i] = jog->encoders[i].position();
    }
}
