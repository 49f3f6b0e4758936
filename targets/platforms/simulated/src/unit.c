/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions of a unit: a target whose cycles, messages and time come from outside.
 */
#include "epg/unit.h"

#include "port/clock.h"

/* Generated; CMake defines the names. */
extern const epg_host_target_t EPG_UNIT_HOST;
extern const epg_unit_plant_t EPG_UNIT_PLANT;

/** The application of the target, with read_and_pause() in place of read(). */
static epg_application_t application;

/** The pause of the present cycle; NULL: none. */
static epg_unit_pause_t *present_pause;
static void *pause_context;

static void read_and_pause(void)
{
    EPG_UNIT_HOST.target->application->read();
    if (present_pause != NULL) {
        epg_host_clock_simulate(present_pause(pause_context));
    }
}

static epg_control_t *control(void)
{
    return EPG_UNIT_HOST.target->control;
}

static void start(void)
{
    epg_host_clock_simulate(0);
    application = *EPG_UNIT_HOST.target->application;
    application.read = read_and_pause;
    epg_control_start(control(), &application);
}

static void cycle(uint64_t tick_ns, uint64_t begin_ns, uint32_t missed, epg_unit_pause_t *pause, void *context)
{
    present_pause = pause;
    pause_context = context;
    epg_host_clock_simulate(begin_ns);
    epg_control_cycle(control(), tick_ns, missed);
}

static void receive(size_t setpoint, double value, uint64_t time_ns, bool publish)
{
    (void)epg_control_receive(control(), setpoint, value, time_ns, publish);
}

static void request(bool enable)
{
    if (enable) {
        epg_control_enable(control(), EPG_ENABLE_ANY);
    } else {
        epg_stop(control(), EPG_STOP_SCENARIO);
    }
}

static bool monitor(double *values)
{
    return epg_control_monitor(control(), values);
}

extern const epg_unit_t epg_unit __attribute__((EPG_EXPORTED));
const epg_unit_t epg_unit = {
    .version = EPG_UNIT_VERSION,
    .host = &EPG_UNIT_HOST,
    .plant = &EPG_UNIT_PLANT,
    .start = start,
    .cycle = cycle,
    .receive = receive,
    .request = request,
    .monitor = monitor,
    .force = epg_plant_input_force,
};
