/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * JIWY written by hand, as an engineer would write it for this one robot without a generator.
 *
 * Pan and tilt have an encoder and an H-bridge each.  There are two setpoints and two published values; the control
 * period is 1 ms.  The program does the same as the generated target with the same configuration: wait-free exchanges,
 * statistics, status, faults, motion guards, and tests for values that are not finite.  Functions that this robot does
 * not configure are left out: timeout and rate limit of setpoints, fail-safe inputs, conversions, step dividers.  Numbers are
 * constants, everything for the cycle is in this file, and the model's functions and arrays are used directly.
 */
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "epg/port.h"
#include "glue.h"
#include "guard.h"

#define PERIOD_NS 1000000u
#define OVERRUN_LIMIT 10u
#ifndef PWM_TOP
#define PWM_TOP 6249u
#endif
#define STATES 22
#define PAN_RAD_PER_COUNT 0.002825173249631109  /* 180 degrees in 1112 counts */
#define TILT_RAD_PER_COUNT 0.007107675686854735 /* 90 degrees in 221 counts */

#define PAN_HOMING_TRAVEL 3.490658503988659   /* 200 degrees */
#define TILT_HOMING_TRAVEL 1.9198621771937625 /* 110 degrees */

/* The numbers of faults that the runtime leaves to components. */
enum { FAULT_STALL = 6, FAULT_RUNAWAY, FAULT_HOMING_TRAVEL, FAULT_HOMING_TIME, FAULT_SENSOR };

/* The model that 20-sim has exported (xxsubmod.c, xxmodel.c). */
extern void XXInitializeSubmodel(double *u, double *y, double t);
extern void XXCalculateSubmodel(double *u, double *y, double t);
extern double xx_I[22], xx_P[30], xx_R[STATES], xx_V[56], xx_s[STATES];
extern double xx_finish_time, xx_start_time, xx_step_size, xx_time;
extern char xx_initialize, xx_major, xx_stop_simulation;
extern int xx_steps;

enum { POSITION_PAN, POSITION_TILT, SETPOINT_PAN, SETPOINT_TILT, INPUTS };
enum { RESET_PAN, RESET_TILT, LOGGING_PAN, DUTY_PAN, DUTY_TILT, LOGGING_TILT, OUTPUTS };

typedef struct encoder {
    int64_t counts;
    uint32_t last_count;
    bool reset_level;
} encoder_t;

typedef struct bridge {
    int8_t direction;
    double duty; /* as applied */
} bridge_t;

/* The control words of an exchange with four buffers, after H. Simpson. */
typedef struct exchange {
    atomic_uint latest;
    atomic_uint reading;
    atomic_uint newest[2];
    atomic_bool written;
} exchange_t;

static const epg_port_quadrature_t decoder_pan = {.pin_a = 0, .pin_b = 1, .slot = 0};
static const epg_port_quadrature_t decoder_tilt = {.pin_a = 2, .pin_b = 3, .slot = 1};
static const epg_port_pwm_t pwm_pan = {.pin = 4, .slot = 0, .prescaler = 1, .top = PWM_TOP};
static const epg_port_pwm_t pwm_tilt = {.pin = 7, .slot = 1, .prescaler = 1, .top = PWM_TOP};
enum { PAN_A = 5, PAN_B = 6, TILT_A = 8, TILT_B = 9 };

/* Control side. */
static encoder_t encoder_pan, encoder_tilt;
static bridge_t bridge_pan, bridge_tilt;
static guard_t guard_pan, guard_tilt;
static double u[INPUTS], y[OUTPUTS], setpoints[GLUE_SETPOINTS];
static epg_statistics_t statistics;
static epg_fault_t fault;
static bool enabled, initialise, model_valid;
static uint32_t consecutive_overruns;
static unsigned int request_seen, alive_seen;
static uint32_t silence;

/* Shared by both sides. */
static atomic_uint request, dropped, reconnects, alive;
static exchange_t setpoint_exchange, monitor_exchange, status_exchange;
static double setpoint_buffers[4][GLUE_SETPOINTS];
static double monitor_buffers[4][GLUE_MONITORED];
static epg_status_t status_buffers[4];

/* Communication side. */
static double received[GLUE_SETPOINTS];

static bool is_finite(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (bits >> 52 & 0x7FFu) != 0x7FFu;
}

/*
 * Exchange.  write_begin() returns the buffer to write to, and write_end() announces it.  read_begin() returns the
 * buffer to read from, or -1 before the first write.
 */

