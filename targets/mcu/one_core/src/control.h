/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The parts of the control loop that several of these files use.
 */
#ifndef EPG_ONE_CORE_CONTROL_H
#define EPG_ONE_CORE_CONTROL_H

#include "epg/one_core.h"
#include "epg/ticks.h"

/** The control cycle in time. */
typedef struct epg_one_core_cycle {
    const epg_family_target_t *target;
    epg_mcu_ticks_t ticks;
    bool runs; /**< a control cycle is running: the caller is in it, because nothing interrupts it */
} epg_one_core_cycle_t;

extern epg_one_core_cycle_t epg_one_core_cycle;

/** The interrupt of the tick, or -16 if no target is running. */
int32_t epg_one_core_tick_in_use(void);

#endif
