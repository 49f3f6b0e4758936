/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The steps of a simulated plant in simulated time.
 */
#include "epg/plant.h"

#include <stddef.h>

void epg_plant_start(epg_plant_run_t *run, const epg_plant_t *plant, uint64_t period_ns)
{
    run->plant = plant;
    run->period_ns = period_ns;
    run->steps = 0;
    if (plant != NULL) {
        plant->init();
        if (plant->starts_by_step) {
            plant->step();
            run->steps = 1;
        }
        plant->sense();
    }
}

void epg_plant_actuate(const epg_plant_run_t *run)
{
    if (run->plant != NULL) {
        run->plant->actuate();
    }
}

void epg_plant_advance(epg_plant_run_t *run, uint64_t time_ns)
{
    if (run->plant == NULL) {
        return;
    }
    /* Time is counted in steps, because a plant step need not be a whole number of nanoseconds. */
    const uint64_t per_period = run->plant->steps_per_period;
    const uint64_t due = time_ns / run->period_ns * per_period + time_ns % run->period_ns * per_period / run->period_ns;
    for (; run->steps < due; run->steps++) {
        run->plant->step();
    }
}

void epg_plant_sense(const epg_plant_run_t *run)
{
    if (run->plant != NULL) {
        run->plant->sense();
    }
}
