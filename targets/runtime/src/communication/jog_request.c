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
    jog->leased = cycles == EPG_JOG_LEASED;
    epg_handover_give(&jog->handover);
    return true;
}

bool epg_jog_is_leased(epg_jog_t *jog, size_t index, double duty)
{
    return !epg_handover_here(&jog->handover) && jog->leased && index == jog->actuator && duty >= jog->duty &&
           duty <= jog->duty;
}
