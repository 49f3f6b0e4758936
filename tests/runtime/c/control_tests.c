/**
 * @file
 * The control cycle: its order, its counters, and each row of the table in epg/control.h.
 */
#include <math.h>

#include "check.h"
#include "epg/finite.h"
#include "fake_application.h"
#include "fake_port.h"

static void begin(void)
{
    fake_reset();
    fake_start();
}

static bool safe_level(void)
{
    return true;
}

static bool fail_safe_input(void)
{
    return fake.fail_safe;
}

static void request(bool enable)
{
    if (enable) {
        epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    } else {
        epg_stop(&fake.control, EPG_STOP_PROGRAM);
    }
}

/** The target is disabled with this fault, and stays so after the cause has gone, until it is enabled again. */
static void check_latched(epg_fault_t fault)
{
    CHECK_EQUAL(fake.actuator, 0.0);
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == fault);
    CHECK_EQUAL(fake_status().statistics.faults, 1);
    fake.sensor = 0.0;
    fake.state_error = 0.0;
    fake.output_error = 0.0;
    fake.stop = false;
    fake.fail_safe = true;
    fake.step_ns = 0;
    fake_cycles(100);
    CHECK_EQUAL(fake.actuator, 0.0);
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == fault);
    CHECK_EQUAL(fake_status().statistics.faults, 1);

    request(false);
    fake_cycles(2);
    CHECK(fake_status().fault == fault);

    const unsigned int inits = fake.inits;
    request(true);
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_NONE);
    CHECK_EQUAL(fake.inits, inits + 1);
    CHECK_EQUAL(fake.state, 1.0);
    CHECK_EQUAL(fake.actuator, 1.0);
}

/* Order and start ---------------------------------------------------------------------------------------------- */

TEST(start_makes_peripherals_safe_and_runs_nothing)
{
    begin();
    CHECK(strcmp(fake.calls, "ps") == 0);
    epg_status_t status;
    double value;
    CHECK(!epg_control_status(&fake.control, &status));
    CHECK(!epg_control_monitor(&fake.control, &value));
}

TEST(nothing_is_read_or_taken_before_start)
{
    fake_reset();
    epg_status_t status;
    double value;
    CHECK(!epg_control_status(&fake.control, &status));
    CHECK(!epg_control_monitor(&fake.control, &value));
    CHECK(!epg_control_receive(&fake.control, 0, 1.0, 0, true));
}

TEST(first_cycle_initialises_with_its_own_inputs)
{
    begin();
    fake.sensor = 10.0;
    fake_cycle();
    CHECK(strcmp(fake.calls, "xrimwo") == 0);
    CHECK_EQUAL(fake.actuator, 11.0);
}

TEST(a_cycle_reads_steps_writes_and_publishes_in_this_order)
{
    begin();
    fake_cycles(2);
    CHECK(strcmp(fake.calls, "xrmwo") == 0);
    CHECK_EQUAL(fake.actuator, 2.0);
    CHECK_EQUAL(fake_published(), 2.0);
}

TEST(a_setpoint_reaches_the_actuator_in_the_next_cycle)
{
    begin();
    fake_cycle();
    CHECK(fake_receive(0, 100.0));
    fake_cycle();
    CHECK_EQUAL(fake.actuator, 102.0);
}

TEST(start_again_starts_afresh)
{
    begin();
    fake_receive(0, 7.0);
    request(false);
    fake_cycles(3);
    fake_start();
    epg_status_t status;
    double value;
    CHECK(!epg_control_status(&fake.control, &status));
    CHECK(!epg_control_monitor(&fake.control, &value));
    CHECK_EQUAL(fake.application.monitor_values[0], 0.0);
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake.input, 0.0);
    CHECK_EQUAL(fake.state, 1.0);
    CHECK_EQUAL(fake_status().statistics.cycles, 1);
}

TEST(model_runs_every_nth_cycle_sensors_every_cycle)
{
    fake_reset();
    fake.application.step_divider = 5;
    fake_start();
    fake_cycles(5);
    CHECK_EQUAL(fake.steps, 1);
    CHECK_EQUAL(fake.reads, 5);
    CHECK_EQUAL(fake.writes, 1);
    CHECK_EQUAL(fake.actuator, 1.0);
    fake_cycle();
    CHECK_EQUAL(fake.steps, 2);
    CHECK_EQUAL(fake.actuator, 2.0);
    fake_cycles(44);
    CHECK_EQUAL(fake.steps, 10);
}

