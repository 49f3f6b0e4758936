/**
 * @file
 * The component drivers with a port layer whose signals are all recorded.
 */
#include <math.h>

#include "check.h"
#include "digital_input.h"
#include "digital_output.h"
#include "epg/finite.h"
#include "fake_port.h"
#include "pwm.h"
#include "pwm_h_bridge.h"
#include "quadrature_encoder.h"

/* Quadrature encoder -------------------------------------------------------------------------------------------- */

static const epg_quadrature_encoder_config_t encoder_config = {
    .decoder = {.pin_a = 10, .pin_b = 11, .slot = 1},
    .rad_per_count = 0.5,
    .preset = 100.0,
};
static epg_quadrature_encoder_t encoder;

static double position_at(uint32_t count)
{
    fake_port.counts[1] = count;
    epg_quadrature_encoder_sample(&encoder, &encoder_config);
    return encoder.position;
}

static void reset(double signal)
{
    epg_quadrature_encoder_reset(&encoder, &encoder_config, signal);
}

static void begin_encoder(uint32_t count)
{
    fake_port_reset();
    fake_port.counts[1] = count;
    epg_quadrature_encoder_start(&encoder, &encoder_config);
}

TEST(encoder_starts_at_zero_wherever_the_decoder_stands)
{
    begin_encoder(12345);
    CHECK_EQUAL(position_at(12345), 0.0);
    CHECK_EQUAL(position_at(12347), 1.0);
    CHECK_EQUAL(position_at(12341), -2.0);
}

TEST(encoder_wraps_at_32_bits_both_ways)
{
    begin_encoder(UINT32_MAX - 1);
    CHECK_EQUAL(position_at(2), 2.0);
    CHECK_EQUAL(position_at(UINT32_MAX), 0.5);
    CHECK_EQUAL(position_at(UINT32_MAX - 9), -4.0);
    CHECK_EQUAL(position_at(0), 1.0);
}

TEST(encoder_counts_beyond_32_bits)
{
    begin_encoder(0);
    uint32_t count = 0;
    for (int i = 0; i < 10; i++) {
        count += 2000000000U;
        position_at(count);
    }
    CHECK_EQUAL(encoder.position, 10 * 1e9);
    for (int i = 0; i < 20; i++) {
        count -= 2000000000U;
        position_at(count);
    }
    CHECK_EQUAL(encoder.position, -10 * 1e9);
}

TEST(encoder_reset_is_visible_in_the_next_cycle_only)
{
    begin_encoder(0);
    CHECK_EQUAL(position_at(40), 20.0);
    reset(1.0);
    CHECK_EQUAL(encoder.position, 20.0);
    CHECK_EQUAL(position_at(40), 100.0);
}

TEST(encoder_reset_loses_no_counts)
{
    begin_encoder(0);
    CHECK_EQUAL(position_at(40), 20.0);
    fake_port.counts[1] = 43; /* between sampling and reset */
    reset(1.0);
    CHECK_EQUAL(position_at(47), 103.5); /* 7 counts after the sample to which the reset refers */
    reset(1.0);
    CHECK_EQUAL(position_at(49), 104.5);
}

TEST(encoder_reset_acts_on_a_rising_edge_only)
{
    begin_encoder(0);
    position_at(40);
    reset(0.5); /* not above the threshold */
    CHECK_EQUAL(position_at(40), 20.0);
    reset(0.51);
    CHECK_EQUAL(position_at(42), 101.0);
    reset(2.0); /* still high */
    reset(1.0);
    CHECK_EQUAL(position_at(42), 101.0);
    reset(0.0);
    CHECK_EQUAL(position_at(42), 101.0);
    reset(1.0);
    CHECK_EQUAL(position_at(42), 100.0);
}

TEST(encoder_counts_its_resets)
{
    begin_encoder(0);
    CHECK_EQUAL(encoder.resets, 0);
    reset(1.0);
    reset(1.0);
    CHECK_EQUAL(encoder.resets, 1);
    reset(0.0);
    reset(1.0);
    CHECK_EQUAL(encoder.resets, 2);
}

TEST(encoder_whose_decoder_has_stopped)
{
    begin_encoder(0);
    CHECK(epg_quadrature_encoder_healthy(&encoder_config));
    fake_port.decoders_failed[1] = true;
    CHECK(!epg_quadrature_encoder_healthy(&encoder_config));
}

