/**
 * @file
 * The code that the kinds' templates generate, with the host's simulated peripherals.
 *
 * test_templates.py renders `generated.h` from the components in it: for each component, the results of its macros as
 * functions <component>_<macro>.
 */
#include <math.h>

#include "check.h"
#include "epg/control.h"
#include "epg/plant.h"
#include "epg/target.h"

static epg_control_t app_control;

#include "generated.h"

static const double pi = 3.14159265358979323846;

static void begin(void)
{
    memset(&app_control, 0, sizeof app_control);
    start_all();
    safe_all();
}

/** The position that an encoder reads when its load is at `angle`. */
#define POSITION(encoder, angle) (encoder##_plant_write_position(angle), encoder##_sample(), encoder##_read_position())

TEST(span_gives_radians_at_the_load)
{
    begin();
    for (int i = -100; i <= 100; i++) {
        const double angle = 0.1 * i;
        const double position = POSITION(encoder_span, angle);
        CHECK(position <= angle + 1e-12 && angle - position < pi / 1112.0);
    }
    CHECK(fabs(POSITION(encoder_span, pi * (1.0 + 1e-12)) - pi) < 1e-12);
}

TEST(inverted_span_counts_backwards_and_reads_the_same_angle)
{
    begin();
    const double last = POSITION(encoder_inverted, 1.0);
    CHECK(fabs(last - 1.0) < pi / 1112.0);
    CHECK(encoder_inverted.counts < 0);
    CHECK(fabs(POSITION(encoder_inverted, -2.0) + 2.0) < pi / 1112.0);
}

TEST(counts_per_revolution_and_gear)
{
    begin();
    CHECK(encoder_gear_config.rad_per_count == 2.0 * pi / (4096.0 * 5625.0 / 361.0));
    /* 1000 revolutions of a wheel, 63822.7 counts each: the ratio is exact, so errors do not add up. */
    const double angle = 2000.0 * pi;
    CHECK(fabs(POSITION(encoder_gear, angle) - angle) < 1.01 * 2.0 * pi / 63822.0);
    CHECK_EQUAL(encoder_gear.counts, 63822714);
}

TEST(pins_and_pull_up_are_handed_on)
{
    CHECK_EQUAL(encoder_gear_config.decoder.pin_a, 14);
    CHECK_EQUAL(encoder_gear_config.decoder.pin_b, 15);
    CHECK_EQUAL(encoder_gear_config.decoder.instance, 1);
    CHECK_EQUAL(encoder_gear_config.decoder.slot, 2);
    CHECK(encoder_gear_config.decoder.pull_up);
    CHECK(!encoder_span_config.decoder.pull_up);
}

TEST(reset_loads_the_preset_in_the_next_cycle)
{
    begin();
    POSITION(encoder_preset, 2.0);
    encoder_preset_write_reset(1.0);
    CHECK(fabs(encoder_preset_read_position() - 2.0) < 0.01);
    CHECK(fabs(POSITION(encoder_preset, 2.0) - pi / 2.0) < 1e-12);
    CHECK(fabs(POSITION(encoder_preset, 2.5) - pi / 2.0 - 0.5) < 0.01);
    safe_all();
    CHECK(fabs(POSITION(encoder_preset, 2.5) - pi / 2.0 - 0.5) < 0.01);
}

TEST(encoder_with_a_greatest_speed_checks_the_time_between_samples)
{
    begin();
    app_control.sampled_ns = 1000;
    CHECK(encoder_speed_check() == EPG_FAULT_NONE);
    app_control.sampled_ns += 1249999999;
    CHECK(encoder_speed_check() == EPG_FAULT_NONE);
    app_control.sampled_ns += 1250000000;
    CHECK(encoder_speed_check() >= 256);
}

TEST(bridge_drives_the_plant_with_the_duty_written)
{
    begin();
    CHECK_EQUAL(bridge_plant_read_duty(), 0.0);
    bridge_write_duty(0.25 + 0.25); /* an expression */
    CHECK_EQUAL(bridge_plant_read_duty(), 0.5);
    bridge_write_duty(-0.25);
    CHECK_EQUAL(bridge_plant_read_duty(), -1563.0 / 6250.0);
    CHECK(epg_plant_output(8) && !epg_plant_output(7));
    CHECK_EQUAL(app_control.statistics.clamped, 0);
    bridge_write_duty(-1.0);
    CHECK_EQUAL(bridge_plant_read_duty(), -0.96);
    CHECK_EQUAL(app_control.statistics.clamped, 1);
    safe_all();
    CHECK_EQUAL(bridge_plant_read_duty(), 0.0);
}