TEST(enabling_runs_the_model_at_once_whatever_its_turn)
{
    fake_reset();
    fake.application.step_divider = 5;
    fake_start();
    fake_cycles(2);
    request(false);
    fake_cycles(2);
    request(true);
    fake_cycle();
    CHECK(strcmp(fake.calls, "xrimwo") == 0);
    fake_cycles(4);
    CHECK_EQUAL(fake.state, 1.0);
    fake_cycle();
    CHECK_EQUAL(fake.state, 2.0);
}

TEST(a_fault_between_steps_is_safe_at_once)
{
    fake_reset();
    fake.application.step_divider = 5;
    fake_start();
    fake_cycles(2);
    CHECK_EQUAL(fake.actuator, 1.0);
    fake.sensor = NAN;
    fake_cycle();
    CHECK_EQUAL(fake.actuator, 0.0);
}

/* Enabled and disabled ----------------------------------------------------------------------------------------- */

TEST(disabled_is_safe_within_one_cycle_while_the_model_runs_on)
{
    begin();
    fake_cycles(3);
    request(false);
    fake_cycle();
    CHECK(strcmp(fake.calls, "xrmso") == 0);
    CHECK_EQUAL(fake.actuator, 0.0);
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_NONE);
    CHECK_EQUAL(fake_status().statistics.faults, 0);
    CHECK_EQUAL(fake_published(), 4.0);
    fake.sensor = 50.0;
    fake_cycle();
    CHECK_EQUAL(fake_published(), 55.0);
    CHECK_EQUAL(fake.safes, 3); /* including the one at the start */
    CHECK_EQUAL(fake.writes, 3);
}

TEST(enabled_again_initialises_the_model)
{
    begin();
    fake_cycles(3);
    request(false);
    fake_cycles(3);
    CHECK_EQUAL(fake.inits, 1);
    request(true);
    fake_cycle();
    CHECK(strcmp(fake.calls, "xrimwo") == 0);
    CHECK_EQUAL(fake.inits, 2);
    CHECK_EQUAL(fake.actuator, 1.0);
    CHECK(fake_status().enabled);
}

TEST(a_request_to_enable_what_is_enabled_does_nothing)
{
    begin();
    fake_cycles(3);
    request(true);
    fake_cycle();
    CHECK_EQUAL(fake.inits, 1);
    CHECK_EQUAL(fake.actuator, 4.0);
}

TEST(a_stop_and_an_enable_at_once_give_disabled_cycles_and_a_new_start)
{
    begin();
    fake_cycle();
    request(false);
    request(true);
    fake_cycle();
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake.actuator, 0.0);
    fake_cycle();
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake.actuator, 0.0);
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake.inits, 2);
    request(true);
    request(false);
    fake_cycles(10);
    CHECK(!fake_status().enabled);
}

TEST(a_request_acts_once)
{
    begin();
    request(true);
    fake_cycle();
    fake.sensor = INFINITY;
    fake_cycle();
    fake.sensor = 0.0;
    fake_cycles(10);
    CHECK(!fake_status().enabled);
}

TEST(not_enabled_at_start_stays_safe_and_live)
{
    fake_reset();
    fake.application.enable_at_start = false;
    fake_start();
    fake_cycles(5);
    CHECK_EQUAL(fake.writes, 0);
    CHECK_EQUAL(fake.actuator, 0.0);
    CHECK_EQUAL(fake_published(), 5.0);
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_NONE);
    request(true);
    fake_cycle();
    CHECK_EQUAL(fake.actuator, 1.0);
}

/* Faults ------------------------------------------------------------------------------------------------------- */

TEST(input_not_a_number)
{
    begin();
    fake_cycles(3);
    fake.sensor = NAN;
    fake_cycle();
    CHECK_EQUAL(fake.steps, 3); /* the model never got this value */
    check_latched(EPG_FAULT_NOT_FINITE);
}

TEST(input_infinite)
{
    begin();
    fake_cycles(3);
    fake.sensor = -INFINITY;
    fake_cycle();
    CHECK_EQUAL(fake.steps, 3);
    check_latched(EPG_FAULT_NOT_FINITE);
}

