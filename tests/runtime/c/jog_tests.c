/**
 * @file
 * One actuator of a disabled target, moved by hand.
 */
#include "epg/jog.h"

#include <math.h>

#include "check.h"
#include "fake_application.h"
#include "fake_port.h"

static int64_t count; /* of the encoder: it moves by ten per cycle of full duty */
static double driven; /* duty of this cycle */
static unsigned int drives;

static void drive(double duty)
{
    driven = duty;
    fake.actuator = duty;
    count += (int64_t)(duty * 10.0);
    drives++;
}

static int64_t read_count(void)
{
    return count;
}

static double read_position(void)
{
    return (double)count * 0.5;
}

static const epg_jog_actuator_t actuators[1] = {{"motor", drive, NULL}};
static const epg_jog_encoder_t encoders[1] = {{"encoder", read_count, read_position, "rad"}};
static epg_jog_reading_t first[1];
static epg_jog_reading_t last[1];
static epg_jog_t jog;

static void begin(bool enabled)
{
    fake_reset();
    count = 7;
    driven = 0.0;
    drives = 0;
    jog = (epg_jog_t){.actuator_count = 1,
                      .actuators = actuators,
                      .encoder_count = 1,
                      .encoders = encoders,
                      .first = first,
                      .last = last};
    fake.application.enable_at_start = enabled;
    fake.application.jog = &jog;
    fake_start();
    fake_cycles(3);
}

/** Requests a movement as the console does. */
static bool start_jog(size_t index, double duty, uint32_t cycles)
{
    (void)epg_gate_poll(&fake.control, EPG_GATE_CONSOLE);
    CHECK(epg_gate_move(&fake.control));
    return epg_jog_start(&jog, index, duty, cycles);
}

TEST(it_drives_for_as_many_cycles_as_asked_and_is_safe_afterwards)
{
    begin(false);
    CHECK(epg_jog_idle(&jog));
    CHECK(start_jog(0, -1.0, 20));
    CHECK(!epg_jog_idle(&jog));
    for (int i = 0; i < 20; i++) {
        fake_cycle();
        CHECK_EQUAL(fake.actuator, -1.0);
        CHECK(strchr(fake.calls, 'm') == NULL); /* the model does not run */
        CHECK(strchr(fake.calls, 's') == NULL); /* the motor is not switched off in between */
    }
    fake_cycle();
    CHECK_EQUAL(fake.actuator, 0.0);
    CHECK(epg_jog_idle(&jog));
    CHECK(jog.end == EPG_JOG_DONE);
    CHECK_EQUAL(drives, 20);
    CHECK_EQUAL(jog.cycles, 20);
    CHECK_EQUAL(last[0].count - first[0].count, -200);
    CHECK_EQUAL(last[0].position - first[0].position, -100.0);
}

TEST(the_model_begins_again_afterwards)
{
    begin(false);
    const unsigned int inits = fake.inits;
    CHECK(start_jog(0, 1.0, 5));
    fake_cycles(5);
    CHECK_EQUAL(fake.inits, inits);
    fake_cycle();
    CHECK_EQUAL(fake.inits, inits + 1);
    CHECK(strchr(fake.calls, 'm') != NULL);
    CHECK_EQUAL(fake.actuator, 0.0); /* the target is still disabled */
}

TEST(a_model_that_rests_after_a_fault_goes_on_resting)
{
    begin(false);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycle();
    fake.output_error = NAN;
    fake_cycle();
    CHECK(fake_status().fault == EPG_FAULT_NOT_FINITE);
    fake.output_error = 0.0;
    fake_cycle();
    const unsigned int steps = fake.steps;
    CHECK(start_jog(0, 1.0, 5));
    fake_cycles(10);
    CHECK(jog.end == EPG_JOG_DONE);
    CHECK_EQUAL(fake.steps, steps);
    CHECK(fake_status().fault == EPG_FAULT_NOT_FINITE);
}

TEST(an_enabled_target_refuses)
{
    begin(true);
    CHECK(start_jog(0, 1.0, 5));
    fake_cycle();
    CHECK(epg_jog_idle(&jog));
    CHECK(jog.end == EPG_JOG_REFUSED);
    CHECK_EQUAL(drives, 0);
    CHECK(fake_status().enabled);
}

TEST(any_request_ends_it_in_the_same_cycle)
{
    for (int enable = 0; enable < 2; enable++) {
        begin(false);
        CHECK(start_jog(0, 1.0, 100));
        fake_cycles(4);
        CHECK_EQUAL(drives, 4);
        if (enable != 0) {
            epg_control_enable(&fake.control, EPG_ENABLE_ANY);
        } else {
            epg_stop(&fake.control, EPG_STOP_PROGRAM);
        }
        fake_cycle();
        CHECK_EQUAL(drives, 4);
        CHECK(jog.end == EPG_JOG_STOPPED);
        CHECK_EQUAL(jog.cycles, 4);
        CHECK(fake_status().enabled == (enable != 0));
        if (enable == 0) {
            CHECK_EQUAL(fake.actuator, 0.0);
        }
    }
}