TEST(encoder_that_was_not_sampled_for_too_long)
{
    const epg_quadrature_encoder_config_t config = {.longest_gap_ns = 1000};
    epg_quadrature_encoder_t late = {.sampled_ns = 0};
    CHECK(epg_quadrature_encoder_followed(&late, &config, 5000)); /* the first sample */
    CHECK(epg_quadrature_encoder_followed(&late, &config, 5999));
    CHECK(!epg_quadrature_encoder_followed(&late, &config, 6999));
    CHECK(epg_quadrature_encoder_followed(&late, &config, 7000)); /* the fault is latched elsewhere */
    CHECK(!epg_quadrature_encoder_followed(&late, &config, UINT64_C(10000000000)));
}

TEST(encoder_reset_by_nan_does_nothing)
{
    begin_encoder(0);
    position_at(40);
    reset(NAN);
    CHECK_EQUAL(position_at(40), 20.0);
}

TEST(encoder_first_high_signal_after_withholding_is_an_edge)
{
    begin_encoder(0);
    position_at(40);
    reset(1.0);
    position_at(50);
    epg_quadrature_encoder_withhold_reset(&encoder);
    CHECK_EQUAL(position_at(50), 105.0); /* the zero position does not change */
    reset(1.0);
    CHECK_EQUAL(position_at(50), 100.0);
}

TEST(encoder_of_simulated_edges)
{
    CHECK(epg_quadrature_encoder_count_at(0.0, 0.25) == 0);
    CHECK(epg_quadrature_encoder_count_at(0.24, 0.25) == 0);
    CHECK(epg_quadrature_encoder_count_at(0.25, 0.25) == 1);
    CHECK(epg_quadrature_encoder_count_at(-0.01, 0.25) == -1);
    CHECK(epg_quadrature_encoder_count_at(-0.25, 0.25) == -1);
    CHECK(epg_quadrature_encoder_count_at(1e9 + 0.1, 0.25) == 4000000000);
    CHECK(epg_quadrature_encoder_count_at(0.26, -0.25) == -1);
    CHECK(epg_quadrature_encoder_count_at(-0.26, -0.25) == 2);
    CHECK(epg_quadrature_encoder_count_at(NAN, 0.25) == 0);
    CHECK(epg_quadrature_encoder_count_at(INFINITY, 0.25) == 0);
    CHECK(epg_quadrature_encoder_count_at(1e300, 0.25) == INT64_C(4611686018427387904));
    CHECK(epg_quadrature_encoder_count_at(-1e300, 0.25) == -INT64_C(4611686018427387904));
}

/* H-bridge ------------------------------------------------------------------------------------------------------ */

enum { BRIDGE_A = 7, BRIDGE_B = 8 };

static epg_pwm_h_bridge_config_t bridge_config = {
    .pwm = {.pin = 2, .slot = 3, .prescaler = 1, .top = 6249},
    .pin_a = BRIDGE_A,
    .pin_b = BRIDGE_B,
    .bridge = {.max_duty = 0.9},
};
static epg_pwm_h_bridge_t bridge;

/** Direction of the bridge: 1, 0 (coasting) or -1. */
static int direction(void)
{
    CHECK(!(fake_port.outputs[BRIDGE_A] && fake_port.outputs[BRIDGE_B])); /* never a short circuit */
    return (int)fake_port.outputs[BRIDGE_A] - (int)fake_port.outputs[BRIDGE_B];
}

static int last_direction;

/** The direction never changes while the PWM still has a level of the other direction. */
static void watch_bridge(void)
{
    const int now = direction();
    if (now != last_direction) {
        CHECK_EQUAL(fake_port.levels[3], 0);
    }
    last_direction = now;
}

static void watch_coasting(void)
{
    CHECK_EQUAL(direction(), 0);
}

static void begin_bridge(bool invert, double max_duty)
{
    fake_port_reset();
    last_direction = 0;
    fake_port.on_write = watch_coasting;
    bridge_config.bridge = (epg_bridge_config_t){.invert = invert, .max_duty = max_duty};
    epg_pwm_h_bridge_start(&bridge, &bridge_config);
    fake_port.on_write = watch_bridge;
}

static bool drive(double duty)
{
    const bool limited = epg_pwm_h_bridge_command(&bridge, &bridge_config, duty);
    epg_pwm_h_bridge_apply(&bridge, &bridge_config);
    return limited;
}

TEST(bridge_starts_coasting)
{
    begin_bridge(false, 0.9);
    CHECK_EQUAL(fake_port.tops[3], 6249);
    CHECK_EQUAL(fake_port.levels[3], 0);
    CHECK_EQUAL(direction(), 0);
}

