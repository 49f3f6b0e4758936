/**
 * @file
 * The fail-safe input against requests to enable, whatever their order.
 */
#include "check.h"
#include "epg/stop.h"
#include "fake_application.h"
#include "fake_port.h"

static bool fail_safe_input(void)
{
    return fake.fail_safe;
}

static void begin(void)
{
    fake_reset();
    fake.application.fail_safe = fail_safe_input;
    fake_start();
    fake_cycles(3);
    CHECK(fake_status().enabled);
}

static void check_safe(void)
{
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_FAIL_SAFE);
    CHECK_EQUAL(fake.actuator, 0.0);
}

TEST(a_cycle_that_samples_the_input_off_is_safe_as_a_whole)
{
    begin();
    fake.fail_safe = false;
    fake_cycle();
    check_safe();
    CHECK_EQUAL(fake.writes, 3);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_FAULT);
    CHECK_EQUAL(fake_status().stop_ns, fake_status().time_ns);
}

TEST(one_cycle_off_is_enough)
{
    begin();
    fake.fail_safe = false;
    fake_cycle();
    fake.fail_safe = true;
    for (int i = 0; i < 100; i++) {
        fake_cycle();
        check_safe();
    }
}

TEST(requests_while_the_input_is_off_enable_and_initialise_nothing)
{
    begin();
    fake.fail_safe = false;
    for (int i = 0; i < 50; i++) {
        epg_control_enable(&fake.control, EPG_ENABLE_ANY);
        fake_cycle();
        check_safe();
    }
    CHECK_EQUAL(fake.inits, 1);
    CHECK_EQUAL(fake.writes, 3);
    fake.fail_safe = true; /* none of them waits */
    for (int i = 0; i < 50; i++) {
        fake_cycle();
        check_safe();
    }
}

TEST(a_reset_while_the_input_is_off_clears_nothing)
{
    begin();
    fake.fail_safe = false;
    fake_cycles(5);
    epg_control_reset(&fake.control);
    fake_cycle();
    check_safe();
}

TEST(a_request_that_knows_the_fault_enables_when_the_input_is_on)
{
    begin();
    const uint64_t before = fake_status().stop_number;
    fake.fail_safe = false;
    fake_cycle();
    fake.fail_safe = true;
    fake_cycles(5);
    epg_control_enable(&fake.control, epg_enable_after(before));
    fake_cycles(5);
    check_safe();
    epg_control_enable(&fake.control, epg_enable_after(fake_status().stop_number));
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake.inits, 2);
    CHECK_EQUAL(fake.actuator, 1.0);
}

RUN()
