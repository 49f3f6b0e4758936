/**
 * @file
 * H-bridges: coasting and braking, dead time, and the bridge with two PWM inputs.
 */
#include <math.h>

#include "check.h"
#include "dual_pwm_h_bridge.h"
#include "fake_port.h"
#include "pwm_h_bridge.h"

enum { CLOCKS = 1000, VALUE = 0, FORWARDS = 1, BACKWARDS = 2, PIN_A = 7, PIN_B = 8 };

static epg_pwm_h_bridge_config_t config = {.pwm = {.slot = VALUE, .top = CLOCKS - 1}, .pin_a = PIN_A, .pin_b = PIN_B};
static epg_pwm_h_bridge_t bridge;
static epg_dual_pwm_h_bridge_config_t dual_config = {.forwards = {.slot = FORWARDS, .top = CLOCKS - 1},
                                                     .backwards = {.slot = BACKWARDS, .top = CLOCKS - 1}};
static epg_dual_pwm_h_bridge_t dual;

static void begin(epg_bridge_config_t bridge_config)
{
    fake_port_reset();
    config.bridge = bridge_config;
    epg_pwm_h_bridge_start(&bridge, &config);
}

static void begin_dual(epg_bridge_config_t bridge_config, bool slow_decay)
{
    fake_port_reset();
    dual_config.bridge = bridge_config;
    dual_config.slow_decay = slow_decay;
    epg_dual_pwm_h_bridge_start(&dual, &dual_config);
}

static bool drive(double duty)
{
    const bool limited = epg_pwm_h_bridge_command(&bridge, &config, duty);
    epg_pwm_h_bridge_apply(&bridge, &config);
    return limited;
}

static void check_pins(bool a, bool b, unsigned int level)
{
    CHECK(fake_port.outputs[PIN_A] == a);
    CHECK(fake_port.outputs[PIN_B] == b);
    CHECK_EQUAL(fake_port.levels[VALUE], level);
}

static bool drive_dual(double duty)
{
    const bool limited = epg_dual_pwm_h_bridge_command(&dual, &dual_config, duty);
    epg_dual_pwm_h_bridge_set(&dual, &dual_config);
    return limited;
}

static void check_levels(unsigned int forwards, unsigned int backwards)
{
    CHECK_EQUAL(fake_port.levels[FORWARDS], forwards);
    CHECK_EQUAL(fake_port.levels[BACKWARDS], backwards);
}

/* The applied duty ----------------------------------------------------------------------------------------------- */

TEST(applied_duty_is_what_the_motor_is_given)
{
    begin((epg_bridge_config_t){.max_duty = 0.8});
    CHECK_EQUAL(bridge.bridge.duty, 0.0);
    drive(-0.25);
    CHECK_EQUAL(bridge.bridge.duty, -0.25);
    CHECK(drive(1.0));
    CHECK_EQUAL(bridge.bridge.duty, 0.8);
    drive(0.0004); /* less than half a clock */
    CHECK_EQUAL(bridge.bridge.duty, 0.0);
    drive(0.5);
    CHECK(drive(NAN));
    CHECK_EQUAL(bridge.bridge.duty, 0.0);
    drive(0.5);
    epg_pwm_h_bridge_safe(&bridge, &config);
    CHECK_EQUAL(bridge.bridge.duty, 0.0);
}

TEST(applied_duty_of_an_inverted_bridge_has_the_sign_that_was_asked_for)
{
    begin((epg_bridge_config_t){.invert = true, .max_duty = 1.0});
    drive(0.5);
    CHECK_EQUAL(bridge.bridge.duty, 0.5);
    check_pins(false, true, 500);
}

/* Coast and brake ----------------------------------------------------------------------------------------------- */

TEST(brakes_at_zero_and_coasts_when_safe)
{
    begin((epg_bridge_config_t){.max_duty = 1.0, .zero = EPG_BRIDGE_BRAKE});
    check_pins(false, false, 0);
    drive(0.5);
    drive(0.0);
    check_pins(true, true, CLOCKS);
    drive(0.0);
    check_pins(true, true, CLOCKS);
    drive(-0.5);
    check_pins(false, true, 500);
    epg_pwm_h_bridge_safe(&bridge, &config);
    check_pins(false, false, 0);
}

TEST(brakes_when_safe_and_coasts_at_zero)
{
    begin((epg_bridge_config_t){.max_duty = 1.0, .safe = EPG_BRIDGE_BRAKE});
    check_pins(true, true, CLOCKS);
    drive(0.0);
    check_pins(false, false, 0);
    drive(0.5);
    CHECK(drive(INFINITY));
    check_pins(true, true, CLOCKS);
    fake_port.outputs[PIN_A] = false; /* earlier code may have left it so */
    epg_pwm_h_bridge_safe(&bridge, &config);
    check_pins(true, true, CLOCKS);
}

static bool last_a, last_b;

/** Pins change only while the PWM is low: no pulse of one state occurs with the pins of another. */
static void watch(void)
{
    if (fake_port.outputs[PIN_A] != last_a || fake_port.outputs[PIN_B] != last_b) {
        CHECK_EQUAL(fake_port.levels[VALUE], 0);
    }
    last_a = fake_port.outputs[PIN_A];
    last_b = fake_port.outputs[PIN_B];
}

TEST(goes_through_off_between_brake_and_drive)
{
    begin((epg_bridge_config_t){.max_duty = 1.0, .zero = EPG_BRIDGE_BRAKE});
    fake_port.on_write = watch;
    const double duties[] = {0.0, -0.5, 0.0, 0.5, -0.5, 0.0, 0.5};
    for (int i = 0; i < 7; i++) {
        drive(duties[i]);
    }
    check_pins(true, false, 500);
}

