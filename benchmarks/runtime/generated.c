/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions of glue.h for the generated target.
 */
#include "epg/control.h"
#include "epg/target.h"
#include "glue.h"
#include "jiwy.h"

void glue_start(void)
{
    epg_control_start(jiwy_target.control, jiwy_target.application);
}

void glue_cycle(uint64_t tick_ns, uint32_t missed)
{
    epg_control_cycle(jiwy_target.control, tick_ns, missed);
}

bool glue_receive(size_t index, double value, uint64_t received_ns, bool publish)
{
    return epg_control_receive(jiwy_target.control, index, value, received_ns, publish);
}

bool glue_monitor(double values[GLUE_MONITORED])
{
    return epg_control_monitor(jiwy_target.control, values);
}

bool glue_status(epg_status_t *status)
{
    return epg_control_status(jiwy_target.control, status);
}

void glue_request(bool enable)
{
    if (enable) {
        epg_control_enable(jiwy_target.control, EPG_ENABLE_ANY);
    } else {
        epg_stop(jiwy_target.control, EPG_STOP_PROGRAM);
    }
}