TEST(bridge_started_again_drives_again)
{
    begin_bridge(false, 0.9);
    drive(0.5);
    begin_bridge(false, 0.9);
    drive(0.5);
    CHECK_EQUAL(direction(), 1);
}

TEST(bridge_sign_gives_the_direction)
{
    begin_bridge(false, 0.9);
    CHECK(!drive(0.5));
    CHECK_EQUAL(direction(), 1);
    CHECK_EQUAL(fake_port.levels[3], 3125);
    CHECK(!drive(-0.25));
    CHECK_EQUAL(direction(), -1);
    CHECK_EQUAL(fake_port.levels[3], 1563); /* 1562.5, rounded */
    CHECK(!drive(0.0));
    CHECK_EQUAL(direction(), 0);
    CHECK_EQUAL(fake_port.levels[3], 0);
}

TEST(bridge_inverted)
{
    begin_bridge(true, 0.9);
    drive(0.5);
    CHECK_EQUAL(direction(), -1);
    drive(-0.5);
    CHECK_EQUAL(direction(), 1);
}

TEST(bridge_limits_and_says_so)
{
    begin_bridge(false, 0.9);
    CHECK(!drive(0.9));
    CHECK_EQUAL(fake_port.levels[3], 5625);
    CHECK(drive(0.91));
    CHECK_EQUAL(fake_port.levels[3], 5625);
    CHECK(drive(-1e308));
    CHECK_EQUAL(fake_port.levels[3], 5625);
    CHECK_EQUAL(direction(), -1);
    begin_bridge(false, 1.0);
    CHECK(!drive(1.0));
    CHECK_EQUAL(fake_port.levels[3], 6250); /* always high */
}

TEST(bridge_coasts_on_a_duty_that_is_not_finite)
{
    const double wrong[] = {NAN, -NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 4; i++) {
        begin_bridge(false, 0.9);
        drive(0.5);
        CHECK(drive(wrong[i]));
        CHECK_EQUAL(fake_port.levels[3], 0);
        CHECK_EQUAL(direction(), 0);
    }
}

TEST(bridge_coasts_below_half_a_clock)
{
    begin_bridge(false, 0.9);
    drive(0.00007);
    CHECK_EQUAL(direction(), 0);
    drive(0.00009);
    CHECK_EQUAL(direction(), 1);
    CHECK_EQUAL(fake_port.levels[3], 1);
}

TEST(bridge_never_drives_the_wrong_way)
{
    begin_bridge(false, 1.0);
    uint32_t random = 1;
    for (int i = 0; i < 100000; i++) {
        random = random * 1664525U + 1013904223U;
        const double duty = (double)(random >> 8) / 8388608.0 - 1.0;
        drive(duty); /* watch_bridge() checks each intermediate signal */
        CHECK(direction() == (duty > 0.0001 ? 1 : duty < -0.0001 ? -1 : direction()));
    }
}

TEST(bridge_leaves_the_direction_alone_while_the_sign_stays)
{
    begin_bridge(false, 0.9);
    drive(0.1);
    const unsigned int writes = fake_port.writes;
    drive(0.2);
    CHECK_EQUAL(fake_port.writes, writes + 1);
}

TEST(bridge_safe_writes_every_signal)
{
    begin_bridge(false, 0.9);
    fake_port.on_write = NULL;
    fake_port.levels[3] = 77; /* earlier code may have left them so */
    fake_port.outputs[BRIDGE_A] = true;
    fake_port.outputs[BRIDGE_B] = true;
    epg_pwm_h_bridge_safe(&bridge, &bridge_config);
    CHECK_EQUAL(fake_port.levels[3], 0);
    CHECK_EQUAL(direction(), 0);
    drive(0.5);
    CHECK_EQUAL(direction(), 1);
}

/* PWM ----------------------------------------------------------------------------------------------------------- */

static const epg_pwm_config_t pwm = {.pwm = {.slot = 2, .top = 999}, .max_duty = 0.8, .safe_duty = 0.075};
static const epg_pwm_config_t pwm_inverted = {
    .pwm = {.slot = 2, .top = 999}, .invert = true, .max_duty = 1.0, .safe_duty = 0.0};

static bool set_duty(const epg_pwm_config_t *config, double duty)
{
    uint32_t level;
    const bool limited = epg_pwm_command(config, duty, &level);
    epg_pwm_apply(config, level);
    return limited;
}

