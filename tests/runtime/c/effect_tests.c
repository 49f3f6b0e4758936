/**
 * @file
 * The effect of a fault on a motor: control cycle, encoder and H-bridge drivers and a simulated motor in one loop.
 *
 * The controller controls the speed; its setpoint is a load speed in rad/s.  A motor that reaches the setpoint proves
 * that the loop runs.  A motor that slows down without torque proves that its outputs are safe.
 */
#include <math.h>

#include "check.h"
#include "epg/control.h"
#include "epg/finite.h"
#include "fake_port.h"
#include "motor.h"
#include "pwm_h_bridge.h"
#include "quadrature_encoder.h"

enum { PERIOD_NS = 1000000, PIN_A = 7, PIN_B = 8, PIN_FAIL_SAFE = 9, SLOT = 0 };

static const epg_quadrature_encoder_config_t encoder_config = {
    .decoder = {.slot = SLOT}, .rad_per_count = 3.14159265358979323846 / 1112.0, .preset = 0.0};
static const epg_pwm_h_bridge_config_t bridge_config = {
    .pwm = {.slot = SLOT, .prescaler = 1, .top = 6249}, .pin_a = PIN_A, .pin_b = PIN_B, .bridge = {.max_duty = 0.95}};

static epg_control_t control;
static epg_quadrature_encoder_t encoder;
static epg_pwm_h_bridge_t bridge;
static motor_t motor;
static uint64_t tick;

static struct {
    double setpoint;
    double position;
    double last_position;
    double speed; /* filtered */
    double integral;
    double duty;
    double reset;
    unsigned int inits;
} model;

/* The errors that a test causes. */
static struct {
    double sensor;   /* added to the position */
    double integral; /* added to the state */
    double duty;     /* added to the output */
    bool stop;
    uint64_t step_ns;
} wrong;

static void start(void)
{
    epg_quadrature_encoder_start(&encoder, &encoder_config);
    epg_pwm_h_bridge_start(&bridge, &bridge_config);
    epg_port_input_start(PIN_FAIL_SAFE, EPG_PULL_DOWN);
}

static void sample(void)
{
    epg_quadrature_encoder_sample(&encoder, &encoder_config);
}

static void read_inputs(void)
{
    model.position = encoder.position + wrong.sensor;
    model.setpoint = epg_control_setpoint(&control, 0);
}

static bool inputs_finite(void)
{
    return epg_is_finite(model.position) && epg_is_finite(model.setpoint);
}

static void model_init(void)
{
    model.last_position = model.position;
    model.speed = 0.0;
    model.integral = 0.0;
    model.duty = 0.0;
    model.inits++;
}

static void model_step(void)
{
    model.speed += 0.05 * ((model.position - model.last_position) / 1e-3 - model.speed);
    model.last_position = model.position;
    const double error = model.setpoint - model.speed;
    model.integral += 0.5 * error * 1e-3 + wrong.integral;
    model.duty = 0.05 * error + model.integral + wrong.duty;
    model.duty = model.duty > 0.9 ? 0.9 : model.duty; /* a limiter that hides an infinite state from the outputs */
    fake_port.now_ns += wrong.step_ns;
}

static bool model_finite(void)
{
    return epg_is_finite(model.speed) && epg_is_finite(model.integral) && epg_is_finite(model.duty);
}

static bool model_stopped(void)
{
    return wrong.stop;
}

static void prepare_outputs(void)
{
    if (epg_pwm_h_bridge_command(&bridge, &bridge_config, model.duty)) {
        epg_control_count_clamped(&control);
    }
    epg_quadrature_encoder_reset(&encoder, &encoder_config, model.reset);
}

static void write_outputs(void)
{
    epg_pwm_h_bridge_apply(&bridge, &bridge_config);
}

static void safe_outputs(void)
{
    epg_pwm_h_bridge_safe(&bridge, &bridge_config);
    epg_quadrature_encoder_withhold_reset(&encoder);
}

