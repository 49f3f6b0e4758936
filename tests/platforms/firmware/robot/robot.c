/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The robot of the host target, with its own connection to the host's PWM, pins and decoders.
 *
 * The order is that of the host in simulated time: at a tick the plant advances and the sensors follow; after the cycle
 * the actuators follow.
 */
#include "epg/control.h"
#include "epg/host.h"
#include "epg/plant.h"
#include "epg/port.h"
#include "epg/target.h"
#include "jiwy.h"

extern const epg_host_target_t jiwy_host;

void robot_start(void);
void robot_sense(uint64_t time_ns, uint32_t *counts);
void robot_actuate(const uint32_t *levels, const uint8_t *directions);

static epg_plant_run_t run;

/* The numbers that EPG gives to the peripherals of JIWY, which has no other ones: jiwy_host.c has them, too. */
static const epg_port_quadrature_t decoders[] = {{.slot = 0}, {.slot = 1}};
static const epg_port_pwm_t pwms[] = {{.slot = 0}, {.slot = 1}};
static const uint8_t pins[] = {5, 6, 8, 9};

/** Puts the robot to its first position.  Decoders and PWM start as the host's controller starts them. */
void robot_start(void)
{
    static const uint32_t off[2];
    static const uint8_t low[4];
    robot_actuate(off, low); /* as the host ends each run: a plant keeps its inputs until its next start */
    epg_plant_start(&run, jiwy_host.plant, jiwy_target.application->period_ns);
    epg_control_start(jiwy_target.control, jiwy_target.application);
    epg_plant_actuate(&run);
}

/** Moves the robot until a tick; gives the counts of pan and tilt. */
void robot_sense(uint64_t time_ns, uint32_t *counts)
{
    epg_plant_advance(&run, time_ns);
    epg_plant_sense(&run);
    for (unsigned int i = 0; i < 2U; i++) {
        counts[i] = epg_port_quadrature_count(&decoders[i]);
    }
}

/** Gives the motors the levels of two PWM outputs and of four direction pins. */
void robot_actuate(const uint32_t *levels, const uint8_t *directions)
{
    for (unsigned int i = 0; i < 2U; i++) {
        epg_port_pwm_write(&pwms[i], levels[i]);
    }
    for (unsigned int i = 0; i < 4U; i++) {
        epg_port_output_write(pins[i], directions[i] != 0U);
    }
    epg_plant_actuate(&run);
}
