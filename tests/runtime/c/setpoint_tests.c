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
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    for (int i = 0; i < 50; i++) {
        fake_cycle();
        CHECK(fake_status().enabled); /* the initial value has no age */
        CHECK_EQUAL(value(0), 0.5);
    }
    fake_receive(0, 6.0);
    fake_cycles(20);
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake_status().statistics.faults, 2);
}

TEST(enabling_after_a_timeout_begins_with_initial_without_a_rate_limit)
{
    begin((epg_setpoint_t){
        .initial = 0.0, .rate_limit = 1000.0, .timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    fake_receive(0, 3.0);
    fake_cycles(200);
    CHECK(!fake_status().enabled);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    for (int i = 0; i < 10; i++) {
        fake_cycle();
        CHECK(fake_status().enabled);
        CHECK_EQUAL(value(0), 0.0);
    }
}

TEST(enabling_in_the_cycle_of_a_timeout_begins_with_initial)
{
    begin((epg_setpoint_t){.initial = 0.5, .timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    fake_cycle();
    fake_receive(0, 5.0); /* at 0 ms; its age is more than the timeout from 11 ms on */
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(10);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK_EQUAL(value(0), 0.5);
}

TEST(enabling_takes_the_value_of_a_sender_that_is_back)
{
    begin((epg_setpoint_t){.initial = 0.5, .timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    fake_receive(0, 5.0);
    fake_cycles(20);
    fake_receive(0, 6.0);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK_EQUAL(value(0), 6.0);
}

TEST(an_old_setpoint_is_no_fault_while_disabled)
{
    begin((epg_setpoint_t){.timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    fake_receive(0, 5.0);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(50);
    CHECK(fake_status().fault == EPG_FAULT_NONE);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK_EQUAL(value(0), 0.0);
}

TEST(enabling_does_not_make_a_value_younger)
{
    begin((epg_setpoint_t){.timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    fake_receive(0, 5.0);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(8);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycles(3); /* up to 10 ms */
    CHECK(fake_status().enabled);
    CHECK_EQUAL(value(0), 5.0); /* it had not timed out when the target was enabled */
    fake_cycle();
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake_status().statistics.setpoint_timeouts, 1);
}

/** Stops the target, and enables it in the first possible cycle. */
static void enable_again(void)
{
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(2);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycle();
    CHECK(fake_status().enabled);
}

/** A velocity, as the generator describes it by default; `timeout_ns` 0: without a timeout. */
static epg_setpoint_t velocity(uint64_t timeout_ns)
{
    return (epg_setpoint_t){.fresh = true, .initial = 0.25, .timeout_ns = timeout_ns, .action = EPG_TIMEOUT_ZERO};
}

TEST(a_fresh_setpoint_that_arrived_long_before_the_enabling_does_nothing)
{
    begin(velocity(0));
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycle();
    fake_receive(0, 0.8);
    fake_cycles(7000);
    CHECK_EQUAL(value(0), 0.8); /* while disabled, users see it on its way */
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    for (int i = 0; i < 1000; i++) {
        fake_cycle();
        CHECK_EQUAL(value(0), 0.25);
    }
    fake_receive(0, 0.8);
    fake_cycle();
    CHECK_EQUAL(value(0), 0.8);
}

TEST(a_fresh_setpoint_does_not_act_twice_over_a_short_disable)
{
    begin(velocity(TIMEOUT_NS));
    fake_receive(0, 0.8);
    fake_cycles(9);
    CHECK_EQUAL(value(0), 0.8);
    enable_again();
    for (int i = 0; i < 30; i++) {
        CHECK_EQUAL(value(0), 0.25);
        fake_cycle();
    }
    CHECK_EQUAL(fake_status().statistics.setpoint_timeouts, 0);
}

TEST(a_fresh_setpoint_on_its_way_at_the_enabling_does_not_act)
{
    begin(velocity(0));
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(2); /* the next cycle begins at 2 ms */
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    const uint64_t before_ns = 2 * FAKE_PERIOD_NS - 1;
    epg_control_receive(&fake.control, 0, 0.8, before_ns, true); /* taken by the cycle that enables */
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK_EQUAL(value(0), 0.25);
    epg_control_receive(&fake.control, 0, 0.8, before_ns, true); /* taken by the next one */
    fake_cycle();
    CHECK_EQUAL(value(0), 0.25);
    epg_control_receive(&fake.control, 0, 0.8, 2 * FAKE_PERIOD_NS, true); /* received when that cycle had begun */
    fake_cycle();
    CHECK_EQUAL(value(0), 0.8);
}

TEST(a_fresh_setpoint_of_the_instant_of_the_enabling_acts)
{
    begin((epg_setpoint_t){.fresh = true, .rate_limit = 100.0}); /* 0.1 per cycle */
    fake_receive(0, 0.8);
    fake_cycles(20);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(2);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    epg_control_receive(&fake.control, 0, -0.8, 22 * FAKE_PERIOD_NS, true);
    fake_cycle(); /* at 22 ms */
    CHECK(fake_status().enabled);
    CHECK_EQUAL(value(0), -0.1); /* the rate limit begins at the initial value */
}

TEST(the_rate_limit_of_a_fresh_setpoint_begins_at_initial)
{
    begin((epg_setpoint_t){.fresh = true, .initial = 0.25, .rate_limit = 1000.0});
    fake_receive(0, 100.25);
    fake_cycles(50);
    CHECK_EQUAL(value(0), 50.25);
    enable_again();
    CHECK_EQUAL(value(0), 0.25);
    fake_cycles(50);
    CHECK_EQUAL(value(0), 0.25);
    fake_receive(0, 100.25);
    fake_cycle();
    CHECK_EQUAL(value(0), 1.25);
}

TEST(a_sender_that_dies_leaves_zero_after_the_timeout)
{
    begin(velocity(TIMEOUT_NS));
    for (int i = 0; i < 100; i++) {
        fake_receive(0, 0.8);
        fake_cycle();
    }
    CHECK_EQUAL(value(0), 0.8); /* the last value was received at 98 ms, and this was the cycle at 99 ms */
    fake_cycles(9);
    CHECK_EQUAL(value(0), 0.8);
    fake_cycle();
    CHECK_EQUAL(value(0), 0.0);
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake_status().statistics.setpoint_timeouts, 1);
    enable_again(); /* the age does not start again */
    fake_cycles(100);
    CHECK_EQUAL(value(0), 0.25);
    CHECK_EQUAL(fake_status().statistics.setpoint_timeouts, 1);
}

TEST(a_position_keeps_its_last_value_over_an_enabling)
{
    begin((epg_setpoint_t){.initial = 0.25});
    fake_receive(0, 0.8);
    fake_cycle();
    enable_again();
    CHECK_EQUAL(value(0), 0.8);
}

static double measured(void)
{
    return fake.sampled * 2.0; /* the setpoint counts in halves of what the sensor counts in */
}

TEST(a_setpoint_that_follows_begins_at_the_measured_value)
{
    fake_reset();
    fake.setpoints[0] = (epg_setpoint_t){.fresh = true, .measured = measured, .rate_limit = 1000.0, .initial = 7.0};
    fake.sensor = 1.5;
    fake_start();
    fake_cycle();
    CHECK_EQUAL(value(0), 3.0); /* the first cycle is enabled: as any other enabling */
    fake.sensor = 2.5;
    fake_receive(0, 9.0);
    fake_cycle();
    CHECK_EQUAL(value(0), 4.0);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_receive(0, 20.0);
    fake_cycles(3);
    fake.sensor = -4.0;
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycle();
    CHECK_EQUAL(value(0), -8.0);
    fake.sensor = 5.0;
    fake_cycles(10);
    CHECK_EQUAL(value(0), -8.0); /* it follows at the enabling only */
    fake_receive(0, -6.5);
    fake_cycle();
    CHECK_EQUAL(value(0), -7.0);
    fake_cycle();
    CHECK_EQUAL(value(0), -6.5);
}

TEST(values_outside_of_the_limits_are_dropped_and_counted)
{
    begin((epg_setpoint_t){.minimum = -1.2, .maximum = 1.2});
    CHECK(fake_receive(0, 1.2));
    fake_cycle();
    CHECK_EQUAL(value(0), 1.2);
    CHECK(!fake_receive(0, nextafter(1.2, 2.0)));
    CHECK(!fake_receive(0, -1e9));
    CHECK(!fake_receive(0, NAN));
    fake_cycle();
    CHECK_EQUAL(value(0), 1.2);
    CHECK(fake_receive(0, -1.2));
    CHECK(fake_receive(1, 1e9)); /* without limits */
    fake_cycle();
    CHECK_EQUAL(value(0), -1.2);
    CHECK_EQUAL(value(1), 1e9);
    CHECK_EQUAL(fake_status().statistics.setpoints_dropped, 3);
    CHECK_EQUAL(fake.control.refused, 1);
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

RUN()