static bool fail_safe(void)
{
    return epg_port_input_read(PIN_FAIL_SAFE);
}

static void monitor(double *values)
{
    values[0] = model.position;
}

static epg_setpoint_t setpoints[1];
static epg_setpoint_sample_t samples[1];
static epg_setpoint_sample_t received[1];
static epg_setpoint_state_t states[1];
static epg_setpoint_sample_t setpoint_buffers[4][1];
static epg_exchange_t setpoint_exchange = EPG_EXCHANGE(setpoint_buffers);
static double monitor_values[1];
static double monitor_buffers[4][1];
static epg_exchange_t monitor_exchange = EPG_EXCHANGE(monitor_buffers);

static const epg_application_t application = {
    .name = "motor",
    .period_ns = PERIOD_NS,
    .step_divider = 1,
    .overrun_limit = 5,
    .enable_at_start = true,
    .start = start,
    .sample = sample,
    .read = read_inputs,
    .inputs_finite = inputs_finite,
    .model_init = model_init,
    .model_step = model_step,
    .model_finite = model_finite,
    .model_stopped = model_stopped,
    .prepare = prepare_outputs,
    .write = write_outputs,
    .safe = safe_outputs,
    .monitor = monitor,
    .fail_safe = fail_safe,
    .setpoint_count = 1,
    .setpoints = setpoints,
    .samples = samples,
    .received = received,
    .setpoint_states = states,
    .setpoint_exchange = &setpoint_exchange,
    .monitor_count = 1,
    .monitor_values = monitor_values,
    .monitor_exchange = &monitor_exchange,
};

/** Simulates the motor and its encoder for one control period, with the present state of the bridge. */
static void plant(void)
{
    const int direction = (int)fake_port.outputs[PIN_A] - (int)fake_port.outputs[PIN_B];
    const double duty = (double)fake_port.levels[SLOT] / 6250.0;
    for (int i = 0; i < 20; i++) {
        motor_step(&motor, direction, duty, 50e-6);
    }
    const int64_t count = epg_quadrature_encoder_count_at(motor.angle, encoder_config.rad_per_count);
    fake_port.counts[SLOT] = (uint32_t)((uint64_t)count & UINT32_MAX);
}

static void cycle(void)
{
    fake_port.now_ns = tick * PERIOD_NS;
    epg_control_cycle(&control, tick * PERIOD_NS, 0);
    tick++;
}

static void run(unsigned int milliseconds)
{
    for (unsigned int i = 0; i < milliseconds; i++) {
        cycle();
        plant();
    }
}

static epg_status_t status(void)
{
    epg_status_t value;
    CHECK(epg_control_status(&control, &value));
    return value;
}

static double load_speed(void)
{
    return motor.speed / 19.0;
}

/** Sends `count` setpoints of 10 rad/s, one every 33 ms. */
static void send(int count)
{
    for (int i = 0; i < count; i++) {
        epg_control_receive(&control, 0, 10.0, fake_port.now_ns, true);
        run(33);
    }
}

/** Brings the motor to 10 rad/s under control. */
static void begin(epg_setpoint_t setpoint)
{
    fake_port_reset();
    fake_port.inputs[PIN_FAIL_SAFE] = true;
    setpoints[0] = setpoint;
    epg_control_start(&control, &application);
    send(91);
    CHECK(status().enabled);
    CHECK(fabs(load_speed() - 10.0) < 0.5);
    CHECK(fabs(motor.torque) > 1e-5);
}

static void check_bridge_off(void)
{
    CHECK_EQUAL(fake_port.levels[SLOT], 0);
    CHECK(!fake_port.outputs[PIN_A] && !fake_port.outputs[PIN_B]);
}