TEST(preparing_changes_no_output)
{
    begin();
    bridge_write_duty(0.5);
    bridge_prepare_duty(-0.25);
    CHECK_EQUAL(bridge_plant_read_duty(), 0.5);
    bridge_prepare_duty(2.0);
    CHECK_EQUAL(bridge_plant_read_duty(), 0.5);
    bridge_write_duty(-0.25);
    CHECK_EQUAL(bridge_plant_read_duty(), -1563.0 / 6250.0);
}

TEST(inverted_bridge_is_wired_the_other_way_and_moves_the_plant_the_same)
{
    begin();
    bridge_inverted_write_duty(0.5);
    CHECK(epg_plant_output(6) && !epg_plant_output(5));
    CHECK_EQUAL(bridge_inverted_plant_read_duty(), 0.5);
    bridge_inverted_write_duty(-0.5);
    CHECK_EQUAL(bridge_inverted_plant_read_duty(), -0.5);
}

TEST(bridge_says_what_it_applies)
{
    begin();
    bridge_write_duty(2.0);
    CHECK_EQUAL(bridge_applied_duty(), 0.96);
    bridge_inverted_write_duty(-0.5);
    CHECK_EQUAL(bridge_inverted_applied_duty(), -0.5);
    safe_all();
    CHECK_EQUAL(bridge_applied_duty(), 0.0);
}

TEST(bridge_is_off_between_two_directions_by_default)
{
    begin();
    bridge_default_write_duty(0.9);
    CHECK_EQUAL(bridge_default_plant_read_duty(), 0.9);
    bridge_default_write_duty(-0.1); /* the PWM may still have 0.9: it must not reach the other direction */
    CHECK(!epg_plant_output(18) && !epg_plant_output(19));
    CHECK_EQUAL(bridge_default_plant_read_duty(), 0.0);
    bridge_default_write_duty(-0.1);
    CHECK_EQUAL(bridge_default_plant_read_duty(), -0.1);
}

TEST(bridge_with_dead_time_and_brake)
{
    begin();
    CHECK_EQUAL(bridge_braking_config.bridge.dead_writes, 2); /* 1.5 ms in control cycles of 1 ms */
    bridge_braking_write_duty(0.0);
    CHECK(epg_plant_output(25) && epg_plant_output(26));
    CHECK_EQUAL(bridge_braking_plant_read_duty(), 0.0); /* no voltage */
    bridge_braking_write_duty(0.5);
    CHECK_EQUAL(bridge_braking_plant_read_duty(), 0.5);
    safe_all();
    CHECK(!epg_plant_output(25) && !epg_plant_output(26));
}

TEST(dual_bridge_drives_the_plant_with_the_duty_written)
{
    begin();
    CHECK_EQUAL(dual_plant_read_duty(), 0.0);
    dual_write_duty(0.25 + 0.25);
    CHECK_EQUAL(dual_plant_read_duty(), 0.5);
    CHECK_EQUAL(epg_plant_pwm_duty(10), 0.5);
    CHECK_EQUAL(epg_plant_pwm_duty(11), 0.0);
    dual_write_duty(-2.0);
    CHECK_EQUAL(dual_plant_read_duty(), -0.96);
    CHECK_EQUAL(dual_applied_duty(), -0.96);
    CHECK_EQUAL(app_control.statistics.clamped, 1);
    safe_all();
    CHECK_EQUAL(dual_plant_read_duty(), 0.0);
}

TEST(dual_bridge_with_slow_decay_moves_the_plant_the_same)
{
    begin();
    CHECK_EQUAL(dual_inverted_config.bridge.dead_writes, 1); /* a whole cycle contains a whole period of the PWM */
    CHECK(dual_inverted_config.slow_decay);
    CHECK_EQUAL(epg_plant_pwm_duty(12), 1.0); /* brakes when safe */
    CHECK_EQUAL(epg_plant_pwm_duty(13), 1.0);
    dual_inverted_write_duty(0.25);
    CHECK(fabs(dual_inverted_plant_read_duty() - 0.25) < 1e-3);
    CHECK_EQUAL(epg_plant_pwm_duty(13), 1.0); /* inverted: the other pin has the pulses */
    CHECK(fabs(epg_plant_pwm_duty(12) - 0.75) < 1e-3);
}

