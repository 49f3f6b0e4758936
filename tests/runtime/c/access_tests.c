/**
 * @file
 * Access of the user's program to setpoints, values and parameters, beside the communication side.
 */
#include "epg/access.h"

#include <math.h>

#include "check.h"
#include "fake_application.h"
#include "fake_port.h"

enum { TIMEOUT_NS = 10 * FAKE_PERIOD_NS, COUNT = 3 };

/* Setpoints */

static epg_setpoint_sample_t setpoint_buffers[4][FAKE_SETPOINTS];
static epg_setpoint_sample_t setpoints_given[FAKE_SETPOINTS];
static epg_setpoint_sample_t setpoints_taken[FAKE_SETPOINTS];
static uint32_t setpoint_counts[FAKE_SETPOINTS];
static atomic_uint setpoint_arrivals[FAKE_SETPOINTS];
static unsigned int setpoints_informed[FAKE_SETPOINTS];
static epg_setpoint_access_t setpoints = {
    .count = FAKE_SETPOINTS,
    .exchange = EPG_EXCHANGE(setpoint_buffers),
    .given = setpoints_given,
    .taken = setpoints_taken,
    .counts = setpoint_counts,
    .arrivals = setpoint_arrivals,
    .informed = setpoints_informed,
};
static unsigned int arrivals[FAKE_SETPOINTS];

static void arrived(size_t index)
{
    arrivals[index]++;
}

static bool set(size_t index, double value)
{
    return epg_access_set(&setpoints, &fake.control, index, value);
}

static double value(size_t index)
{
    return epg_control_setpoint(&fake.control, index);
}

static void begin(epg_setpoint_t setpoint)
{
    fake_reset();
    fake.setpoints[0] = setpoint;
    fake.application.arrived = arrived;
    fake_start();
}

TEST(nothing_is_set_before_the_first_start)
{
    fake_reset();
    CHECK(!set(0, 1.0));
    fake_start();
    fake_cycle();
    CHECK_EQUAL(value(0), 0.0);
}

TEST(a_value_acts_in_the_next_cycle_and_the_newest_counts)
{
    begin((epg_setpoint_t){.initial = 0.5});
    fake_cycle();
    CHECK(set(0, 1.0));
    CHECK(set(0, 2.0));
    CHECK(set(1, 3.0));
    CHECK_EQUAL(value(0), 0.5);
    fake_cycle();
    CHECK_EQUAL(value(0), 2.0);
    CHECK_EQUAL(value(1), 3.0);
}

TEST(values_that_are_not_finite_are_dropped_and_counted_with_those_of_messages)
{
    begin((epg_setpoint_t){0});
    CHECK(set(0, 1.0));
    CHECK(!set(0, NAN));
    CHECK(!set(0, -INFINITY));
    CHECK(!fake_receive(0, INFINITY));
    fake_cycle();
    CHECK_EQUAL(value(0), 1.0);
    CHECK_EQUAL(fake_status().statistics.setpoints_dropped, 3);
    fake_cycle();
    CHECK_EQUAL(fake_status().statistics.setpoints_dropped, 3);
}

TEST(a_value_has_an_age_and_a_rate_limit)
{
    begin((epg_setpoint_t){.rate_limit = 1000.0, .timeout_ns = TIMEOUT_NS, .action = EPG_TIMEOUT_DISABLE});
    fake_cycles(20); /* the initial value has no age */
    CHECK(fake_status().enabled);
    CHECK(set(0, 3.0));
    fake_cycle();
    CHECK_EQUAL(value(0), 1.0);
    fake_cycle();
    CHECK_EQUAL(value(0), 2.0);
    fake_cycles(8);
    CHECK(fake_status().enabled);
    fake_cycles(4);
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake_status().fault, EPG_FAULT_SETPOINT_TIMEOUT);
    CHECK_EQUAL(fake_status().statistics.setpoint_timeouts, 1);
}

TEST(of_a_value_and_a_message_in_one_cycle_the_later_counts)
{
    begin((epg_setpoint_t){0});
    fake_cycle();
    fake_port.now_ns += 10;
    CHECK(fake_receive(0, 1.0));
    fake_port.now_ns += 10;
    CHECK(set(0, 2.0));
    fake_cycle();
    CHECK_EQUAL(value(0), 2.0);
    fake_port.now_ns += 10;
    CHECK(set(0, 3.0));
    fake_port.now_ns += 10;
    CHECK(fake_receive(0, 4.0));
    fake_cycle();
    CHECK_EQUAL(value(0), 4.0);
    fake_cycles(3);
    CHECK_EQUAL(value(0), 4.0);
}