static bool fail_safe(void)
{
    return fake.fail_safe;
}

TEST(the_fail_safe_input_ends_it_and_refuses_it)
{
    begin(false);
    fake.application.fail_safe = fail_safe;
    CHECK(start_jog(0, 1.0, 100));
    fake_cycles(4);
    fake.fail_safe = false;
    fake_cycle();
    CHECK_EQUAL(fake.actuator, 0.0);
    CHECK(jog.end == EPG_JOG_STOPPED);
    CHECK(start_jog(0, 1.0, 100));
    fake_cycles(2);
    CHECK(jog.end == EPG_JOG_REFUSED);
    CHECK_EQUAL(drives, 4);
}

TEST(overruns_end_it)
{
    begin(false);
    fake.application.overrun_limit = 2;
    CHECK(start_jog(0, 1.0, 100));
    fake_cycles(3);
    fake_late_cycle(2 * FAKE_PERIOD_NS, 0);
    fake_late_cycle(2 * FAKE_PERIOD_NS, 0);
    CHECK(fake_status().fault == EPG_FAULT_OVERRUN);
    CHECK_EQUAL(fake.actuator, 0.0);
    fake_cycle();
    CHECK(jog.end == EPG_JOG_STOPPED);
    CHECK_EQUAL(fake.actuator, 0.0);
}

TEST(one_at_a_time_and_of_those_there_are)
{
    begin(false);
    CHECK(!start_jog(1, 1.0, 5));
    CHECK(start_jog(0, 1.0, 5));
    CHECK(!start_jog(0, -1.0, 5));
    fake_cycles(6);
    CHECK_EQUAL(driven, 1.0);
    CHECK(start_jog(0, -1.0, 5));
}

TEST(a_stop_of_the_loop_ends_it)
{
    begin(false);
    CHECK(start_jog(0, 1.0, 100));
    fake_cycles(3);
    fake_start();
    CHECK(epg_jog_idle(&jog));
    CHECK(jog.end == EPG_JOG_STOPPED);
    fake_cycles(3);
    CHECK_EQUAL(drives, 3);
}

/** Lets the lease end `ms` milliseconds from now. */
static void extend(unsigned int ms)
{
    epg_control_extend(&fake.control, fake_port.now_ns + (uint64_t)ms * 1000000U);
}

TEST(a_movement_on_the_lease_lasts_as_long_as_it)
{
    begin(false);
    fake_cycles(1000);
    extend(100);
    const uint64_t begin_ns = fake_port.now_ns;
    CHECK(start_jog(0, 1.0, EPG_JOG_LEASED));
    while (fake_port.now_ns - begin_ns < 98000000U) {
        fake_cycle();
        CHECK_EQUAL(fake.actuator, 1.0);
    }
    CHECK(epg_jog_is_leased(&jog, 0, 1.0));
    CHECK(!epg_jog_is_leased(&jog, 0, -1.0));
    CHECK(!epg_jog_is_leased(&jog, 1, 1.0));
    extend(100);
    fake_cycles(97);
    CHECK_EQUAL(fake.actuator, 1.0);
    fake_cycles(4);
    CHECK_EQUAL(fake.actuator, 0.0);
    CHECK(jog.end == EPG_JOG_DONE);
    CHECK_EQUAL(jog.cycles, drives);
    CHECK(!epg_jog_is_leased(&jog, 0, 1.0));
    CHECK(fake_status().fault == EPG_FAULT_NONE);
    extend(100); /* later than its end */
    fake_cycles(5);
    CHECK_EQUAL(fake.actuator, 0.0);
}

TEST(a_movement_on_a_lease_that_has_ended_drives_in_no_cycle)
{
    begin(false);
    fake_cycles(1000);
    extend(0);
    CHECK(start_jog(0, 1.0, EPG_JOG_LEASED));
    fake_cycles(5);
    CHECK(epg_jog_idle(&jog));
    CHECK_EQUAL(drives, 0);
}

TEST(a_movement_of_some_cycles_needs_no_lease)
{
    begin(false);
    fake_cycles(1000);
    extend(0);
    CHECK(start_jog(0, 1.0, 20));
    CHECK(!epg_jog_is_leased(&jog, 0, 1.0));
    fake_cycles(25);
    CHECK_EQUAL(drives, 20);
}

RUN()
