/**
 * @file
 * Faults that components and platforms detect, and the report of the communication side about itself.
 */
#include <limits.h>
#include <math.h>

#include "check.h"
#include "epg/target.h"
#include "fake_application.h"
#include "fake_port.h"

static void begin(void)
{
    fake_reset();
    fake_start();
}

static const epg_fault_t FAULT_OF_KIND = (epg_fault_t)300;

static void check_fault(epg_fault_t fault, unsigned int component)
{
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == fault);
    CHECK_EQUAL(fake_status().fault_component, component);
}

TEST(sensors_are_sampled_before_anything_else)
{
    begin();
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_receive(0, 1.0);
    fake_cycle();
    CHECK(strncmp(fake.calls, "xr", 2) == 0);
    CHECK_EQUAL(fake.input, 1.0); /* although the setpoint was read after that */
}

TEST(fault_of_a_component_is_safe_in_the_same_cycle)
{
    begin();
    fake_cycles(3);
    CHECK_EQUAL(fake_status().fault_component, EPG_NO_COMPONENT);
    fake.fault = FAULT_OF_KIND;
    fake_cycle();
    CHECK_EQUAL(fake.writes, 3);
    CHECK_EQUAL(fake.actuator, 0.0);
    check_fault(FAULT_OF_KIND, FAKE_COMPONENT);
    fake.fault = EPG_FAULT_NONE;
    fake_cycles(5);
    check_fault(FAULT_OF_KIND, FAKE_COMPONENT);
    CHECK_EQUAL(fake_status().statistics.faults, 1);
    CHECK_EQUAL(fake.steps, 9); /* the model keeps running, as after a request to disable */
}

TEST(enabling_clears_the_fault_of_a_component)
{
    begin();
    fake.fault = FAULT_OF_KIND;
    fake_cycle();
    fake.fault = EPG_FAULT_NONE;
    fake_cycle();
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_NONE);
    CHECK_EQUAL(fake_status().fault_component, EPG_NO_COMPONENT);
    CHECK_EQUAL(fake.writes, 1);
    CHECK_EQUAL(fake.inits, 2);
}

TEST(enabling_while_the_fault_lasts_writes_nothing)
{
    begin();
    fake.fault = FAULT_OF_KIND;
    fake_cycle();
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycles(3);
    CHECK_EQUAL(fake.writes, 0);
    check_fault(FAULT_OF_KIND, FAKE_COMPONENT);
}

TEST(the_first_fault_keeps_its_component)
{
    begin();
    fake.fault = FAULT_OF_KIND;
    fake_cycle();
    fake.sensor = INFINITY;
    fake_cycle();
    check_fault(FAULT_OF_KIND, FAKE_COMPONENT);
}

TEST(fault_of_the_target_has_no_component)
{
    begin();
    fake.stop = true;
    fake_cycle();
    check_fault(EPG_FAULT_MODEL_STOPPED, EPG_NO_COMPONENT);
}

static bool never(void)
{
    return false;
}

TEST(fail_safe_input_is_the_component)
{
    fake_reset();
    fake.application.fail_safe = never;
    fake.application.fail_safe_component = 3;
    fake_start();
    fake_cycle();
    check_fault(EPG_FAULT_FAIL_SAFE, 3);
}

TEST(a_platform_that_starts_after_a_watchdog_stays_safe_until_enabled)
{
    begin();
    epg_control_fault(&fake.control, EPG_FAULT_WATCHDOG, EPG_NO_COMPONENT);
    fake_cycles(10);
    CHECK_EQUAL(fake.writes, 0);
    CHECK_EQUAL(fake.steps, 10);
    check_fault(EPG_FAULT_WATCHDOG, EPG_NO_COMPONENT);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake.writes, 1);
}

TEST(components_have_names)
{
    static const char *const names[] = {"encoder", "motor"};
    const epg_target_t target = {.component_count = 2, .components = names};
    CHECK(strcmp(epg_target_component(&target, 0), "encoder") == 0);
    CHECK(strcmp(epg_target_component(&target, 1), "motor") == 0);
    CHECK(strcmp(epg_target_component(&target, 2), "") == 0);
    CHECK(strcmp(epg_target_component(&target, EPG_NO_COMPONENT), "") == 0);
}

TEST(faults_have_names)
{
    static const epg_kind_fault_t faults[] = {{6, "stall"}, {300, "too hot"}};
    const epg_target_t target = {.fault_count = 2, .faults = faults};
    static const char *const names[] = {"none",      "not finite", "model stopped", "overrun", "setpoint timeout",
                                        "fail-safe", "stall",      "unknown",       "unknown", "unknown",
                                        "unknown",   "watchdog",   "processor",     "output",  "tick",
                                        "priority",  "operator",   "unknown"};
    for (unsigned int i = 0; i < sizeof names / sizeof names[0]; i++) {
        CHECK(strcmp(epg_target_fault(&target, (epg_fault_t)i), names[i]) == 0);
    }
    CHECK(strcmp(epg_target_fault(&target, (epg_fault_t)300), "too hot") == 0);
    CHECK(strcmp(epg_target_fault(&target, EPG_FAULT_LARGEST), "unknown") == 0);
}

TEST(silence_counts_from_the_first_sign_of_life)
{
    begin();
    fake_cycles(5);
    CHECK_EQUAL(epg_control_silence(&fake.control), 0);
    for (int i = 0; i < 3; i++) {
        epg_control_alive(&fake.control);
        fake_cycle();
        CHECK_EQUAL(epg_control_silence(&fake.control), 0);
        fake_cycles(4);
        CHECK_EQUAL(epg_control_silence(&fake.control), 4);
    }
    CHECK_EQUAL(fake_status().statistics.silence_max, 4);
    fake_cycles(3);
    CHECK_EQUAL(fake_status().statistics.silence_max, 7);
    epg_control_alive(&fake.control);
    fake_cycle();
    CHECK_EQUAL(epg_control_silence(&fake.control), 0);
    CHECK_EQUAL(fake_status().statistics.silence_max, 7);
}

TEST(signs_of_life_may_wrap)
{
    begin();
    epg_control_alive(&fake.control);
    atomic_store(&fake.control.alive, UINT_MAX);
    fake_cycles(2);
    CHECK_EQUAL(epg_control_silence(&fake.control), 1);
    epg_control_alive(&fake.control);
    fake_cycles(3);
    CHECK_EQUAL(epg_control_silence(&fake.control), 2); /* not 0, which means that it has never been alive */
}

TEST(stacks_are_reported)
{
    begin();
    epg_control_report_stack(&fake.control, EPG_STACK_CONTROL, 700, 2048);
    epg_control_report_stack(&fake.control, EPG_STACK_COMMUNICATION, 1500, 4096);
    epg_control_report_stack(&fake.control, EPG_STACKS, 1, 1); /* there is no such stack */
    epg_control_alive(&fake.control);
    fake_cycle();
    const epg_statistics_t statistics = fake_status().statistics;
    CHECK_EQUAL(statistics.stacks[EPG_STACK_CONTROL].used, 700);
    CHECK_EQUAL(statistics.stacks[EPG_STACK_CONTROL].size, 2048);
    CHECK_EQUAL(statistics.stacks[EPG_STACK_COMMUNICATION].used, 1500);
    CHECK_EQUAL(statistics.stacks[EPG_STACK_COMMUNICATION].size, 4096);
}

RUN()
