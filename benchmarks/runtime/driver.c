/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Runs a target against a small simulated robot, to count the instructions of its cycles or to compare its signals.
 *
 *   driver <cycles>          runs that number of cycles, with setpoints in every 33rd, and prints nothing
 *   driver <cycles> trace    does the same with disturbances, and prints every signal of every cycle
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "epg/port.h"
#include "glue.h"

enum { AXES = 2, PINS = 10, SETPOINT_EVERY = 33 };

static const uint64_t period_ns = 1000000;

/* Port layer.  Each read of the clock takes some time.  The simulated robot reads and writes the signals. */

static uint64_t now_ns;
static uint64_t reading_ns = 700; /* time that a read of the clock takes */
static uint32_t counts[AXES];
static uint32_t levels[AXES];
static bool pins[PINS];
static uint64_t port_writes;

uint64_t epg_port_time_ns(void)
{
    now_ns += reading_ns;
    return now_ns;
}

uint32_t epg_port_boot_id(void)
{
    return 1;
}

void epg_port_wait_until(uint64_t time_ns)
{
    now_ns = time_ns; /* is not called: there is no output delay */
}

void epg_port_quadrature_start(const epg_port_quadrature_t *decoder)
{
    counts[decoder->slot] = 0;
}

uint32_t epg_port_quadrature_count(const epg_port_quadrature_t *decoder)
{
    return counts[decoder->slot];
}

bool epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder)
{
    (void)decoder;
    return true;
}

void epg_port_pwm_start(const epg_port_pwm_t *pwm)
{
    levels[pwm->slot] = 0;
}

void epg_port_pwm_write(const epg_port_pwm_t *pwm, uint32_t level)
{
    levels[pwm->slot] = level;
    port_writes++;
}

void epg_port_output_start(uint8_t pin, bool level)
{
    pins[pin] = level;
}

void epg_port_output_write(uint8_t pin, bool level)
{
    pins[pin] = level;
    port_writes++;
}

/* The robot: two motors with friction and end stops, and their encoders. */

static double angle[AXES];
static double speed[AXES];

static void move(void)
{
    static const uint8_t forwards[AXES] = {5, 8};
    static const double counts_per_rad[AXES] = {1112 / 3.141592653589793, 221 / 1.5707963267948966};
    for (int axis = 0; axis < AXES; axis++) {
        const uint8_t pin = forwards[axis];
        const double duty = (double)(pins[pin] - pins[pin + 1]) * levels[axis] / 6250.0;
        speed[axis] += (duty * 200.0 - speed[axis] * 8.0) * 0.001;
        angle[axis] += speed[axis] * 0.001;
        if (fabs(angle[axis]) > 1.6) {
            angle[axis] = copysign(1.6, angle[axis]);
            speed[axis] = 0.0;
        }
        counts[axis] = (uint32_t)(int32_t)floor(angle[axis] * counts_per_rad[axis]);
    }
}

/* Communication.  A trace also has disturbances: wrong setpoints, requests to disable, and overruns. */

static void communicate(unsigned long cycle, bool mishaps)
{
    if (cycle % SETPOINT_EVERY == 0) {
        const double time = (double)cycle * 0.001;
        glue_receive(0, 0.8 * sin(time), now_ns, false);
        glue_receive(1, 0.4 * cos(0.7 * time), now_ns, true);
    }
    if (!mishaps) {
        return;
    }
    if (cycle % 1009 == 500) {
        glue_receive(cycle % 2, cycle % 3 == 0 ? (double)NAN : (double)INFINITY, now_ns, true);
    }
    if (cycle % 12007 == 9000) {
        glue_receive(0, 1e308, now_ns, true); /* the model computes infinity from this setpoint */
    }
    if (cycle % 15013 == 11000) {
        glue_request(false);
    }
    if (cycle % 15013 == 11500 || cycle % 12007 == 9500 || cycle % 7001 == 6500) {
        glue_request(true);
    }
    if (cycle % 7001 == 5000) {
        reading_ns = 600000; /* so each cycle ends after the next tick */
    }
    if (cycle % 7001 == 5030) {
        reading_ns = 700;
    }
}

static void print_cycle(void)
{
    double values[GLUE_MONITORED] = {0};
    epg_status_t s = {0};
    const bool monitored = glue_monitor(values);
    const bool known = glue_status(&s);
    printf("%u %u  %u %u ", counts[0], counts[1], levels[0], levels[1]);
    for (int pin = 0; pin < PINS; pin++) {
        putchar(pins[pin] ? '1' : '0');
    }
    printf("  %d %a %a  %d %d %d %llu", monitored, values[0], values[1], known, s.enabled, (int)s.fault,
           (unsigned long long)s.time_ns);
    printf("  %u %u %u %u %u %u %llu %u %u %u %u %u  %llu\n", s.statistics.cycles, s.statistics.overruns,
           s.statistics.missed, s.statistics.lateness_max, s.statistics.computation_min, s.statistics.computation_max,
           (unsigned long long)s.statistics.computation_total, s.statistics.clamped, s.statistics.setpoints_dropped,
           s.statistics.setpoint_timeouts, s.statistics.faults, s.statistics.reconnects,
           (unsigned long long)port_writes);
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        fputs("usage: driver CYCLES [trace]\n", stderr);
        return 2;
    }
    const unsigned long cycles = strtoul(argv[1], NULL, 10);
    const bool trace = argc > 2 && strcmp(argv[2], "trace") == 0;
    glue_start();
    port_writes = 0; /* the number of writes at the start need not be the same in both programs */
    uint64_t tick_ns = 0;
    for (unsigned long cycle = 0; cycle < cycles; cycle++) {
        tick_ns += period_ns;
        uint32_t missed = 0;
        while (tick_ns + period_ns <= now_ns) {
            tick_ns += period_ns;
            missed++;
        }
        now_ns = now_ns > tick_ns ? now_ns : tick_ns;
        move();
        communicate(cycle, trace);
        glue_cycle(tick_ns, missed);
        if (trace) {
            print_cycle();
        }
    }
    return 0;
}