TEST(messages_for_another_setpoint_leave_a_value_as_it_is)
{
    begin((epg_setpoint_t){0});
    CHECK(set(0, 2.0));
    fake_cycle();
    CHECK(fake_receive(1, 5.0));
    fake_cycle();
    CHECK_EQUAL(value(0), 2.0);
    CHECK(fake_receive(0, 6.0));
    fake_cycle();
    CHECK(set(1, 7.0));
    fake_cycle();
    CHECK_EQUAL(value(0), 6.0);
    CHECK_EQUAL(value(1), 7.0);
}

TEST(components_learn_of_a_value_on_the_communication_side)
{
    begin((epg_setpoint_t){0});
    CHECK(set(1, 1.0));
    CHECK_EQUAL(arrivals[1], 0);
    epg_control_alive(&fake.control);
    CHECK_EQUAL(arrivals[1], 1);
    CHECK(!set(0, NAN)); /* as epg_control_receive() does */
    epg_control_alive(&fake.control);
    epg_control_alive(&fake.control);
    CHECK_EQUAL(arrivals[0], 1);
    CHECK_EQUAL(arrivals[1], 1);
}

TEST(a_start_forgets_values_that_were_set_before_it)
{
    begin((epg_setpoint_t){.initial = 0.5});
    CHECK(set(0, 1.0));
    CHECK(!set(0, NAN));
    fake_start();
    fake_cycle();
    CHECK_EQUAL(value(0), 0.5);
    CHECK_EQUAL(fake_status().statistics.setpoints_dropped, 0);
    CHECK(set(1, 2.0));
    fake_cycle();
    CHECK_EQUAL(value(0), 0.5);
    CHECK_EQUAL(value(1), 2.0);
}

/* Values */

typedef struct fake_values {
    uint64_t time_ns;
    double input;
    double output;
} fake_values_t;

static unsigned int collections;

static void collect(void *destination, uint64_t time_ns)
{
    collections++;
    *(fake_values_t *)destination = (fake_values_t){time_ns, fake.input, fake.output};
}

static fake_values_t value_buffers[4];
static fake_values_t values_given;
static fake_values_t values_taken;
static epg_value_access_t values = {
    .exchange = EPG_EXCHANGE(value_buffers),
    .collect = collect,
    .given = &values_given,
    .taken = &values_taken,
};

static bool get(void)
{
    return epg_access_values(&values, &fake.control);
}

TEST(values_are_those_of_the_newest_step)
{
    fake_reset();
    CHECK(!get());
    fake_start();
    CHECK(!get());
    fake.sensor = 1.0;
    fake_cycle();
    CHECK(get());
    CHECK_EQUAL(values_taken.time_ns, 0);
    CHECK_EQUAL(values_taken.input, 1.0);
    CHECK_EQUAL(values_taken.output, 2.0);
    fake.sensor = 2.0;
    fake_cycles(2);
    CHECK(get());
    CHECK(get());
    CHECK_EQUAL(values_taken.time_ns, 2 * FAKE_PERIOD_NS);
    CHECK_EQUAL(values_taken.input, 2.0);
    CHECK_EQUAL(values_taken.output, 5.0);
}

TEST(values_stay_while_the_model_rests)
{
    fake_reset();
    fake_start();
    CHECK(!get());
    fake_cycle();
    fake.output_error = NAN;
    fake_cycles(2);
    CHECK(!fake_status().enabled);
    CHECK(get());
    CHECK_EQUAL(values_taken.output, 1.0);
}

TEST(values_of_a_run_are_gone_after_a_start)
{
    fake_reset();
    fake_start();
    CHECK(!get());
    fake_cycle();
    CHECK(get());
    fake_start();
    CHECK(!get());
    fake_cycle();
    CHECK(get());
}

TEST(a_cycle_does_not_collect_values_that_nobody_gets)
{
    fake_reset();
    fake_start();
    CHECK(set(0, 1.0)); /* another access is used */
    fake_cycles(5);
    CHECK_EQUAL(collections, 0);
}

/* Parameters */

static double model[COUNT];

static void set_model(const double *requested, const bool *which)
{
    for (size_t i = 0; i < COUNT; i++) {
        model[i] = which[i] ? requested[i] : model[i];
    }
}

static const epg_parameter_t table[COUNT] = {{"kp", "", 1.0}, {"ki", "", 2.0}, {"kd", "", 3.0}};
static const epg_parameter_limits_t limits[COUNT] = {{-INFINITY, 5.0}, {0.0, INFINITY}, {-1.0, 9.0}};
static double parameter_values[COUNT];
static bool parameter_wanted[COUNT];
static double parameter_applied[COUNT];
static bool parameter_changed[COUNT];
static uint8_t parameter_news[COUNT];
static uint32_t parameter_acted[COUNT];
static epg_parameters_t parameters;