static unsigned int write_begin(exchange_t *exchange)
{
    const unsigned int pair = 1u - atomic_load(&exchange->reading);
    return 2u * pair + 1u - atomic_load(&exchange->newest[pair]);
}

static void write_end(exchange_t *exchange, unsigned int buffer)
{
    atomic_store(&exchange->newest[buffer / 2u], buffer % 2u);
    atomic_store(&exchange->latest, buffer / 2u);
    atomic_store(&exchange->written, true);
}

static int read_begin(exchange_t *exchange)
{
    if (!atomic_load(&exchange->written)) {
        return -1;
    }
    const unsigned int pair = atomic_load(&exchange->latest);
    atomic_store(&exchange->reading, pair);
    return (int)(2u * pair + atomic_load(&exchange->newest[pair]));
}

/* Encoders */

static double encoder_sample(encoder_t *encoder, const epg_port_quadrature_t *decoder, double rad_per_count)
{
    const uint32_t count = epg_port_quadrature_count(decoder);
    encoder->counts += (int32_t)(count - encoder->last_count);
    encoder->last_count = count;
    return (double)encoder->counts * rad_per_count;
}

static void encoder_reset(encoder_t *encoder, guard_t *guard, double signal)
{
    const bool level = signal > 0.5;
    if (level && !encoder->reset_level) {
        encoder->counts = 0;
        guard->moved = true;
    }
    encoder->reset_level = level;
}

/* H-bridges */

static void bridge_safe(bridge_t *bridge, const epg_port_pwm_t *pwm, uint8_t pin_a, uint8_t pin_b)
{
    epg_port_pwm_write(pwm, 0);
    epg_port_output_write(pin_a, false);
    epg_port_output_write(pin_b, false);
    bridge->direction = 0;
    bridge->duty = 0.0;
}

static void bridge_write(bridge_t *bridge, const epg_port_pwm_t *pwm, uint8_t pin_a, uint8_t pin_b, double duty)
{
    if (!is_finite(duty)) {
        bridge_safe(bridge, pwm, pin_a, pin_b);
        statistics.clamped++;
        return;
    }
    double magnitude = duty < 0.0 ? -duty : duty;
    if (magnitude > 1.0) {
        magnitude = 1.0;
        statistics.clamped++;
    }
    const uint32_t level = (uint32_t)(magnitude * (PWM_TOP + 1.0) + 0.5);
    const int8_t direction = level == 0 ? 0 : duty < 0.0 ? -1 : 1;
    if (direction != bridge->direction) {
        bridge_safe(bridge, pwm, pin_a, pin_b);
        if (direction != 0) {
            epg_port_output_write(direction > 0 ? pin_a : pin_b, true);
        }
        bridge->direction = direction;
    }
    bridge->duty = direction == 0 ? 0.0 : direction < 0 ? -magnitude : magnitude;
    epg_port_pwm_write(pwm, level);
}

static void safe_outputs(void)
{
    encoder_pan.reset_level = false;
    encoder_tilt.reset_level = false;
    bridge_safe(&bridge_pan, &pwm_pan, PAN_A, PAN_B);
    bridge_safe(&bridge_tilt, &pwm_tilt, TILT_A, TILT_B);
}

/* Model */

static bool inputs_finite(void)
{
    return is_finite(u[POSITION_PAN]) && is_finite(u[POSITION_TILT]) && is_finite(u[SETPOINT_PAN]) &&
           is_finite(u[SETPOINT_TILT]);
}

static bool model_finite(void)
{
    for (int i = 0; i < STATES; i++) {
        if (!is_finite(xx_s[i]) || !is_finite(xx_R[i])) {
            return false;
        }
    }
    for (int i = 0; i < OUTPUTS; i++) {
        if (!is_finite(y[i])) {
            return false;
        }
    }
    return true;
}

static void model_init(void)
{
    memset(xx_I, 0, sizeof xx_I);
    memset(xx_P, 0, sizeof xx_P);
    memset(xx_R, 0, sizeof xx_R);
    memset(xx_V, 0, sizeof xx_V);
    memset(xx_s, 0, sizeof xx_s);
    xx_start_time = 0.0;
    xx_finish_time = 20.0;
    xx_step_size = 0.001;
    xx_time = 0.0;
    xx_initialize = 1;
    xx_major = 1;
    xx_steps = 0;
    xx_stop_simulation = 0;
    XXInitializeSubmodel(u, y, 0.0);
}

