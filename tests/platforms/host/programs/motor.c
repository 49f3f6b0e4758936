/*
 * A target like the generator's, but small and written by hand: a position controller with one quadrature encoder, one
 * PWM output with a direction pin, one subscription, one publication, an enable topic and a fail-safe input, and a
 * DC motor as its plant.
 *
 * With a setpoint of 1000 or more, the controller computes for (setpoint - 1000) milliseconds of monotonic time.  The
 * tests of overruns in real time use this.
 */
#include <math.h>
#include <stdio.h>

#include "epg/finite.h"
#include "epg/host.h"
#include "epg/middleware.h"
#include "epg/port.h"
#include "epg/store.h"

#ifndef PERIOD_NS
#define PERIOD_NS 1000000
#endif
#ifndef STEPS_PER_PERIOD
#define STEPS_PER_PERIOD 7 /* a step is not an integer number of nanoseconds */
#endif
#ifndef OVERRUN_LIMIT
#define OVERRUN_LIMIT 3
#endif
#ifndef SETPOINT_TIMEOUT_NS
#define SETPOINT_TIMEOUT_NS 0
#endif
#ifndef ENABLE_AT_START
#define ENABLE_AT_START true
#endif

#define RADIANS_PER_COUNT (2.0 * 3.14159265358979323846 / 4096.0)

enum { DIRECTION = 3, FAIL_SAFE = 5 };

static const epg_port_quadrature_t encoder = {.pin_a = 0, .pin_b = 1, .instance = 0, .slot = 0, .pull_up = false};
static const epg_port_pwm_t pwm = {.pin = 2, .instance = 0, .slot = 1, .prescaler = 1, .top = 6249};

static epg_control_t control;

static double position;
static double setpoint;
static double duty;
static double cycle_count;

/* The parameters of the controller: its gain, and the largest duty. */
static const epg_parameter_t parameter_table[] = {{"PID\\kp", "1/rad", 0.8}, {"PID\\limit", "", 0.9}};
enum { PARAMETERS = sizeof parameter_table / sizeof parameter_table[0] };
static double gains[PARAMETERS];
static double requested[PARAMETERS];
static double applied[PARAMETERS];
static bool wanted[PARAMETERS];
static bool changed[PARAMETERS];

static void set_gains(const double *values, const bool *which)
{
    for (size_t i = 0; i < PARAMETERS; i++) {
        gains[i] = which[i] ? values[i] : gains[i];
    }
}

static epg_parameters_t parameters = {.count = PARAMETERS,
                                      .table = parameter_table,
                                      .model = 1,
                                      .set = set_gains,
                                      .values = requested,
                                      .wanted = wanted,
                                      .applied = applied,
                                      .changed = changed};
static unsigned char store_bytes[EPG_STORE_SIZE(PARAMETERS)];
static epg_store_t store = {.bytes = store_bytes, .parameters = &parameters};

static void start(void)
{
    epg_store_load(&store);
    epg_port_quadrature_start(&encoder);
    epg_port_pwm_start(&pwm);
    epg_port_output_start(DIRECTION, false);
    epg_port_input_start(FAIL_SAFE, EPG_PULL_UP);
}

static void sample(void)
{
    position = (double)(int32_t)epg_port_quadrature_count(&encoder) * RADIANS_PER_COUNT;
}

static void read_inputs(void)
{
    setpoint = epg_control_setpoint(&control, 0);
}

static bool inputs_finite(void)
{
    return epg_is_finite(position) && epg_is_finite(setpoint);
}

static void model_init(void)
{
    duty = 0.0;
    for (size_t i = 0; i < PARAMETERS; i++) {
        gains[i] = parameter_table[i].value;
    }
}

static void model_step(void)
{
    cycle_count += 1.0;
    if (setpoint >= 1000.0) {
        const uint64_t end_ns = epg_port_time_ns() + (uint64_t)((setpoint - 1000.0) * 1e6);
        while (epg_port_time_ns() < end_ns) {
        }
        duty = 0.0;
        return;
    }
    duty = fmax(-gains[1], fmin(gains[1], gains[0] * (setpoint - position)));
}

static bool model_finite(void)
{
    return epg_is_finite(duty);
}

static void write_outputs(void)
{
    epg_port_output_write(DIRECTION, duty < 0.0);
    epg_port_pwm_write(&pwm, (uint32_t)(fabs(duty) * 6250.0 + 0.5));
}

static void safe(void)
{
    epg_port_pwm_write(&pwm, 0);
}

static void monitor(double *values)
{
    values[0] = position;
    values[1] = setpoint;
}

static bool fail_safe(void)
{
    return epg_port_input_read(FAIL_SAFE);
}

static const epg_setpoint_t setpoints[1] = {
    {.initial = 0.25, .timeout_ns = SETPOINT_TIMEOUT_NS, .action = EPG_TIMEOUT_ZERO}};