/** The bridge is off in the same cycle; from there the motor coasts to rest without any torque. */
static void check_coasts(void)
{
    const double speed = motor.speed;
    CHECK(speed > 100.0);
    cycle();
    check_bridge_off();
    plant();
    CHECK_EQUAL(motor.torque, 0.0);
    CHECK(motor.speed < speed && motor.speed > 0.98 * speed); /* neither pushed nor braked */
    double last = motor.speed;
    for (int i = 0; i < 3000; i++) {
        cycle();
        check_bridge_off();
        plant();
        CHECK_EQUAL(motor.torque, 0.0);
        CHECK(motor.speed <= last);
        last = motor.speed;
    }
    CHECK_EQUAL(motor.speed, 0.0);
}

static void check_fault(epg_fault_t fault)
{
    check_coasts();
    CHECK(!status().enabled);
    CHECK(status().fault == fault);
}

/** The motor stays off after the cause has gone.  Enabling initialises the model and brings the motor back to speed. */
static void check_comes_back_by_enabling_only(void)
{
    const unsigned int inits = model.inits;
    memset(&wrong, 0, sizeof wrong);
    fake_port.inputs[PIN_FAIL_SAFE] = true;
    run(500);
    CHECK_EQUAL(motor.speed, 0.0);
    CHECK(!status().enabled);
    epg_control_enable(&control, EPG_ENABLE_ANY);
    for (int i = 0; i < 90; i++) {
        epg_control_receive(&control, 0, 10.0, fake_port.now_ns, true);
        run(33);
    }
    CHECK_EQUAL(model.inits, inits + 1);
    CHECK(fabs(load_speed() - 10.0) < 0.5);
    CHECK(status().fault == EPG_FAULT_NONE);
}

TEST(motor_coasts_when_disabled_and_topics_stay_live)
{
    begin((epg_setpoint_t){0});
    epg_stop(&control, EPG_STOP_PROGRAM);
    check_coasts();
    CHECK(status().fault == EPG_FAULT_NONE);
    motor.angle = 1.0; /* turned by hand */
    plant();
    run(1);
    double published;
    CHECK(epg_control_monitor(&control, &published));
    CHECK(fabs(published - 1.0) < 0.01);
    check_comes_back_by_enabling_only();
}

TEST(motor_coasts_when_a_sensor_is_not_a_number)
{
    begin((epg_setpoint_t){0});
    wrong.sensor = NAN;
    check_fault(EPG_FAULT_NOT_FINITE);
    check_comes_back_by_enabling_only();
}

TEST(motor_coasts_when_the_output_is_not_a_number)
{
    begin((epg_setpoint_t){0});
    wrong.duty = NAN;
    check_fault(EPG_FAULT_NOT_FINITE);
    double published;
    CHECK(epg_control_monitor(&control, &published));
    CHECK(isfinite(published));
    check_comes_back_by_enabling_only();
}

TEST(motor_coasts_when_a_state_is_infinite_behind_a_limiter)
{
    begin((epg_setpoint_t){0});
    wrong.integral = INFINITY;
    check_fault(EPG_FAULT_NOT_FINITE);
    CHECK_EQUAL(model.duty, 0.9); /* this would have been full speed */
    check_comes_back_by_enabling_only();
}

TEST(motor_coasts_when_the_model_asks_to_stop)
{
    begin((epg_setpoint_t){0});
    wrong.stop = true;
    check_fault(EPG_FAULT_MODEL_STOPPED);
    check_comes_back_by_enabling_only();
}

TEST(motor_coasts_after_overruns_in_a_row)
{
    begin((epg_setpoint_t){0});
    wrong.step_ns = PERIOD_NS + 1;
    run(4);
    CHECK(status().enabled);
    check_fault(EPG_FAULT_OVERRUN);
    check_comes_back_by_enabling_only();
}

TEST(motor_coasts_when_the_fail_safe_input_falls)
{
    begin((epg_setpoint_t){0});
    fake_port.inputs[PIN_FAIL_SAFE] = false;
    check_fault(EPG_FAULT_FAIL_SAFE);
    check_comes_back_by_enabling_only();
}

