/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A simulated plant: its connection to the target's peripherals, and its steps in simulated time.
 *
 * For platforms that simulate (`simulates_plant` in their platform.yaml).  Such a platform has no hardware.  It
 * simulates the signals of the peripherals: encoder counts, PWM levels and pin levels.  It implements the functions of
 * the first part of this file, by which the generated code connects these signals to the plant model.  The second part
 * steps the plant model.
 */
#ifndef EPG_PLANT_H
#define EPG_PLANT_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Signals ------------------------------------------------------------------------------------------------------ */

/** Sets the count of decoder `slot`, as if its A and B signals had had that many edges. */
void epg_plant_quadrature_set(uint8_t slot, int64_t count);

/**
 * Makes epg_port_quadrature_healthy() of decoder `slot` false or true again.  A simulated decoder never fails itself.
 */
void epg_plant_quadrature_fail(uint8_t slot, bool failed);

/** Returns the share of the period for which PWM output `slot` is high, 0 ... 1, in steps of its timer. */
double epg_plant_pwm_duty(uint8_t slot);

/** Returns the level that the target gives to output `pin`. */
bool epg_plant_output(uint8_t pin);

/** Drives input `pin`.  Before the first call the pin has the level of its pull resistor. */
void epg_plant_input_set(uint8_t pin, bool level);

/** A fault of an input pin, which a test injects.  It has priority over the plant. */
typedef enum epg_plant_force {
    EPG_PLANT_FORCE_NONE, /**< the plant drives the pin again */
    EPG_PLANT_FORCE_OPEN, /**< the wire is broken: the pin has the level of its pull resistor */
    EPG_PLANT_FORCE_LOW,
    EPG_PLANT_FORCE_HIGH
} epg_plant_force_t;

/** Forces input `pin` until the next call.  Meanwhile epg_plant_input_set() has no visible effect on it. */
void epg_plant_input_force(uint8_t pin, epg_plant_force_t force);

/* The plant ---------------------------------------------------------------------------------------------------- */

/** The generated connection to the plant model.  `steps_per_period` calls of `step` make one control period. */
typedef struct epg_plant {
    uint32_t steps_per_period;
    bool starts_by_step; /**< `init` does not compute the outputs: the first step at time 0 must compute them */
    void (*init)(void);
    void (*actuate)(void); /**< copies PWM and pin levels to the plant's inputs; once per control period */
    void (*step)(void);    /**< makes one step of the plant model */
    void (*sense)(void);   /**< copies the plant's outputs to encoder counts and pin levels; once per control period */
} epg_plant_t;

/** A run of a plant, which begins at time 0. */
typedef struct epg_plant_run {
    const epg_plant_t *plant; /**< NULL: there is no plant, and all functions do nothing */
    uint64_t period_ns;       /**< control period */
    uint64_t steps;           /**< number of steps since time 0 */
} epg_plant_run_t;

/** Initialises the plant at time 0 and sets the sensors' signals.  Must be called before the application starts. */
void epg_plant_start(epg_plant_run_t *run, const epg_plant_t *plant, uint64_t period_ns);

/** Copies the actuators' present signals to the plant.  They stay the same for the plant until the next call. */
void epg_plant_actuate(const epg_plant_run_t *run);

/** Makes the plant's steps that are due until `time_ns` after time 0. */
void epg_plant_advance(epg_plant_run_t *run, uint64_t time_ns);

/** Sets the sensors' signals from the plant's outputs. */
void epg_plant_sense(const epg_plant_run_t *run);

#ifdef __cplusplus
}
#endif

#endif
