/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A unit and a plant: the parts of a simulated system, as shared objects.
 *
 * Models, drivers and the runtime have global variables.  Each target and each plant is therefore a shared object of its
 * own with hidden symbols, which the program that simulates the system loads.
 *
 * Times of a unit are those of its own clock, in nanoseconds since its start.
 */
#ifndef EPG_UNIT_H
#define EPG_UNIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/host.h"

/** The version of the structures below; a shared object of another version is refused. */
#define EPG_UNIT_VERSION 2U

/** A member of the structure with the plant's inputs. */
typedef struct epg_unit_port {
    size_t offset;
    size_t size;
} epg_unit_port_t;

/** The connection of a target to its plant; generated.  All members are 0 without a plant. */
typedef struct epg_unit_plant {
    void *inputs;        /**< the unit's copy of the plant's inputs, of which it sets `driven` */
    void *outputs;       /**< the unit's copy of the plant's outputs */
    size_t outputs_size; /**< bytes */
    size_t driven_count;
    const epg_unit_port_t *driven;
    uint32_t steps_per_period; /**< steps of the plant in one control period */
    bool starts_by_step;       /**< the first step, at time 0, computes the first outputs */
    void (*actuate)(void);     /**< sets the inputs by the levels of the actuators */
    void (*sense)(void);       /**< sets the signals of the sensors by the outputs */
} epg_unit_plant_t;

/** See `cycle` of epg_unit_t. */
typedef uint64_t epg_unit_pause_t(void *context);

typedef struct epg_unit {
    uint32_t version;              /**< EPG_UNIT_VERSION; the first member */
    const epg_host_target_t *host; /**< the target: its period, its topics, and the signals that can be recorded */
    const epg_unit_plant_t *plant;

    /** Starts the application.  Must be called before all other functions, when the sensors have their first values. */
    void (*start)(void);

    /**
     * Runs the control cycle of the tick at `tick_ns` at the time `begin_ns`; `missed` ticks before it have had no cycle.
     * If `pause` is not NULL, the cycle calls it with `context` after it has sampled the sensors.  `pause` returns the
     * time at which the cycle goes on.
     */
    void (*cycle)(uint64_t tick_ns, uint64_t begin_ns, uint32_t missed, epg_unit_pause_t *pause, void *context);

    /** Delivers a value of a setpoint, as epg_control_receive(). */
    void (*receive)(size_t setpoint, double value, uint64_t time_ns, bool publish);

    /** Requests to enable or to disable the target. */
    void (*request)(bool enable);

    /** Copies the newest monitoring values.  Returns false before the model's first step. */
    bool (*monitor)(double *values);

    /** Drives an input pin whatever the plant does, as epg_plant_input_force(). */
    void (*force)(uint8_t pin, epg_plant_force_t force);
} epg_unit_t;

/** A plant: one model. */
typedef struct epg_plant_module {
    uint32_t version; /**< EPG_UNIT_VERSION; the first member */
    void *inputs;
    size_t inputs_size;
    void *outputs;
    size_t outputs_size;
    void (*init)(void);
    void (*step)(void);
} epg_plant_module_t;

/** The names of the only visible symbols. */
#define EPG_UNIT_SYMBOL "epg_unit"
#define EPG_PLANT_SYMBOL "epg_plant_module"

#endif
