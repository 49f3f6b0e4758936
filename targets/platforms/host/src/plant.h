/**
 * @file
 * The simulated plant on the time line of a run.
 */
#ifndef EPG_HOST_PLANT_H
#define EPG_HOST_PLANT_H

#include <stdint.h>

#include "epg/host.h"

typedef struct epg_host_plant_run {
    const epg_host_plant_t *plant; /**< NULL: no plant, all functions do nothing */
    uint64_t period_ns;            /**< control period */
    uint64_t steps;                /**< made since time 0 */
} epg_host_plant_run_t;

/** Initialises the plant at time 0 and sets the sensors' signals.  Before the application starts. */
void epg_host_plant_start(epg_host_plant_run_t *run, const epg_host_plant_t *plant, uint64_t period_ns);

/** Hands the actuators' present signals to the plant; they hold until the next call. */
void epg_host_plant_actuate(const epg_host_plant_run_t *run);

/** Makes the steps that are due up to `time_ns` after time 0. */
void epg_host_plant_advance(epg_host_plant_run_t *run, uint64_t time_ns);

/** Sets the sensors' signals from the plant's outputs. */
void epg_host_plant_sense(const epg_host_plant_run_t *run);

#endif