TEST(input_not_finite_in_the_first_cycle)
{
    begin();
    fake.sensor = NAN;
    fake_cycle();
    CHECK_EQUAL(fake.inits, 0);
    double value;
    CHECK(!epg_control_monitor(&fake.control, &value));
    check_latched(EPG_FAULT_NOT_FINITE);
}

TEST(output_not_finite_never_reaches_an_actuator)
{
    begin();
    fake_cycles(3);
    fake.output_error = NAN;
    fake_cycle();
    CHECK_EQUAL(fake.writes, 3);
    check_latched(EPG_FAULT_NOT_FINITE);
}

TEST(state_not_finite_though_the_output_is)
{
    begin();
    fake_cycles(3);
    fake.limit = 100.0;
    fake.state_error = INFINITY;
    fake_cycle();
    CHECK_EQUAL(fake.output, 100.0);
    check_latched(EPG_FAULT_NOT_FINITE);
}

TEST(after_not_finite_the_model_rests_and_its_last_finite_values_stay)
{
    begin();
    fake_cycles(3);
    fake.output_error = NAN;
    fake_cycle();
    CHECK_EQUAL(fake_published(), 3.0);
    fake.output_error = 0.0;
    fake_cycles(10);
    CHECK_EQUAL(fake.steps, 4);
    CHECK_EQUAL(fake.reads, 14);
    CHECK_EQUAL(fake_published(), 3.0);
}

TEST(nothing_is_published_when_the_first_step_is_not_finite)
{
    begin();
    fake.output_error = INFINITY;
    fake_cycle();
    double value;
    CHECK(!epg_control_monitor(&fake.control, &value));
    CHECK_EQUAL(fake.writes, 0);
}

TEST(not_finite_while_disabled_is_latched_too)
{
    begin();
    request(false);
    fake_cycle();
    fake.output_error = NAN;
    fake_cycle();
    check_latched(EPG_FAULT_NOT_FINITE);
}

TEST(enabling_while_the_input_is_not_finite_fails_and_the_model_rests)
{
    begin();
    fake_cycle();
    fake.sensor = NAN;
    fake_cycles(2);
    request(true);
    fake_cycle();
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_NOT_FINITE);
    CHECK_EQUAL(fake_status().statistics.faults, 2);
    fake.sensor = 0.0;
    fake_cycles(5);
    CHECK_EQUAL(fake.inits, 1);
    CHECK_EQUAL(fake.steps, 1);
}

TEST(model_asks_to_stop)
{
    begin();
    fake_cycles(3);
    fake.stop = true;
    fake_cycle();
    CHECK_EQUAL(fake.writes, 3);
    CHECK_EQUAL(fake_published(), 4.0);
    fake_cycles(3);
    CHECK_EQUAL(fake.steps, 4);
    check_latched(EPG_FAULT_MODEL_STOPPED);
}

TEST(a_model_that_never_stops_needs_no_function_for_it)
{
    fake_reset();
    fake.application.model_stopped = NULL;
    fake_start();
    fake_cycles(3);
    CHECK_EQUAL(fake.actuator, 3.0);
}

static void begin_with_output_delay(uint64_t step_ns)
{
    fake_reset();
    fake.application.output_delay_ns = FAKE_PERIOD_NS / 2;
    fake_start();
    fake.step_ns = step_ns;
    fake_cycle();
}

TEST(outputs_are_written_at_the_output_delay_whatever_computing_takes)
{
    for (uint64_t step_ns = 0; step_ns < FAKE_PERIOD_NS / 2; step_ns += FAKE_PERIOD_NS / 16) {
        begin_with_output_delay(step_ns);
        CHECK_EQUAL(fake.actuator, 1.0);
        CHECK_EQUAL(fake.written_ns, FAKE_PERIOD_NS / 2);
        CHECK_EQUAL(fake_status().statistics.computation_max, step_ns);
        CHECK_EQUAL(fake_status().statistics.outputs_late, 0);
    }
}

static uint64_t prepared_ns;

static void prepare_outputs(void)
{
    prepared_ns = fake_port.now_ns;
    fake_port.now_ns += FAKE_PERIOD_NS / 8; /* arithmetic takes time */
}