static epg_setpoint_sample_t samples[1];
static epg_setpoint_sample_t received[1];
static epg_setpoint_state_t setpoint_states[1];
static epg_setpoint_sample_t setpoint_buffers[4][1];
static epg_exchange_t setpoint_exchange = EPG_EXCHANGE(setpoint_buffers);
static double monitor_values[2];
static double monitor_buffers[4][2];
static epg_exchange_t monitor_exchange = EPG_EXCHANGE(monitor_buffers);

static const epg_application_t application = {
    .name = "motor",
    .period_ns = PERIOD_NS,
    .step_divider = 1,
    .overrun_limit = OVERRUN_LIMIT,
    .enable_at_start = ENABLE_AT_START,
    .start = start,
    .sample = sample,
    .read = read_inputs,
    .inputs_finite = inputs_finite,
    .model_init = model_init,
    .model_step = model_step,
    .model_finite = model_finite,
    .write = write_outputs,
    .safe = safe,
    .monitor = monitor,
    .fail_safe = fail_safe,
    .fail_safe_component = 2,
    .setpoint_count = 1,
    .setpoints = setpoints,
    .samples = samples,
    .received = received,
    .setpoint_states = setpoint_states,
    .setpoint_exchange = &setpoint_exchange,
    .monitor_count = 2,
    .monitor_values = monitor_values,
    .monitor_exchange = &monitor_exchange,
    .parameters = &parameters,
};

static const epg_topic_t subscriptions[2] = {{.name = "motor_setpoint", .count = 1},
                                             {.name = "motor_enable", .role = EPG_TOPIC_ENABLE, .count = 1}};
static const epg_topic_t publications[2] = {{.name = "motor_position", .count = 1},
                                            {.name = "motor_echo", .index = 1, .count = 1}};

static const char *const components[] = {"encoder", "motor", "emergency_stop"};

#ifdef CONNECTED
/* A middleware that makes its own connection. */
static void middleware_start(const epg_target_t *of, const epg_stream_t *stream)
{
    (void)of;
    (void)stream;
    puts("connected");
    fflush(stdout);
}

static void middleware_poll(uint64_t now_ns)
{
    (void)now_ns;
}

static const epg_middleware_t middleware = {
    .start = middleware_start, .poll = middleware_poll, .wait = epg_port_wait_until};
#endif

static const epg_target_t target = {
#ifdef CONNECTED
    .middleware = &middleware,
#endif
    .control = &control,
    .application = &application,
    .node = "motor_node",
    .name_space = "",
    .communication_period_ns = 33000000,
    .subscription_count = 2,
    .subscriptions = subscriptions,
    .publication_count = 2,
    .publications = publications,
    .component_count = sizeof components / sizeof components[0],
    .components = components,
    .store = &store,
};

/* The plant: a motor that reaches 20 rad/s at full duty with a time constant of 50 ms. */
static double plant_duty;
static double speed;
static double angle;
static double plant_steps;

static void plant_init(void)
{
    speed = 0.0;
    angle = 12.5; /* the encoder must still count from 0 */
}

static void plant_actuate(void)
{
    plant_duty = epg_plant_pwm_duty(1) * (epg_plant_output(DIRECTION) ? -1.0 : 1.0);
}

static void plant_step(void)
{
    const double step = PERIOD_NS * 1e-9 / STEPS_PER_PERIOD;
    speed += step * (20.0 * plant_duty - speed) / 0.05;
    angle += step * speed;
    plant_steps += 1.0;
#ifdef PLANT_DIVERGES
    if (plant_steps > 1000.0) {
        angle = PLANT_DIVERGES;
    }
#endif
}

static void plant_sense(void)
{
#ifdef PLANT_HOLDS_INPUT
    epg_plant_input_set(FAIL_SAFE, true);
#endif
    epg_plant_quadrature_set(0, (int64_t)floor(angle / RADIANS_PER_COUNT));
}

extern const epg_plant_t motor_plant; /* not static, because it may be unused */
const epg_plant_t motor_plant = {
    .steps_per_period = STEPS_PER_PERIOD,
    .init = plant_init,
    .actuate = plant_actuate,
    .step = plant_step,
    .sense = plant_sense,
};

static const epg_host_signal_t signals[] = {
    {"inputs.position", &position},     {"inputs.setpoint", &setpoint},  {"outputs.duty", &duty},
    {"plant.inputs.duty", &plant_duty}, {"plant.outputs.angle", &angle}, {"plant.steps", &plant_steps},
    {"model.steps", &cycle_count},
};

static const epg_host_input_t inputs[] = {{.name = "emergency_stop", .pin = FAIL_SAFE}};

extern const epg_host_target_t epg_host_application;
const epg_host_target_t epg_host_application = {
    .target = &target,
#ifndef WITHOUT_PLANT
    .plant = &motor_plant,
#endif
    .signal_count = sizeof signals / sizeof signals[0],
    .signals = signals,
    .plant_output_count = 1,
    .plant_outputs = &signals[4],
    .input_count = sizeof inputs / sizeof inputs[0],
    .inputs = inputs,
};
