/**
 * @file
 * The host platform: a target runs on a PC against a simulated plant, in simulated or in real time.
 *
 * Peripherals are simulated at the level of their signals: encoder counts, PWM levels, pin levels.  The generated
 * file `<name>_plant.c` connects them to the plant model.
 */
#ifndef EPG_HOST_H
#define EPG_HOST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/target.h"

/** Count of decoder `unit`, as the edges of its A and B signals would have given. */
void epg_host_quadrature_set(uint8_t unit, int64_t count);

/** Whether decoder `unit` says that it has stopped (epg_port_quadrature_healthy()); they do not by themselves. */
void epg_host_quadrature_fail(uint8_t unit, bool failed);

/** Share of the period that PWM output `unit` is high, 0 ... 1, in steps of its timer. */
double epg_host_pwm_duty(uint8_t unit);

bool epg_host_output(uint8_t pin);
void epg_host_input_set(uint8_t pin, bool level);

/** A signal that can be recorded at each control cycle. */
typedef struct epg_host_signal {
    const char *name; /**< "inputs.position_pan", "plant.outputs.angle_pan" */
    const double *value;
} epg_host_signal_t;

/** The simulated plant; `steps_per_period` calls of `step` make one control period. */
typedef struct epg_host_plant {
    uint32_t steps_per_period;
    void (*init)(void);
    void (*actuate)(void); /**< PWM and pin levels to the plant's inputs; once per control period */
    void (*step)(void);    /**< the plant moves on by one of its steps */
    void (*sense)(void);   /**< plant outputs to encoder counts and pin levels; once per control period */
} epg_host_plant_t;

/** All the host needs to run one target.  `plant` is NULL when there is none: then sensors stand still. */
typedef struct epg_host_target {
    const epg_target_t *target;
    const epg_host_plant_t *plant;
    size_t signal_count;
    const epg_host_signal_t *signals;
    const char *agent;  /**< where the agent of the target's middleware is: HOST:PORT, or a terminal; NULL: no agent */
    uint32_t baud_rate; /**< of that terminal */
} epg_host_target_t;

/** Body of main() of a host executable: reads options, runs, prints a summary.  Returns the exit status. */
int epg_host_main(const epg_host_target_t *host, int argc, char **argv);

/** Starts the control cycle in a thread of its own, in real time, and returns; false when that fails. */
bool epg_host_start(const epg_host_target_t *host);

/** Ends the thread started by epg_host_start() after the current cycle; outputs are safe then. */
void epg_host_stop(void);

#endif