static void check_guard(double duty, double angle)
{
    bridge_write_duty(duty);
    (void)POSITION(encoder_span, angle);
}

TEST(guard_sees_duty_and_angle)
{
    begin();
    CHECK_EQUAL(guard_config.stall.cycles, 3); /* 2.5 ms in control cycles of 1 ms */
    CHECK_EQUAL(guard_config.stall.duty, 0.3);
    CHECK_EQUAL(guard_config.homing.cycles, 0);
    check_guard(0.5, 0.0);
    app_control.enabled = false;
    for (int i = 0; i < 10; i++) {
        CHECK(guard_check() == EPG_FAULT_NONE);
    }
    app_control.enabled = true;
    CHECK(guard_check() == EPG_FAULT_NONE);
    CHECK(guard_check() == EPG_FAULT_NONE);
    CHECK(guard_check() == guard_config.faults.stall);

    begin();
    app_control.enabled = true;
    epg_fault_t found = EPG_FAULT_NONE;
    double angle = 0.0;
    for (int i = 0; i < 1000 && found == EPG_FAULT_NONE; i++) {
        angle -= 0.02 + 0.001 * i;
        check_guard(0.5, angle);
        found = guard_check();
    }
    CHECK(found == guard_config.faults.runaway);
    CHECK(angle < -1.0 && angle > -1.1);
}

TEST(guard_knows_the_resets_of_its_encoder)
{
    begin();
    app_control.enabled = true;
    CHECK_EQUAL(guard_homing_config.homing.cycles, 3);
    CHECK(guard_homing_config.homing.travel == pi);
    dual_write_duty(0.1);
    CHECK(guard_homing_check() == EPG_FAULT_NONE);
    (void)POSITION(encoder_preset, 1.0);
    CHECK(guard_homing_check() == EPG_FAULT_NONE);
    encoder_preset_write_reset(1.0);
    for (int i = 0; i < 10; i++) {
        CHECK(guard_homing_check() == EPG_FAULT_NONE);
    }
    begin();
    app_control.enabled = true;
    dual_write_duty(0.1);
    for (int i = 0; i < 3; i++) {
        CHECK(guard_homing_check() == EPG_FAULT_NONE);
    }
    CHECK(guard_homing_check() == guard_homing_config.faults.homing_time);
}

TEST(encoder_whose_decoder_has_stopped)
{
    begin();
    CHECK(encoder_inverted_check() == EPG_FAULT_NONE);
    epg_plant_quadrature_fail(1, true);
    CHECK(encoder_inverted_check() == (epg_fault_t)10);
    CHECK(encoder_span_check() == EPG_FAULT_NONE);
    epg_plant_quadrature_fail(1, false);
    CHECK(encoder_inverted_check() == EPG_FAULT_NONE);
}

TEST(probes_toggle_at_their_point_only)
{
    begin();
    CHECK(!epg_plant_output(31) && !epg_plant_output(32));
    probe_model_probe_model();
    CHECK(epg_plant_output(31));
    probe_model_probe_cycle();
    probe_model_probe_inputs();
    probe_model_probe_outputs();
    probe_model_probe_topic();
    CHECK(epg_plant_output(31));
    probe_model_probe_model();
    CHECK(!epg_plant_output(31));
    probe_topic_probe_model();
    CHECK(!epg_plant_output(32));
    probe_topic_probe_topic();
    CHECK(epg_plant_output(32));
}

TEST(pwm_drives_the_plant_with_the_duty_written)
{
    begin();
    CHECK_EQUAL(servo_plant_read_duty(), 0.08);
    servo_write_duty(0.5);
    CHECK_EQUAL(servo_plant_read_duty(), 0.5);
    servo_write_duty(0.95);
    CHECK_EQUAL(servo_plant_read_duty(), 0.9);
    CHECK_EQUAL(app_control.statistics.clamped, 1);
    lamp_write_duty(0.2);
    CHECK_EQUAL(epg_plant_pwm_duty(7), 0.8); /* the pin's level */
    CHECK(fabs(lamp_plant_read_duty() - 0.2) < 1e-15);
}

