/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A simulated plant: what it moves and sees of a target's peripherals, and its place on the time line of a run.
 *
 * For platforms that simulate (`simulates_plant` in their platform.yaml): there peripherals are simulated at the level of
 * their signals, which are encoder counts, PWM levels and pin levels.  The generated code connects them to the plant
 * model by the functions of the first part, which the platform implements.
 */
#ifndef EPG_PLANT_H
#define EPG_PLANT_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Signals ------------------------------------------------------------------------------------------------------ */

/** Count of decoder `slot`, as the edges of its A and B signals would have given. */
void epg_plant_quadrature_set(uint8_t slot, int64_t count);

/** Whether decoder `slot` says that it has stopped (epg_port_quadrature_healthy()); they do not by themselves. */
void epg_plant_quadrature_fail(uint8_t slot, bool failed);

/** Share of the period that PWM output `slot` is high, 0 ... 1, in steps of its timer. */
double epg_plant_pwm_duty(uint8_t slot);

/** Level that the target gives to output `pin`. */
bool epg_plant_output(uint8_t pin);

/** Drives input `pin`; before the first call it has the level of its pull resistor. */
void epg_plant_input_set(uint8_t pin, bool level);

/** What a test makes of an input pin, whatever the plant says. */
typedef enum epg_plant_force {
    EPG_PLANT_FORCE_LOW,
    EPG_PLANT_FORCE_HIGH,
    EPG_PLANT_FORCE_OPEN, /**< nothing drives the pin, as with a broken wire: it has the level of its pull resistor */
    EPG_PLANT_FORCE_NONE  /**< the plant drives the pin again */
} epg_plant_force_t;

/** Input `pin` is forced until the next call, whatever epg_plant_input_set() says meanwhile. */
void epg_plant_input_force(uint8_t pin, epg_plant_force_t force);

/* The plant ---------------------------------------------------------------------------------------------------- */

/** The generated connection to the plant model; `steps_per_period` calls of `step` make one control period. */
typedef struct epg_plant {
    uint32_t steps_per_period;
    bool starts_by_step; /**< `init` does not compute the outputs: the first step is made at time 0, to have some */
    void (*init)(void);
    void (*actuate)(void); /**< PWM and pin levels to the plant's inputs; once per control period */
    void (*step)(void);    /**< the plant moves on by one of its steps */
    void (*sense)(void);   /**< plant outputs to encoder counts and pin levels; once per control period */
} epg_plant_t;

/** A run of a plant from time 0 on. */
typedef struct epg_plant_run {
    const epg_plant_t *plant; /**< NULL: no plant, all functions do nothing */
    uint64_t period_ns;       /**< control period */
    uint64_t steps;           /**< made since time 0 */
} epg_plant_run_t;

/** Initialises the plant at time 0 and sets the sensors' signals.  Before the application starts. */
void epg_plant_start(epg_plant_run_t *run, const epg_plant_t *plant, uint64_t period_ns);

/** Hands the actuators' present signals to the plant; they hold until the next call. */
void epg_plant_actuate(const epg_plant_run_t *run);

/** Makes the steps that are due up to `time_ns` after time 0. */
void epg_plant_advance(epg_plant_run_t *run, uint64_t time_ns);

/** Sets the sensors' signals from the plant's outputs. */
void epg_plant_sense(const epg_plant_run_t *run);

#ifdef __cplusplus
}
#endif

#endif
