/**
 * @file
 * Leases in the control cycle: when they end, and that nothing else changes on them.
 */
#include "check.h"
#include "epg/stop.h"
#include "fake_application.h"
#include "fake_port.h"

/** The unit in which a lease is measured, in ns: its end is rounded down to a multiple (epg/control.h). */
#define UNIT_NS ((uint64_t)1 << 20U)
#define MS ((uint64_t)1000000)

static void begin(void)
{
    fake_reset();
    fake.application.enable_at_start = false;
    fake_start();
    fake_cycle();
    epg_gate_open(&fake.control, EPG_GATE_CONSOLE);
}

static void enable_leased(uint64_t until_ns)
{
    epg_control_extend(&fake.control, until_ns);
    epg_gate_enable(&fake.control, EPG_GATE_CONSOLE, EPG_ENABLE_ANY | EPG_ENABLE_LEASED);
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK(fake_status().leased);
}

/** Time of the first cycle that is not enabled. */
static uint64_t end_of_lease(void)
{
    for (int i = 0; i < 2000; i++) {
        fake_cycle();
        if (!fake_status().enabled) {
            CHECK_EQUAL(fake.actuator, 0.0);
            CHECK(fake_status().fault == EPG_FAULT_OPERATOR);
            CHECK_EQUAL(fake_status().fault_component, EPG_NO_COMPONENT);
            return fake_status().time_ns;
        }
    }
    CHECK(!"the lease ends");
    return 0;
}

/** The lease has ended in time: not after the first cycle at `until_ns` or later, and not more than its unit before. */
static void check_end(uint64_t until_ns)
{
    const uint64_t end_ns = end_of_lease();
    CHECK(end_ns < until_ns + FAKE_PERIOD_NS);
    CHECK(end_ns + UNIT_NS >= until_ns);
}

TEST(a_lease_ends_when_its_time_has_passed)
{
    for (uint64_t us = 0; us < 3000; us += 37) {
        begin();
        const uint64_t until_ns = 300 * MS + us * 1000U;
        enable_leased(until_ns);
        check_end(until_ns);
    }
}

TEST(a_lease_that_is_extended_goes_on)
{
    begin();
    enable_leased(20 * MS);
    for (uint64_t ms = 10; ms < 1000; ms += 10) {
        epg_control_extend(&fake.control, (ms + 20) * MS);
        fake_cycles(10);
        CHECK(fake_status().enabled);
    }
    check_end(1010 * MS);
}

TEST(a_lease_ends_in_time_when_its_word_wraps)
{
    const uint64_t wrap_ns = (uint64_t)1 << (32U + 20U);
    for (uint64_t ms = 0; ms < 200; ms += 7) {
        begin();
        fake.tick = wrap_ns / FAKE_PERIOD_NS - 100;
        const uint64_t until_ns = (fake.tick + ms) * FAKE_PERIOD_NS + 10 * MS;
        enable_leased(until_ns);
        check_end(until_ns);
    }
}

TEST(a_lease_that_is_over_before_it_begins_enables_nothing)
{
    begin();
    fake_cycles(50);
    epg_control_extend(&fake.control, 20 * MS);
    epg_gate_enable(&fake.control, EPG_GATE_CONSOLE, EPG_ENABLE_ANY | EPG_ENABLE_LEASED);
    fake_cycle();
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_OPERATOR);
    CHECK_EQUAL(fake.writes, 0);
}

TEST(a_lease_that_has_ended_does_not_come_back)
{
    begin();
    enable_leased(20 * MS);
    (void)end_of_lease();
    epg_control_extend(&fake.control, 1000 * MS); /* an answer that was late */
    fake_cycles(50);
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_OPERATOR);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_FAULT);
}

TEST(a_stop_disables_a_target_on_a_lease)
{
    for (unsigned int source = 0; source < EPG_STOP_SOURCES; source++) {
        begin();
        enable_leased(300 * MS);
        fake_cycles(10);
        epg_stop(&fake.control, (epg_stop_source_t)source);
        const unsigned int writes = fake.writes;
        fake_cycles(100);
        CHECK_EQUAL(fake.writes, writes);
        CHECK_EQUAL(fake.actuator, 0.0);
        CHECK(!fake_status().enabled);
        CHECK(fake_status().fault == EPG_FAULT_NONE);
        fake_cycles(500); /* the end of the lease of a disabled target is not a fault */
        CHECK(fake_status().fault == EPG_FAULT_NONE);
    }
}

TEST(a_target_that_is_enabled_without_a_lease_after_one_has_none)
{
    begin();
    enable_leased(300 * MS);
    epg_stop(&fake.control, EPG_STOP_LINE);
    fake_cycles(3);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycles(1000);
    CHECK(fake_status().enabled);
    CHECK(!fake_status().leased);
}

TEST(a_target_that_is_enabled_on_a_lease_after_none_has_one)
{
    begin();
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycles(10);
    CHECK(!fake_status().leased);
    epg_stop(&fake.control, EPG_STOP_LINE);
    fake_cycles(3);
    enable_leased(100 * MS);
    check_end(100 * MS);
}

TEST(a_request_on_a_lease_does_not_change_a_target_that_is_enabled_without_one)
{
    begin();
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycles(3);
    epg_control_extend(&fake.control, 20 * MS);
    epg_gate_enable(&fake.control, EPG_GATE_CONSOLE, EPG_ENABLE_ANY | EPG_ENABLE_LEASED);
    fake_cycles(1000);
    CHECK(fake_status().enabled);
    CHECK(!fake_status().leased);
}

TEST(a_request_without_a_lease_does_not_free_a_target_from_its_own)
{
    begin();
    enable_leased(100 * MS);
    const unsigned int inits = fake.inits;
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycles(3);
    CHECK(fake_status().leased);
    CHECK_EQUAL(fake.inits, inits);
    check_end(100 * MS);
    fake_cycles(10);
    CHECK(!fake_status().enabled);
}

TEST(the_end_of_a_lease_is_latched_until_an_enable)
{
    begin();
    const uint64_t number = fake_status().stop_number;
    enable_leased(20 * MS);
    (void)end_of_lease();
    CHECK_EQUAL(fake_status().stop_number, number + 1);
    CHECK_EQUAL(fake_status().statistics.faults, 1);
    fake_cycles(10);
    epg_control_enable(&fake.control, epg_enable_after(number));
    fake_cycles(10);
    CHECK(fake_status().fault == EPG_FAULT_OPERATOR);
    epg_control_enable(&fake.control, epg_enable_after(number + 1));
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_NONE);
}

RUN()
