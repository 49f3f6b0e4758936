/**
 * @file
 * Setpoints: initial value, rate limit, age, and values that are not finite.
 */
#include <math.h>

#include "check.h"
#include "fake_application.h"
#include "fake_port.h"

enum { TIMEOUT_NS = 10 * FAKE_PERIOD_NS };

static void begin(epg_setpoint_t setpoint)
{
    fake_reset();
    fake.setpoints[0] = setpoint;
    fake_start();
}

static double value(size_t index)
{
    return epg_control_setpoint(&fake.control, index);
}

TEST(initial_until_the_first_one_arrives)
{
    begin((epg_setpoint_t){.initial = 0.25, .timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    fake_cycles(100);
    CHECK_EQUAL(value(0), 0.25);
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake_status().statistics.setpoint_timeouts, 0);
    fake_receive(0, 3.0);
    fake_cycle();
    CHECK_EQUAL(value(0), 3.0);
}

TEST(not_finite_is_dropped_and_counted_and_the_value_before_it_stays)
{
    begin((epg_setpoint_t){.initial = 1.0});
    fake_cycle();
    CHECK(!fake_receive(0, NAN));
    fake_cycle();
    CHECK_EQUAL(value(0), 1.0);
    CHECK(fake_receive(0, 2.0));
    CHECK(!fake_receive(0, INFINITY));
    CHECK(!fake_receive(0, -INFINITY));
    fake_cycle();
    CHECK_EQUAL(value(0), 2.0);
    CHECK_EQUAL(fake_status().statistics.setpoints_dropped, 3);
    CHECK(fake_status().enabled);
}

TEST(not_finite_does_not_count_as_fresh)
{
    begin((epg_setpoint_t){.timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_ZERO});
    fake_cycle();
    fake_receive(0, 2.0);
    for (int i = 0; i < 20; i++) {
        fake_receive(0, NAN);
        fake_cycle();
    }
    CHECK_EQUAL(value(0), 0.0);
}

TEST(values_handed_over_together_arrive_together)
{
    begin((epg_setpoint_t){0});
    fake_cycle();
    epg_control_receive(&fake.control, 0, 1.0, 0, false);
    fake_cycle();
    CHECK_EQUAL(value(0), 0.0);
    epg_control_receive(&fake.control, 1, 2.0, 0, true);
    fake_cycle();
    CHECK_EQUAL(value(0), 1.0);
    CHECK_EQUAL(value(1), 2.0);
}

TEST(a_dropped_last_value_publishes_those_before_it)
{
    begin((epg_setpoint_t){0});
    fake_cycle();
    epg_control_receive(&fake.control, 0, 1.0, 0, false);
    CHECK(!epg_control_receive(&fake.control, 1, NAN, 0, true));
    fake_cycle();
    CHECK_EQUAL(value(0), 1.0);
    CHECK_EQUAL(value(1), 0.0);
}

TEST(a_setpoint_that_does_not_exist_is_refused)
{
    begin((epg_setpoint_t){0});
    CHECK(!fake_receive(FAKE_SETPOINTS, 1.0));
    fake_cycle();
    CHECK_EQUAL(fake_status().statistics.setpoints_dropped, 0);
}

TEST(rate_limit_both_ways_from_the_initial_value)
{
    begin((epg_setpoint_t){.initial = 1.0, .rate_limit = 500.0}); /* 0.5 per cycle */
    fake_receive(0, 2.25);
    fake_cycle();
    CHECK_EQUAL(value(0), 1.5);
    fake_cycle();
    CHECK_EQUAL(value(0), 2.0);
    fake_cycle();
    CHECK_EQUAL(value(0), 2.25);
    fake_receive(0, 1.5);
    fake_cycle();
    CHECK_EQUAL(value(0), 1.75);
    fake_cycle();
    CHECK_EQUAL(value(0), 1.5);
    fake_cycles(10);
    CHECK_EQUAL(value(0), 1.5);
}

TEST(rate_limit_does_not_catch_up_after_missed_cycles)
{
    begin((epg_setpoint_t){.rate_limit = 500.0});
    fake_receive(0, 100.0);
    fake_cycle();
    fake_late_cycle(0, 50);
    CHECK_EQUAL(value(0), 1.0);
}

TEST(rate_limit_of_the_largest_change)
{
    begin((epg_setpoint_t){.initial = -1.7e308, .rate_limit = 1000.0});
    fake_receive(0, 1.7e308);
    fake_cycles(3);
    CHECK(isfinite(value(0)));
    CHECK(value(0) < 0.0);
}

TEST(hold_keeps_the_value_and_counts_once)
{
    begin((epg_setpoint_t){.timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_HOLD});
    fake_cycle();
    fake_receive(0, 5.0);
    fake_cycles(30);
    CHECK_EQUAL(value(0), 5.0);
    CHECK_EQUAL(fake_status().statistics.setpoint_timeouts, 1);
    CHECK(fake_status().enabled);
    fake_receive(0, 6.0);
    fake_cycles(30);
    CHECK_EQUAL(value(0), 6.0);
    CHECK_EQUAL(fake_status().statistics.setpoint_timeouts, 2);
}

TEST(zero_comes_after_the_timeout_and_ends_with_a_fresh_one)
{
    begin((epg_setpoint_t){.timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_ZERO});
    fake_cycle(); /* at 0 */
    fake_receive(0, 5.0);
    fake_cycles(10);
    CHECK_EQUAL(value(0), 5.0); /* at 10 ms its age is exactly the timeout */
    fake_cycle();
    CHECK_EQUAL(value(0), 0.0);
    CHECK(fake_status().enabled);
    fake_receive(0, 4.0);
    fake_cycle();
    CHECK_EQUAL(value(0), 4.0);
}

TEST(zero_obeys_the_rate_limit)
{
    begin((epg_setpoint_t){.initial = 0.0, .rate_limit = 1000.0, .timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_ZERO});
    fake_receive(0, 3.0);
    fake_cycles(11);
    CHECK_EQUAL(value(0), 3.0);
    fake_cycle();
    CHECK_EQUAL(value(0), 2.0);
    fake_cycle();
    CHECK_EQUAL(value(0), 1.0);
    fake_cycles(5);
    CHECK_EQUAL(value(0), 0.0);
}

TEST(disable_latches)
{
    begin((epg_setpoint_t){.initial = 0.5, .timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    fake_cycle();
    fake_receive(0, 5.0);
    fake_cycles(10);
    CHECK(fake.actuator > 0.0);
    const unsigned int writes = fake.writes;
    fake_cycle();
    CHECK_EQUAL(fake.writes, writes);
    CHECK_EQUAL(fake.actuator, 0.0);
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_SETPOINT_TIMEOUT);
    fake_receive(0, 6.0);
    fake_cycles(5);
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_SETPOINT_TIMEOUT);
}

TEST(enabling_does_not_revive_a_command_whose_sender_has_gone)
{
    begin((epg_setpoint_t){.initial = 0.5, .timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    fake_receive(0, 5.0);
    fake_cycles(20);
    CHECK(!fake_status().enabled);
    epg_control_request(&fake.control, true);
    fake_cycle(); /* at 20 ms */
    CHECK(fake_status().enabled);
    CHECK_EQUAL(value(0), 0.5);
    fake_cycles(10); /* to 30 ms */
    CHECK(fake_status().enabled);
    fake_cycle();
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake_status().statistics.faults, 2);
}

TEST(enabling_takes_the_value_of_a_sender_that_is_back)
{
    begin((epg_setpoint_t){.initial = 0.5, .timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    fake_receive(0, 5.0);
    fake_cycles(20);
    fake_receive(0, 6.0);
    epg_control_request(&fake.control, true);
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK_EQUAL(value(0), 6.0);
}

TEST(an_old_setpoint_is_no_fault_while_disabled)
{
    begin((epg_setpoint_t){.timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    fake_receive(0, 5.0);
    epg_control_request(&fake.control, false);
    fake_cycles(50);
    CHECK(fake_status().fault == EPG_FAULT_NONE);
    epg_control_request(&fake.control, true);
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK_EQUAL(value(0), 0.0);
}

TEST(timeouts_start_again_when_enabled)
{
    begin((epg_setpoint_t){.timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    fake_receive(0, 5.0);
    epg_control_request(&fake.control, false);
    fake_cycles(8);
    epg_control_request(&fake.control, true);
    fake_cycles(10); /* up to 17 ms */
    CHECK(fake_status().enabled);
    CHECK_EQUAL(value(0), 5.0); /* it had not timed out when the target was enabled */
    fake_cycles(2);
    CHECK(!fake_status().enabled);
}

TEST(a_sample_younger_than_the_cycle_is_fresh)
{
    begin((epg_setpoint_t){.timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_ZERO});
    epg_control_receive(&fake.control, 0, 5.0, 500, true);
    fake_cycle();
    CHECK_EQUAL(value(0), 5.0);
    CHECK_EQUAL(fake_status().statistics.setpoint_timeouts, 0);
}

TEST(equal_values_are_fresh_ones)
{
    begin((epg_setpoint_t){.timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    for (int i = 0; i < 21; i++) {
        fake_receive(0, 5.0);
        fake_cycles(5);
    }
    CHECK(fake_status().enabled);
    fake_cycles(10);
    CHECK(!fake_status().enabled);
}

TEST(one_setpoint_going_on_does_not_keep_another_fresh)
{
    fake_reset();
    fake.setpoints[0] = (epg_setpoint_t){.timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE};
    fake.setpoints[1] = (epg_setpoint_t){.timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE};
    fake.setpoints[0].component = 7;
    fake.setpoints[1].component = 8;
    fake_start();
    fake_receive(0, 1.0);
    for (int i = 0; i < 20; i++) {
        fake_receive(1, 1.0);
        fake_cycle();
    }
    CHECK(fake_status().fault == EPG_FAULT_SETPOINT_TIMEOUT);
    CHECK_EQUAL(fake_status().fault_component, 7);
}

TEST(the_count_of_samples_may_wrap)
{
    begin((epg_setpoint_t){.timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_ZERO});
    fake.application.received[0].count = UINT32_MAX - 1;
    for (int i = 0; i < 4; i++) {
        fake_receive(0, 1.0 + i);
        fake_cycle();
        CHECK_EQUAL(value(0), 1.0 + i);
    }
    fake_cycles(20);
    CHECK_EQUAL(value(0), 0.0); /* it still counts as arrived */
}

static size_t arrivals[4];
static size_t arrival_count;

static void arrived(size_t index)
{
    arrivals[arrival_count++] = index;
}

TEST(whoever_wants_to_know_is_told_of_each_arrival)
{
    fake_reset();
    fake.application.arrived = arrived;
    fake_start();
    epg_control_receive(&fake.control, 1, 1.0, 0, false);
    epg_control_receive(&fake.control, 0, NAN, 0, true);
    CHECK(!epg_control_receive(&fake.control, FAKE_SETPOINTS, 1.0, 0, true));
    CHECK_EQUAL(arrival_count, 2);
    CHECK_EQUAL(arrivals[0], 1);
    CHECK_EQUAL(arrivals[1], 0);
}

RUN(ENTRY(initial_until_the_first_one_arrives), ENTRY(not_finite_is_dropped_and_counted_and_the_value_before_it_stays),
    ENTRY(not_finite_does_not_count_as_fresh), ENTRY(values_handed_over_together_arrive_together),
    ENTRY(a_dropped_last_value_publishes_those_before_it), ENTRY(a_setpoint_that_does_not_exist_is_refused),
    ENTRY(rate_limit_both_ways_from_the_initial_value), ENTRY(rate_limit_does_not_catch_up_after_missed_cycles),
    ENTRY(rate_limit_of_the_largest_change), ENTRY(hold_keeps_the_value_and_counts_once),
    ENTRY(zero_comes_after_the_timeout_and_ends_with_a_fresh_one), ENTRY(zero_obeys_the_rate_limit),
    ENTRY(disable_latches), ENTRY(enabling_does_not_revive_a_command_whose_sender_has_gone),
    ENTRY(enabling_takes_the_value_of_a_sender_that_is_back), ENTRY(an_old_setpoint_is_no_fault_while_disabled),
    ENTRY(timeouts_start_again_when_enabled), ENTRY(a_sample_younger_than_the_cycle_is_fresh),
    ENTRY(equal_values_are_fresh_ones), ENTRY(one_setpoint_going_on_does_not_keep_another_fresh),
    ENTRY(the_count_of_samples_may_wrap), ENTRY(whoever_wants_to_know_is_told_of_each_arrival))