static epg_parameter_request_t request_buffers[4][COUNT];
static epg_parameter_request_t requests_given[COUNT];
static epg_parameter_request_t requests_taken[COUNT];
static uint32_t request_counts[COUNT];
static bool which_change[COUNT];
static double all_applied[COUNT + 1];
static double program_buffers[4][COUNT + 1];
static double program_values[COUNT + 1];
static double communication_buffers[4][COUNT + 1];
static double communication_values[COUNT + 1];
static epg_parameter_access_t access = {
    .requests = EPG_EXCHANGE(request_buffers),
    .given = requests_given,
    .taken = requests_taken,
    .counts = request_counts,
    .which = which_change,
    .applied = all_applied,
    .program = EPG_EXCHANGE(program_buffers),
    .values = program_values,
    .communication = EPG_EXCHANGE(communication_buffers),
    .informed = communication_values,
};

static void reset_model(void)
{
    for (size_t i = 0; i < COUNT; i++) {
        model[i] = table[i].value;
    }
}

/** Starts a target whose parameters the communication side can change, too, if `shared`. */
static void begin_with_parameters(bool shared)
{
    fake_reset();
    reset_model();
    parameters = (epg_parameters_t){.count = COUNT,
                                    .table = table,
                                    .limits = limits,
                                    .set = set_model,
                                    .applied = parameter_applied,
                                    .changed = parameter_changed};
    access.own = shared ? NULL : &parameters;
    if (shared) {
        memcpy(parameter_values, model, sizeof model);
        parameters.values = parameter_values;
        parameters.wanted = parameter_wanted;
        parameters.news = parameter_news;
        fake.application.parameters = &parameters;
    }
    fake.application.model_init = reset_model;
    fake_start();
}

static bool set_parameter(size_t index, double new_value)
{
    return epg_access_set_parameter(&access, &fake.control, index, new_value);
}

static double parameter(size_t index)
{
    double result = NAN;
    CHECK(epg_access_get_parameter(&access, &fake.control, index, &result));
    return result;
}

static bool communication_changes(size_t index, double new_value)
{
    const epg_parameter_change_t change = {index, new_value};
    return epg_parameters_change(&parameters, &change, 1);
}

/** A stream tells changes of the program and of the communication side alike, with the cycle in which each acted. */
TEST(a_stream_tells_changes_of_the_program)
{
    static epg_capture_t capture;
    static epg_telemetry_t telemetry;
    static double memory[64];
    telemetry = (epg_telemetry_t){0};
    begin_with_parameters(true);
    fake.application.capture = &capture;
    parameters.log.acted = parameter_acted;
    fake.application.telemetry = &telemetry;
    fake_cycles(4);
    epg_telemetry_request_t request = {.columns = 1, .signals = {&fake.control.replay[EPG_REPLAY_CYCLE]}, .every = 1};
    CHECK(epg_telemetry_start(&telemetry, &request, memory, 64));
    fake_cycle();
    CHECK_EQUAL(fake.control.replay[EPG_REPLAY_CYCLE], 5.0);
    CHECK_EQUAL(fake.control.replay[EPG_REPLAY_PARAMETER], 0.0);
    CHECK(set_parameter(0, 4.0));
    CHECK(communication_changes(2, 8.0));
    fake_cycle();
    fake_cycle();
    CHECK_EQUAL(fake.control.replay[EPG_REPLAY_UNTOLD], 0.0);
    CHECK(fake.control.replay[EPG_REPLAY_PARAMETER] == 1.0 || fake.control.replay[EPG_REPLAY_PARAMETER] == 3.0);
    CHECK_EQUAL(fake.control.replay[EPG_REPLAY_VALUE], fake.control.replay[EPG_REPLAY_PARAMETER] == 1.0 ? 4.0 : 8.0);
    CHECK_EQUAL(fake.control.replay[EPG_REPLAY_ACTED], 6.0);
    fake_cycle();
    CHECK_EQUAL(fake.control.replay[EPG_REPLAY_PARAMETER], 0.0);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(2);
    CHECK_EQUAL(fake.control.replay[EPG_REPLAY_CYCLE], 0.0);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycle();
    CHECK_EQUAL(fake.control.replay[EPG_REPLAY_CYCLE], 1.0);
    CHECK_EQUAL(fake.control.replay[EPG_REPLAY_ACTED], 1.0);
    CHECK_EQUAL(fake.control.replay[EPG_REPLAY_UNTOLD], 1.0);
}