/* Control cycle */

static void latch(epg_fault_t cause)
{
    if (fault == EPG_FAULT_NONE) {
        fault = cause;
        statistics.faults++;
    }
    enabled = false;
}

/* Motion guards */

static epg_fault_t homes(guard_t *guard, double travel, double angle, double duty)
{
    const double travelled = angle - guard->homing_origin;
    if (travelled > travel || travelled < -travel) {
        return (epg_fault_t)FAULT_HOMING_TRAVEL;
    }
    if (duty != 0.0) {
        guard->driven++;
    }
    return guard->driven > HOMING_CYCLES ? (epg_fault_t)FAULT_HOMING_TIME : EPG_FAULT_NONE;
}

static void check_motion(guard_t *guard, double travel, double angle, double duty)
{
    epg_fault_t cause = EPG_FAULT_NONE;
    if (!enabled) {
        guard->armed = false;
        return;
    }
    if (!guard->armed || guard->moved) {
        guard->homing = !guard->armed;
        if (guard->homing) {
            guard->homing_origin = angle;
            guard->driven = 0;
        }
        guard->armed = true;
        guard->moved = false;
        guard_begin(guard, angle);
    }
    if (runs_away(guard, angle, duty)) {
        cause = (epg_fault_t)FAULT_RUNAWAY;
    } else if (guard->homing) {
        cause = homes(guard, travel, angle, duty);
    } else if (stalls(guard, angle, duty)) {
        cause = (epg_fault_t)FAULT_STALL;
    }
    if (cause != EPG_FAULT_NONE) {
        latch(cause);
    }
}

static void handle_request(void)
{
    const unsigned int newest = atomic_load(&request);
    if (newest == request_seen) {
        return;
    }
    request_seen = newest;
    if ((newest & 1u) == 0u) {
        enabled = false;
    } else if (!enabled) {
        fault = EPG_FAULT_NONE;
        enabled = true;
        initialise = true;
        consecutive_overruns = 0;
    }
}

static bool run_model(void)
{
    if (!inputs_finite()) {
        initialise = false;
        model_valid = false;
        latch(EPG_FAULT_NOT_FINITE);
        return false;
    }
    if (initialise) {
        model_init();
        initialise = false;
        model_valid = true;
    }
    if (!model_valid) {
        return false;
    }
    XXCalculateSubmodel(u, y, xx_time);
    if (!model_finite()) {
        model_valid = false;
        latch(EPG_FAULT_NOT_FINITE);
        return false;
    }
    if (xx_stop_simulation) {
        model_valid = false;
        latch(EPG_FAULT_MODEL_STOPPED);
    }
    return true;
}

static uint32_t saturated(uint64_t value)
{
    return value < UINT32_MAX ? (uint32_t)value : UINT32_MAX;
}

static void count_cycle(uint64_t tick_ns, uint64_t begin_ns, uint64_t end_ns, uint32_t missed)
{
    const uint32_t lateness = begin_ns > tick_ns ? saturated(begin_ns - tick_ns) : 0u;
    const uint32_t computation = saturated(end_ns - begin_ns);
    statistics.cycles++;
    statistics.missed += missed;
    if (lateness > statistics.lateness_max) {
        statistics.lateness_max = lateness;
    }
    if (computation < statistics.computation_min || statistics.cycles == 1) {
        statistics.computation_min = computation;
    }
    if (computation > statistics.computation_max) {
        statistics.computation_max = computation;
    }
    statistics.computation_total += computation;
    if (end_ns > tick_ns + PERIOD_NS || missed > 0) {
        statistics.overruns++;
        consecutive_overruns++;
    } else {
        consecutive_overruns = 0;
    }
    if (consecutive_overruns >= OVERRUN_LIMIT) {
        latch(EPG_FAULT_OVERRUN);
        safe_outputs();
    }
}

/** Counts the cycles since the last sign of life of the communication side, for a watchdog. */
static void count_silence(void)
{
    const unsigned int newest = atomic_load(&alive);
    if (newest != alive_seen) {
        alive_seen = newest;
        silence = 0;
    } else if (newest != 0u) {
        silence++;
        if (silence > statistics.silence_max) {
            statistics.silence_max = silence;
        }
    }
}

