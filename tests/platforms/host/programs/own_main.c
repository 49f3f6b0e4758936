/*
 * A program with its own main(): it starts the target in real time, communicates with it, stops it, and repeats this
 * once.  Its plant, which runs in the control thread, also tries to stop the target.
 * Prints its observations, or a line "failed: ..." with status 1 if one of them breaks a promise.
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <time.h>

#include "epg/host.h"
#include "epg/port.h"

extern const epg_host_target_t epg_host_application;

static atomic_bool plant_stops;
static atomic_bool plant_was_refused;

static void plant_step(void)
{
    if (atomic_exchange(&plant_stops, false)) {
        atomic_store(&plant_was_refused, !epg_host_stop());
    }
    epg_host_application.plant->step();
}

static int failed(const char *what)
{
    printf("failed: %s\n", what);
    return 1;
}

static void wait_ms(long ms)
{
    const struct timespec time = {.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000};
    nanosleep(&time, NULL); /* a user's program */
}

static int run_once(void)
{
    epg_control_t *control = epg_host_application.target->control;
    double values[2] = {0.0, 0.0};
    double duty_moving = 0.0;
    epg_status_t status;
    epg_plant_t plant = *epg_host_application.plant;
    epg_host_target_t target = epg_host_application;
    plant.step = plant_step;
    target.plant = &plant;
    atomic_store(&plant_stops, true);
    atomic_store(&plant_was_refused, false);
    if (!epg_host_start(&target)) {
        return failed("start");
    }
    if (epg_host_start(&target)) {
        return failed("started a second time while running");
    }
    epg_control_receive(control, 0, 2.0, epg_port_time_ns(), true);
    for (int i = 0; i < 25; i++) {
        wait_ms(20);
        duty_moving = fmax(duty_moving, epg_plant_pwm_duty(1));
        if (epg_control_monitor(control, values) && epg_control_status(control, &status)) {
            printf("position %.3f setpoint %.3f cycles %u\n", values[0], values[1], (unsigned)status.statistics.cycles);
        }
    }
    if (!atomic_load(&plant_was_refused)) {
        return failed("the control thread has stopped itself");
    }
    if (!epg_host_stop() || !epg_host_stop()) { /* the second call has no effect */
        return failed("stop");
    }
    if (duty_moving < 0.5) {
        return failed("the motor was not driven");
    }
    if (fabs(values[0] - 2.0) > 0.05) {
        return failed("the setpoint was not reached");
    }
    if (epg_plant_pwm_duty(1) > 0.0) {
        return failed("the output is not safe after the stop");
    }
    if (!epg_control_status(control, &status) || status.statistics.cycles < 100) {
        return failed("hardly any cycle was run");
    }
    const uint32_t cycles = status.statistics.cycles;
    wait_ms(20);
    if (!epg_control_status(control, &status) || status.statistics.cycles != cycles) {
        return failed("the cycle went on after the stop");
    }
    return 0;
}

int main(void)
{
    return run_once() != 0 || run_once() != 0;
}