TEST(a_parameter_changes_in_the_next_cycle_and_after_every_initialisation)
{
    begin_with_parameters(false);
    double result = 0.0;
    CHECK(!epg_access_get_parameter(&access, &fake.control, 0, &result));
    fake_cycle();
    CHECK_EQUAL(parameter(0), 1.0);
    CHECK(set_parameter(0, 4.0));
    CHECK(set_parameter(2, 8.0));
    CHECK(set_parameter(2, 9.0));
    CHECK_EQUAL(parameter(0), 1.0);
    CHECK_EQUAL(model[0], 1.0);
    fake_cycle();
    CHECK_EQUAL(model[0], 4.0);
    CHECK_EQUAL(model[2], 9.0);
    CHECK_EQUAL(parameter(0), 4.0);
    CHECK_EQUAL(parameter(1), 2.0);
    CHECK_EQUAL(parameter(2), 9.0);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycle();
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycle();
    CHECK_EQUAL(model[0], 4.0);
    CHECK_EQUAL(model[1], 2.0);
    CHECK_EQUAL(model[2], 9.0);
}

TEST(a_value_outside_of_the_limits_is_refused)
{
    begin_with_parameters(false);
    fake_cycle();
    CHECK(!set_parameter(0, 5.1));
    CHECK(!set_parameter(1, -0.1));
    CHECK(!set_parameter(2, NAN));
    CHECK(!set_parameter(COUNT, 1.0));
    CHECK(set_parameter(0, 5.0));
    fake_cycle();
    CHECK_EQUAL(model[0], 5.0);
    CHECK_EQUAL(model[1], 2.0);
    CHECK_EQUAL(model[2], 3.0);
}

TEST(a_change_before_the_first_cycle_is_made_after_the_initialisation)
{
    begin_with_parameters(false);
    CHECK(set_parameter(1, 7.0));
    fake_cycle();
    CHECK_EQUAL(model[1], 7.0);
    CHECK_EQUAL(parameter(1), 7.0);
}

TEST(changes_are_made_again_when_the_program_uses_parameters_after_a_start)
{
    begin_with_parameters(false);
    CHECK(set_parameter(1, 7.0));
    fake_cycle();
    fake_start();
    fake_cycle();
    CHECK_EQUAL(model[1], 2.0);
    CHECK(set_parameter(0, 4.0));
    fake_cycle();
    CHECK_EQUAL(model[0], 4.0);
    CHECK_EQUAL(model[1], 7.0);
    CHECK_EQUAL(parameter(1), 7.0);
}

TEST(program_and_communication_see_each_others_changes)
{
    begin_with_parameters(true);
    fake_cycle();
    CHECK(communication_changes(0, 4.0));
    CHECK(set_parameter(1, 7.0));
    fake_cycle();
    CHECK_EQUAL(model[0], 4.0);
    CHECK_EQUAL(model[1], 7.0);
    CHECK_EQUAL(parameter(0), 4.0);
    CHECK_EQUAL(parameter_values[1], 2.0);
    parameter_news[0] = EPG_PARAMETER_TOLD;
    epg_control_alive(&fake.control);
    CHECK_EQUAL(epg_parameters_value(&parameters, 0), 4.0);
    CHECK_EQUAL(epg_parameters_value(&parameters, 1), 7.0);
    CHECK_EQUAL(parameter_news[0], EPG_PARAMETER_TOLD);
    CHECK_EQUAL(parameter_news[1], EPG_PARAMETER_NEW);
    CHECK_EQUAL(parameter_news[2], EPG_PARAMETER_TOLD);
    CHECK(communication_changes(1, 6.0));
    fake_cycle();
    CHECK_EQUAL(parameter(1), 6.0);
    reset_model();
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(2);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycle();
    CHECK_EQUAL(model[0], 4.0);
    CHECK_EQUAL(model[1], 6.0);
}

TEST(of_a_change_of_the_program_and_one_of_communication_in_one_cycle_that_of_communication_counts)
{
    begin_with_parameters(true);
    fake_cycle();
    CHECK(set_parameter(0, 4.0));
    CHECK(communication_changes(0, 3.0));
    fake_cycle();
    CHECK_EQUAL(model[0], 3.0);
    CHECK_EQUAL(parameter(0), 3.0);
    epg_control_alive(&fake.control);
    CHECK_EQUAL(epg_parameters_value(&parameters, 0), 3.0);
}

TEST(communication_does_not_take_a_result_that_is_older_than_its_request)
{
    begin_with_parameters(true);
    fake_cycle();
    CHECK(set_parameter(0, 4.0));
    fake_cycle(); /* its result waits for the communication side */
    CHECK(communication_changes(0, 3.0));
    epg_control_alive(&fake.control); /* the request is not yet made */
    CHECK_EQUAL(epg_parameters_value(&parameters, 0), 3.0);
    epg_handover_return(&parameters.handover); /* as in the middle of a cycle: made, and the result not yet given */
    epg_control_alive(&fake.control);
    CHECK_EQUAL(epg_parameters_value(&parameters, 0), 3.0);
}

RUN()