TEST(outputs_are_prepared_before_the_output_delay)
{
    begin_with_output_delay(0);
    fake.application.prepare = prepare_outputs;
    fake_cycle();
    CHECK_EQUAL(prepared_ns, FAKE_PERIOD_NS);
    CHECK_EQUAL(fake.written_ns, FAKE_PERIOD_NS + FAKE_PERIOD_NS / 2);
    CHECK_EQUAL(fake_status().statistics.computation_max, FAKE_PERIOD_NS / 8);
    request(false);
    prepared_ns = 0;
    fake_cycle();
    CHECK_EQUAL(prepared_ns, 0); /* safe outputs are not values of the model */
}

TEST(outputs_that_are_not_ready_at_the_output_delay_follow_at_once_and_are_counted)
{
    begin_with_output_delay(FAKE_PERIOD_NS / 2 + 1);
    CHECK_EQUAL(fake.actuator, 1.0);
    CHECK_EQUAL(fake.written_ns, FAKE_PERIOD_NS / 2 + 1);
    CHECK_EQUAL(fake_status().statistics.outputs_late, 1);
    CHECK_EQUAL(fake_status().statistics.overruns, 0);
}

TEST(safe_outputs_do_not_wait_for_the_output_delay)
{
    begin_with_output_delay(0);
    request(false);
    fake_cycle();
    CHECK_EQUAL(fake_port.now_ns, FAKE_PERIOD_NS);
}

TEST(overruns_in_a_row)
{
    fake_reset();
    fake.application.overrun_limit = 3;
    fake_start();
    fake.step_ns = FAKE_PERIOD_NS + 1;
    fake_cycles(2);
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake.actuator, 2.0);
    fake_cycle();
    CHECK_EQUAL(fake_status().statistics.overruns, 3);
    check_latched(EPG_FAULT_OVERRUN);
}

TEST(overruns_with_a_good_cycle_between_do_not_disable)
{
    fake_reset();
    fake.application.overrun_limit = 3;
    fake_start();
    for (int i = 0; i < 10; i++) {
        fake.step_ns = FAKE_PERIOD_NS + 1;
        fake_cycles(2);
        fake.step_ns = 0;
        fake_cycle();
    }
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake_status().statistics.overruns, 20);
}

TEST(overruns_without_a_limit_are_only_counted)
{
    begin();
    fake.step_ns = 2 * FAKE_PERIOD_NS;
    fake_cycles(100);
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake_status().statistics.overruns, 100);
}

TEST(enabling_forgets_the_overruns_before)
{
    fake_reset();
    fake.application.overrun_limit = 3;
    fake_start();
    fake.step_ns = 2 * FAKE_PERIOD_NS;
    fake_cycles(5);
    CHECK(!fake_status().enabled);
    request(true);
    fake_cycles(2);
    CHECK(fake_status().enabled);
    fake_cycle();
    CHECK(fake_status().fault == EPG_FAULT_OVERRUN);
}

TEST(fail_safe_input_falls)
{
    fake_reset();
    fake.application.fail_safe = fail_safe_input;
    fake_start();
    fake_cycles(3);
    CHECK_EQUAL(fake.actuator, 3.0);
    fake.fail_safe = false;
    fake_cycle();
    CHECK_EQUAL(fake.writes, 3);
    check_latched(EPG_FAULT_FAIL_SAFE);
}

TEST(fail_safe_input_at_start)
{
    fake_reset();
    fake.application.fail_safe = fail_safe_input;
    fake.fail_safe = false;
    fake_start();
    fake_cycle();
    CHECK_EQUAL(fake.writes, 0);
    CHECK_EQUAL(fake_published(), 1.0); /* the model keeps running, as after a request to disable */
    check_latched(EPG_FAULT_FAIL_SAFE);
}

TEST(fail_safe_input_refuses_enabling)
{
    fake_reset();
    fake.application.fail_safe = fail_safe_input;
    fake_start();
    fake_cycles(3);
    fake.fail_safe = false;
    fake_cycle();
    request(true);
    fake_cycle();
    CHECK_EQUAL(fake.writes, 3);
    CHECK_EQUAL(fake.inits, 1);
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_FAIL_SAFE);
    fake.fail_safe = true;
    fake_cycles(3);
    CHECK(!fake_status().enabled); /* the refused request is not kept */
}

TEST(an_active_fail_safe_input_changes_nothing)
{
    fake_reset();
    fake.application.fail_safe = safe_level;
    fake_start();
    fake_cycles(3);
    CHECK_EQUAL(fake.actuator, 3.0);
}

