/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Moving one actuator by hand: the communication side's part.
 */
#include "epg/jog.h"

bool epg_jog_idle(epg_jog_t *jog)
{
    return epg_handover_here(&jog->handover);
}

bool epg_jog_start(epg_jog_t *jog, size_t index, double duty, uint32_t cycles)
{
    if (!epg_handover_here(&jog->handover) || index >= jog->actuator_count) {
        return false;
    }
    jog->actuator = index;
    jog->duty = duty;
    jog->cycles = cycles;
    epg_handover_give(&jog->handover);
    return true;
}

bool epg_jog_renew(epg_jog_t *jog, size_t index, double duty)
{
    if (epg_handover_here(&jog->handover) || index != jog->actuator || duty < jog->duty || duty > jog->duty) {
        return false;
    }
    atomic_store(&jog->renewals, atomic_load(&jog->renewals) + 1U);
    return true;
}