/* Dead time ----------------------------------------------------------------------------------------------------- */

TEST(dead_time_between_directions)
{
    begin((epg_bridge_config_t){.max_duty = 1.0, .dead_writes = 2});
    drive(0.5);
    check_pins(true, false, 500); /* no dead time before the first drive */
    for (int direction = 0; direction < 2; direction++) {
        const double duty = direction == 0 ? -0.5 : 0.5;
        drive(duty);
        check_pins(false, false, 0);
        CHECK_EQUAL(bridge.bridge.duty, 0.0);
        drive(duty);
        check_pins(false, false, 0);
        drive(duty);
        check_pins(direction == 1, direction == 0, 500);
        CHECK_EQUAL(bridge.bridge.duty, duty);
    }
}

TEST(dead_time_is_none_when_the_direction_comes_back)
{
    begin((epg_bridge_config_t){.max_duty = 1.0, .dead_writes = 3});
    drive(0.5);
    drive(-0.5);
    drive(0.5);
    check_pins(true, false, 500);
    drive(0.0);
    drive(0.25);
    check_pins(true, false, 250);
}

TEST(dead_time_has_run_while_the_bridge_coasts)
{
    begin((epg_bridge_config_t){.max_duty = 1.0, .dead_writes = 2});
    drive(0.5);
    drive(0.0);
    drive(0.0);
    drive(-0.5);
    check_pins(false, true, 500);
    epg_pwm_h_bridge_safe(&bridge, &config);
    drive(0.5);
    check_pins(false, false, 0);
    drive(0.5);
    check_pins(true, false, 500);
}

TEST(dead_time_does_not_run_while_the_bridge_brakes)
{
    begin((epg_bridge_config_t){.max_duty = 1.0, .zero = EPG_BRIDGE_BRAKE, .dead_writes = 1});
    drive(0.5);
    for (int i = 0; i < 5; i++) {
        drive(0.0);
        check_pins(true, true, CLOCKS);
    }
    drive(-0.5);
    check_pins(false, false, 0);
    drive(-0.5);
    check_pins(false, true, 500);
}

TEST(a_duty_that_changes_sign_faster_than_the_dead_time_never_drives_both_ways)
{
    begin((epg_bridge_config_t){.max_duty = 1.0, .dead_writes = 2});
    drive(0.5);
    for (int i = 0; i < 100; i++) {
        drive(-0.5);
        CHECK(!fake_port.outputs[PIN_B]);
        drive(0.5);
    }
}

/* Two PWM inputs ------------------------------------------------------------------------------------------------ */

TEST(dual_with_fast_decay)
{
    begin_dual((epg_bridge_config_t){.max_duty = 0.9}, false);
    CHECK_EQUAL(fake_port.tops[FORWARDS], CLOCKS - 1);
    check_levels(0, 0);
    CHECK(!drive_dual(0.25));
    check_levels(250, 0);
    CHECK(!drive_dual(-0.25));
    check_levels(0, 250);
    CHECK(drive_dual(-2.0));
    check_levels(0, 900);
    drive_dual(0.0);
    check_levels(0, 0);
}

TEST(dual_with_slow_decay)
{
    begin_dual((epg_bridge_config_t){.max_duty = 1.0}, true);
    check_levels(0, 0); /* coasts: slow decay happens only between pulses */
    drive_dual(0.25);
    check_levels(CLOCKS, 750);
    drive_dual(-0.25);
    check_levels(750, CLOCKS);
    drive_dual(1.0);
    check_levels(CLOCKS, 0);
    drive_dual(0.0);
    check_levels(0, 0);
}

TEST(dual_brakes)
{
    begin_dual((epg_bridge_config_t){.max_duty = 1.0, .zero = EPG_BRIDGE_BRAKE, .safe = EPG_BRIDGE_BRAKE}, false);
    check_levels(CLOCKS, CLOCKS);
    drive_dual(0.5);
    check_levels(500, 0);
    drive_dual(0.0);
    check_levels(CLOCKS, CLOCKS);
    CHECK(drive_dual(NAN));
    check_levels(CLOCKS, CLOCKS);
}

TEST(dual_inverted)
{
    begin_dual((epg_bridge_config_t){.invert = true, .max_duty = 1.0}, false);
    drive_dual(0.5);
    check_levels(0, 500);
    CHECK_EQUAL(dual.bridge.duty, 0.5);
}

TEST(dual_dead_time)
{
    begin_dual((epg_bridge_config_t){.max_duty = 1.0, .dead_writes = 1}, true);
    drive_dual(0.5);
    drive_dual(-0.5);
    check_levels(0, 0);
    drive_dual(-0.5);
    check_levels(500, CLOCKS);
}

static void watch_dual(void)
{
    CHECK(fake_port.levels[FORWARDS] == 0 || fake_port.levels[BACKWARDS] == 0);
}

/** A PWM period may end between the two writes.  It then uses the values that were written by then. */
TEST(dual_has_no_pulses_both_ways_between_two_writes)
{
    begin_dual((epg_bridge_config_t){.max_duty = 1.0}, false);
    fake_port.on_write = watch_dual;
    uint32_t random = 1;
    for (int i = 0; i < 10000; i++) {
        random = random * 1664525U + 1013904223U;
        drive_dual((double)(random >> 8) / 8388608.0 - 1.0);
    }
}

RUN()