TEST(pwm_starts_safe)
{
    fake_port_reset();
    epg_pwm_start(&pwm);
    CHECK_EQUAL(fake_port.levels[2], 75);
    epg_pwm_start(&pwm_inverted);
    CHECK_EQUAL(fake_port.levels[2], 1000);
}

TEST(pwm_limits_and_says_so)
{
    fake_port_reset();
    epg_pwm_start(&pwm);
    CHECK(!set_duty(&pwm, 0.5));
    CHECK_EQUAL(fake_port.levels[2], 500);
    CHECK(!set_duty(&pwm, 0.5006));
    CHECK_EQUAL(fake_port.levels[2], 501);
    CHECK(!set_duty(&pwm, 0.5004));
    CHECK_EQUAL(fake_port.levels[2], 500);
    CHECK(!set_duty(&pwm, 0.8));
    CHECK_EQUAL(fake_port.levels[2], 800);
    CHECK(set_duty(&pwm, 0.81));
    CHECK_EQUAL(fake_port.levels[2], 800);
    CHECK(set_duty(&pwm, -0.1));
    CHECK_EQUAL(fake_port.levels[2], 0);
    CHECK(!set_duty(&pwm, 0.0));
    epg_pwm_safe(&pwm);
    CHECK_EQUAL(fake_port.levels[2], 75);
}

TEST(pwm_is_safe_on_a_duty_that_is_not_finite)
{
    fake_port_reset();
    epg_pwm_start(&pwm);
    const double wrong[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        set_duty(&pwm, 0.5);
        CHECK(set_duty(&pwm, wrong[i]));
        CHECK_EQUAL(fake_port.levels[2], 75);
    }
}

TEST(pwm_inverted_is_the_complement)
{
    fake_port_reset();
    epg_pwm_start(&pwm_inverted);
    set_duty(&pwm_inverted, 0.25);
    CHECK_EQUAL(fake_port.levels[2], 750);
    set_duty(&pwm_inverted, 1.0);
    CHECK_EQUAL(fake_port.levels[2], 0);
}

TEST(pwm_of_the_longest_period)
{
    fake_port_reset();
    const epg_pwm_config_t longest = {.pwm = {.slot = 2, .top = 65535}, .max_duty = 1.0};
    epg_pwm_start(&longest);
    CHECK(!set_duty(&longest, 1.0));
    CHECK_EQUAL(fake_port.levels[2], 65536);
}

/* Digital pins -------------------------------------------------------------------------------------------------- */

TEST(digital_input_levels)
{
    fake_port_reset();
    const epg_digital_input_config_t input = {.pin = 5, .pull = EPG_PULL_UP, .invert = false};
    const epg_digital_input_config_t active_low = {.pin = 5, .pull = EPG_PULL_UP, .invert = true};
    epg_digital_input_start(&input);
    CHECK(fake_port.pulls[5] == EPG_PULL_UP);
    CHECK_EQUAL(epg_digital_input_read(&input), 0.0);
    CHECK_EQUAL(epg_digital_input_read(&active_low), 1.0);
    fake_port.inputs[5] = true;
    CHECK_EQUAL(epg_digital_input_read(&input), 1.0);
    CHECK_EQUAL(epg_digital_input_read(&active_low), 0.0);
}

TEST(digital_output_levels)
{
    for (int i = 0; i < 4; i++) {
        fake_port_reset();
        const epg_digital_output_config_t output = {.pin = 6, .invert = (i & 1) != 0, .safe = (i & 2) != 0};
        epg_digital_output_start(&output);
        CHECK(fake_port.outputs[6] == (output.safe != output.invert));
        epg_digital_output_write(&output, 0.51);
        CHECK(fake_port.outputs[6] == !output.invert);
        epg_digital_output_write(&output, 0.5);
        CHECK(fake_port.outputs[6] == output.invert);
        epg_digital_output_write(&output, NAN);
        CHECK(fake_port.outputs[6] == output.invert);
        epg_digital_output_write(&output, output.safe ? 0.0 : 1.0);
        epg_digital_output_safe(&output);
        CHECK(fake_port.outputs[6] == (output.safe != output.invert));
    }
}

/* Publisher ----------------------------------------------------------------------------------------------------- */

TEST(publisher_keeps_the_last_finite_value)
{
    double slot = 0.0;
    epg_assign_finite(&slot, 3.0);
    epg_assign_finite(&slot, NAN);
    epg_assign_finite(&slot, INFINITY);
    CHECK_EQUAL(slot, 3.0);
}

RUN()