void glue_cycle(uint64_t tick_ns, uint32_t missed)
{
    const uint64_t begin_ns = epg_port_time_ns();

    const int newest = read_begin(&setpoint_exchange);
    if (newest >= 0) {
        memcpy(setpoints, setpoint_buffers[newest], sizeof setpoints);
    }
    handle_request();

    u[POSITION_PAN] = encoder_sample(&encoder_pan, &decoder_pan, PAN_RAD_PER_COUNT);
    u[POSITION_TILT] = encoder_sample(&encoder_tilt, &decoder_tilt, TILT_RAD_PER_COUNT);
    if (!epg_port_quadrature_healthy(&decoder_pan) || !epg_port_quadrature_healthy(&decoder_tilt)) {
        latch((epg_fault_t)FAULT_SENSOR);
    }
    check_motion(&guard_pan, PAN_HOMING_TRAVEL, u[POSITION_PAN], bridge_pan.duty);
    check_motion(&guard_tilt, TILT_HOMING_TRAVEL, u[POSITION_TILT], bridge_tilt.duty);
    u[SETPOINT_PAN] = setpoints[0];
    u[SETPOINT_TILT] = setpoints[1];
    const bool stepped = run_model();

    if (!enabled) {
        safe_outputs();
    } else if (stepped) {
        encoder_reset(&encoder_pan, &guard_pan, y[RESET_PAN]);
        encoder_reset(&encoder_tilt, &guard_tilt, y[RESET_TILT]);
        bridge_write(&bridge_pan, &pwm_pan, PAN_A, PAN_B, y[DUTY_PAN]);
        bridge_write(&bridge_tilt, &pwm_tilt, TILT_A, TILT_B, y[DUTY_TILT]);
    }
    if (stepped) {
        const unsigned int buffer = write_begin(&monitor_exchange);
        monitor_buffers[buffer][0] = y[LOGGING_PAN];
        monitor_buffers[buffer][1] = y[LOGGING_TILT];
        write_end(&monitor_exchange, buffer);
    }

    count_cycle(tick_ns, begin_ns, epg_port_time_ns(), missed);
    count_silence();
    statistics.setpoints_dropped = atomic_load(&dropped);
    statistics.reconnects = atomic_load(&reconnects);
    const unsigned int buffer = write_begin(&status_exchange);
    status_buffers[buffer] =
        (epg_status_t){.enabled = enabled, .fault = fault, .time_ns = tick_ns, .statistics = statistics};
    write_end(&status_exchange, buffer);
}

void glue_start(void)
{
    enabled = true;
    initialise = true;
    epg_port_quadrature_start(&decoder_pan);
    encoder_pan.last_count = epg_port_quadrature_count(&decoder_pan);
    epg_port_quadrature_start(&decoder_tilt);
    encoder_tilt.last_count = epg_port_quadrature_count(&decoder_tilt);
    epg_port_output_start(PAN_A, false);
    epg_port_output_start(PAN_B, false);
    epg_port_pwm_start(&pwm_pan);
    epg_port_output_start(TILT_A, false);
    epg_port_output_start(TILT_B, false);
    epg_port_pwm_start(&pwm_tilt);
    safe_outputs();
}

/* Communication side */

bool glue_receive(size_t index, double value, uint64_t received_ns, bool publish)
{
    (void)received_ns;
    if (index >= GLUE_SETPOINTS) {
        return false;
    }
    const bool finite = is_finite(value);
    if (finite) {
        received[index] = value;
    } else {
        atomic_store(&dropped, atomic_load(&dropped) + 1u);
    }
    if (publish) {
        const unsigned int buffer = write_begin(&setpoint_exchange);
        memcpy(setpoint_buffers[buffer], received, sizeof received);
        write_end(&setpoint_exchange, buffer);
    }
    return finite;
}

bool glue_monitor(double values[GLUE_MONITORED])
{
    const int buffer = read_begin(&monitor_exchange);
    if (buffer >= 0) {
        memcpy(values, monitor_buffers[buffer], sizeof monitor_buffers[buffer]);
    }
    return buffer >= 0;
}

bool glue_status(epg_status_t *status)
{
    const int buffer = read_begin(&status_exchange);
    if (buffer >= 0) {
        *status = status_buffers[buffer];
    }
    return buffer >= 0;
}

void glue_request(bool enable)
{
    const unsigned int sequence = (atomic_load(&request) | 1u) + 1u;
    atomic_store(&request, sequence | (enable ? 1u : 0u));
}