/** Setpoints have come every 33 ms until now; from here on there are none. */
static void begin_with_sender(epg_timeout_action_t action)
{
    begin((epg_setpoint_t){.timeout_ns = 500 * (uint64_t)PERIOD_NS, .action = action});
    send(30);
    CHECK(fabs(load_speed() - 10.0) < 0.5);
    epg_control_receive(&control, 0, 10.0, tick * PERIOD_NS, true);
    run(501);
    CHECK(fabs(load_speed() - 10.0) < 0.5);
}

TEST(motor_coasts_when_setpoints_end_and_the_action_is_to_disable)
{
    begin_with_sender(EPG_TIMEOUT_DISABLE);
    check_fault(EPG_FAULT_SETPOINT_TIMEOUT);
    check_comes_back_by_enabling_only();
}

TEST(motor_is_driven_to_rest_when_setpoints_end_and_the_action_is_zero)
{
    begin_with_sender(EPG_TIMEOUT_ZERO);
    cycle();
    CHECK_EQUAL(model.setpoint, 0.0);
    plant();
    run(6000);
    CHECK(status().enabled);
    CHECK(fabs(load_speed()) < 0.2);
    epg_control_receive(&control, 0, 10.0, fake_port.now_ns, true);
    run(450);
    CHECK(load_speed() > 5.0);
}

TEST(motor_goes_on_when_setpoints_end_and_the_action_is_to_hold)
{
    begin_with_sender(EPG_TIMEOUT_HOLD);
    run(5000);
    CHECK(status().enabled);
    CHECK_EQUAL(status().statistics.setpoint_timeouts, 1);
    CHECK(fabs(load_speed() - 10.0) < 0.5);
}

TEST(motor_goes_on_when_a_setpoint_is_not_finite)
{
    begin((epg_setpoint_t){0});
    for (int i = 0; i < 100; i++) {
        epg_control_receive(&control, 0, i % 2 == 0 ? NAN : INFINITY, fake_port.now_ns, true);
        run(10);
        CHECK(fabs(load_speed() - 10.0) < 0.5);
    }
    CHECK_EQUAL(status().statistics.setpoints_dropped, 100);
    CHECK(status().enabled);
}

TEST(motor_is_not_pushed_by_a_stall)
{
    begin((epg_setpoint_t){0});
    for (int i = 0; i < 20; i++) { /* 20 ms without a cycle: the bridge keeps its duty */
        plant();
    }
    tick += 20;
    const unsigned int cycles = status().statistics.cycles;
    fake_port.now_ns = tick * PERIOD_NS;
    epg_control_cycle(&control, tick * PERIOD_NS, 20);
    tick++;
    CHECK_EQUAL(status().statistics.cycles, cycles + 1);
    CHECK_EQUAL(status().statistics.missed, 20);
    CHECK(status().enabled);
    run(3000);
    CHECK(fabs(load_speed() - 10.0) < 0.5);
}

TEST(too_large_a_duty_is_limited_and_counted)
{
    begin((epg_setpoint_t){0});
    CHECK_EQUAL(status().statistics.clamped, 0);
    wrong.duty = -5.0;
    run(10);
    CHECK_EQUAL(status().statistics.clamped, 10);
    CHECK_EQUAL(fake_port.levels[SLOT], 5938); /* 0.95 * 6250, rounded */
}

TEST(encoder_zero_stays_while_disabled)
{
    begin((epg_setpoint_t){0});
    model.reset = 1.0;
    run(1);
    model.reset = 0.0;
    run(1);
    const double origin = motor.angle - encoder.position;
    CHECK(encoder.position < 0.1); /* the reset has acted: the motor has turned by 30 rad */
    epg_stop(&control, EPG_STOP_PROGRAM);
    run(1);
    model.reset = 1.0; /* the model homes while it is disabled */
    run(100);
    model.reset = 0.0;
    run(2000);
    CHECK(fabs(motor.angle - encoder.position - origin) < 0.01);
}

RUN()