TEST(digital_input_from_the_plant)
{
    begin();
    CHECK_EQUAL(button_read_level(), 1.0); /* pulled up, not driven */
    button_plant_write_level(0.25 + 0.25);
    CHECK_EQUAL(button_read_level(), 0.0);
    button_plant_write_level(0.6);
    CHECK_EQUAL(button_read_level(), 1.0);
    gate_plant_write_level(1.0);
    CHECK_EQUAL(gate_read_level(), 1.0);
    gate_plant_write_level(0.0);
    CHECK_EQUAL(gate_read_level(), 0.0);
}

TEST(digital_output_to_the_plant)
{
    begin();
    CHECK_EQUAL(valve_plant_read_level(), 0.0);
    CHECK_EQUAL(brake_plant_read_level(), 1.0);
    CHECK(!epg_plant_output(18)); /* "on" is the low level */
    valve_write_level(1.0);
    brake_write_level(0.0);
    CHECK_EQUAL(valve_plant_read_level(), 1.0);
    CHECK_EQUAL(brake_plant_read_level(), 0.0);
    safe_all();
    CHECK_EQUAL(valve_plant_read_level(), 0.0);
    CHECK_EQUAL(brake_plant_read_level(), 1.0);
}

TEST(topics_and_constant)
{
    epg_setpoint_state_t states[4] = {[3] = {.value = 1.5}};
    const epg_application_t application = {.setpoint_states = states};
    app_control.application = &application;
    CHECK_EQUAL(subscriber_read_value(), 1.5);

    double values[3] = {1.0, 2.0, 3.0};
    publisher_monitor_value(values, 7.0 * 2.0);
    CHECK_EQUAL(values[2], 14.0);
    publisher_monitor_value(values, NAN);
    CHECK_EQUAL(values[2], 14.0);
    CHECK_EQUAL(values[1], 2.0);

    CHECK_EQUAL(number_read_value(), 0.1);
}

/** The bytes of the message of `topic` with its values from `numbers` on. */
static size_t message_size(const epg_topic_t *topic, const double *numbers, unsigned char bytes[512])
{
    const epg_stamp_t stamp = {0};
    return topic->message->write(topic, numbers, stamp, bytes, 512);
}

TEST(messages_are_as_large_as_kinds_say)
{
    const double numbers[6] = {0};
    static const epg_topic_t *const topics[] = {&publisher_topic, &flag_topic,      &array_out_topic, &joints_out_topic,
                                                &twist_out_topic, &range_out_topic, &answer_topic};
    for (size_t i = 0; i < sizeof topics / sizeof topics[0]; i++) {
        unsigned char bytes[512];
        const size_t size = message_size(topics[i], numbers, bytes);
        CHECK(size > 0 && size <= topics[i]->size);
        CHECK(topics[i]->size - size < 48); /* room for padding, not for another message */
    }
}

TEST(values_of_messages_are_where_their_ports_say)
{
    double values[24] = {0};
    double read[6] = {0};
    unsigned char bytes[512];
    joints_out_monitor_pan_position(values, 1.0);
    joints_out_monitor_tilt_effort(values, 2.0);
    size_t size = message_size(&joints_out_topic, &values[6], bytes);
    CHECK(joints_in_topic.message->read(&joints_in_topic, bytes, size, read));
    CHECK_EQUAL(read[0], 1.0);
    CHECK_EQUAL(read[5], 2.0);
    twist_out_monitor_angular_z(values, 3.0);
    CHECK_EQUAL(values[17], 3.0);
    range_out_monitor_radiation_type(values, 1.0);
    range_out_monitor_variance(values, 0.5);
    size = message_size(&range_out_topic, &values[18], bytes);
    CHECK(range_in_topic.message->read(&range_in_topic, bytes, size, read));
    CHECK_EQUAL(read[0], 1.0);
    CHECK_EQUAL(read[5], 0.5);
    array_out_monitor_second(values, 4.0);
    size = message_size(&array_out_topic, &values[4], bytes);
    CHECK(array_in_topic.message->read(&array_in_topic, bytes, size, read));
    CHECK_EQUAL(read[0], 0.0);
    CHECK_EQUAL(read[1], 4.0);
}

RUN()