TEST(the_first_of_several_faults_stays)
{
    fake_reset();
    fake.application.fail_safe = fail_safe_input;
    fake_start();
    fake_cycle();
    fake.stop = true;
    fake_cycle();
    fake.fail_safe = false;
    fake.sensor = NAN;
    fake_cycle();
    CHECK(fake_status().fault == EPG_FAULT_MODEL_STOPPED);
    CHECK_EQUAL(fake_status().statistics.faults, 1);
}

/* Statistics --------------------------------------------------------------------------------------------------- */

TEST(a_late_cycle_runs_once_and_the_missed_ticks_are_counted)
{
    begin();
    fake_cycles(2);
    fake_late_cycle(300, 4);
    CHECK_EQUAL(fake.steps, 3);
    CHECK_EQUAL(fake_status().statistics.cycles, 3);
    CHECK_EQUAL(fake_status().statistics.missed, 4);
    CHECK_EQUAL(fake_status().statistics.overruns, 1);
    CHECK_EQUAL(fake_status().statistics.lateness_max, 300);
    fake_cycle();
    CHECK_EQUAL(fake.steps, 4);
    CHECK_EQUAL(fake_status().statistics.overruns, 1);
}

TEST(ending_at_the_next_tick_is_in_time)
{
    begin();
    fake.step_ns = FAKE_PERIOD_NS;
    fake_cycle();
    CHECK_EQUAL(fake_status().statistics.overruns, 0);
    fake.step_ns = FAKE_PERIOD_NS - 100;
    fake_late_cycle(101, 0);
    CHECK_EQUAL(fake_status().statistics.overruns, 1);
}

TEST(computation_times)
{
    begin();
    fake.step_ns = 300;
    fake_cycle();
    fake.step_ns = 100;
    fake_late_cycle(50, 0);
    fake.step_ns = 0;
    fake_late_cycle(20, 0);
    fake.step_ns = 200;
    fake_cycle();
    const epg_statistics_t statistics = fake_status().statistics;
    CHECK_EQUAL(statistics.computation_min, 0);
    CHECK_EQUAL(statistics.computation_max, 300);
    CHECK_EQUAL(statistics.computation_total, 600);
    CHECK_EQUAL(statistics.lateness_max, 50);
}

TEST(shortest_cycle_is_not_the_zero_it_starts_with)
{
    begin();
    fake_cycle();
    CHECK_EQUAL(fake_status().statistics.computation_min, 0);
    begin();
    fake.step_ns = 7;
    fake_cycle();
    CHECK_EQUAL(fake_status().statistics.computation_min, 7);
}

TEST(times_saturate)
{
    begin();
    fake.step_ns = 5000000000U;
    fake_late_cycle(6000000000U, 0);
    CHECK_EQUAL(fake_status().statistics.lateness_max, UINT32_MAX);
    CHECK_EQUAL(fake_status().statistics.computation_max, UINT32_MAX);
}

TEST(a_cycle_before_its_tick_is_not_late)
{
    begin();
    fake_port.now_ns = 900;
    epg_control_cycle(&fake.control, 1000, 0);
    CHECK_EQUAL(fake_status().statistics.lateness_max, 0);
    CHECK_EQUAL(fake_status().time_ns, 1000);
}

TEST(counts_of_others)
{
    begin();
    epg_control_count_clamped(&fake.control);
    epg_control_count_clamped(&fake.control);
    epg_control_count_reconnect(&fake.control);
    fake_cycle();
    CHECK_EQUAL(fake_status().statistics.clamped, 2);
    CHECK_EQUAL(fake_status().statistics.reconnects, 1);
}

TEST(reconnecting_clears_no_latch)
{
    begin();
    fake_cycle();
    fake.stop = true;
    fake_cycle();
    fake.stop = false;
    epg_control_count_reconnect(&fake.control);
    fake_receive(0, 1.0);
    fake_cycles(3);
    CHECK(fake_status().fault == EPG_FAULT_MODEL_STOPPED);
}

TEST(finite_by_bits)
{
    CHECK(epg_is_finite(0.0));
    CHECK(epg_is_finite(-0.0));
    CHECK(epg_is_finite(4.9406564584124654e-324));
    CHECK(epg_is_finite(-1.7976931348623157e308));
    CHECK(!epg_is_finite(INFINITY));
    CHECK(!epg_is_finite(-INFINITY));
    CHECK(!epg_is_finite(NAN));
    CHECK(!epg_is_finite(-NAN));
}

RUN()
