/**
 * @file
 * Stops and requests to enable: each source of a stop, each gate, each word of the latch (epg/stop.h).
 */
#include "epg/stop.h"

#include "check.h"
#include "epg/fault.h"
#include "fake_application.h"
#include "fake_port.h"

/** Cycles that are disabled after a stop, at most. */
enum { DISABLED_CYCLES = 2 };

static void begin(bool enabled)
{
    fake_reset();
    fake.application.enable_at_start = enabled;
    fake_start();
    fake_cycle();
    CHECK(fake_status().enabled == enabled);
}

static void open_all_gates(void)
{
    for (unsigned int gate = 0; gate < EPG_GATES; gate++) {
        epg_gate_open(&fake.control, (epg_gate_t)gate);
    }
}

/** Returns true if the stop comes from the gate's own context. */
static bool is_own(unsigned int gate, unsigned int source)
{
    static const bool own[EPG_STOP_SOURCES][EPG_GATES] = {
        [EPG_STOP_LINE] = {[EPG_GATE_CONSOLE] = true},
        [EPG_STOP_FRAME] = {[EPG_GATE_CONSOLE] = true},
        [EPG_STOP_OTHER] = {[EPG_GATE_CONSOLE] = true},
        [EPG_STOP_TOPIC] = {[EPG_GATE_TOPIC] = true, [EPG_GATE_EDGE] = true},
        [EPG_STOP_SERVICE] = {[EPG_GATE_SERVICE] = true},
    };
    return gate >= EPG_GATES || own[source][gate];
}

/** The next cycle is disabled as a whole: its outputs are safe, and the model's are not written. */
static void check_disabled_cycle(void)
{
    const unsigned int writes = fake.writes;
    fake_cycle();
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake.actuator, 0.0);
    CHECK_EQUAL(fake.writes, writes);
    CHECK(strchr(fake.calls, 's') != NULL);
}

static void check_never_enabled(void)
{
    for (int i = 0; i < 100; i++) {
        check_disabled_cycle();
    }
}

/** The next cycle is the first one of an enabling: the model begins anew. */
static void check_enabling_cycle(void)
{
    const unsigned int inits = fake.inits;
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake.inits, inits + 1);
    CHECK_EQUAL(fake.state, 1.0);
    CHECK_EQUAL(fake.actuator, 1.0);
    CHECK(fake_status().fault == EPG_FAULT_NONE);
    fake_cycles(50);
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake.inits, inits + 1);
}

static uint64_t stop_number(void)
{
    return fake_status().stop_number;
}

/* A stop --------------------------------------------------------------------------------------------------------- */

TEST(a_stop_of_each_source_disables_the_next_cycle)
{
    for (unsigned int source = 0; source < EPG_STOP_SOURCES; source++) {
        begin(true);
        fake_cycles(3);
        const uint64_t number = stop_number();
        epg_stop(&fake.control, (epg_stop_source_t)source);
        check_disabled_cycle();
        CHECK_EQUAL(fake_status().stop_source, source);
        CHECK_EQUAL(stop_number(), number + 1);
        CHECK_EQUAL(fake_status().stop_ns, fake_status().time_ns);
        const uint64_t stop_ns = fake_status().stop_ns;
        check_never_enabled();
        CHECK_EQUAL(stop_number(), number + 1);
        CHECK_EQUAL(fake_status().stop_ns, stop_ns);
        CHECK(fake_status().fault == EPG_FAULT_NONE);
    }
}

TEST(a_stop_of_a_disabled_target_counts_too)
{
    begin(false);
    const uint64_t number = stop_number();
    epg_stop(&fake.control, EPG_STOP_LINE);
    fake_cycle();
    CHECK_EQUAL(stop_number(), number + 1);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_LINE);
}

TEST(stops_within_one_cycle_are_told_as_one)
{
    begin(true);
    const uint64_t number = stop_number();
    epg_stop(&fake.control, EPG_STOP_LINE);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycle();
    CHECK_EQUAL(stop_number(), number + 1);
    fake_cycles(10);
    epg_stop(&fake.control, EPG_STOP_FRAME); /* neither of the two before is told again */
    fake_cycle();
    CHECK_EQUAL(stop_number(), number + 2);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_FRAME);
}

static bool stopping;

/** Stops in the middle of a cycle, when the latch was taken already. */
static void stop_and_monitor(double *values)
{
    values[0] = 0.0;
    if (stopping) {
        stopping = false;
        epg_stop(&fake.control, EPG_STOP_PROGRAM);
        epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    }
}

TEST(a_stop_during_a_cycle_disables_the_next_one)
{
    fake_reset();
    fake.application.monitor = stop_and_monitor;
    fake_start();
    fake_cycles(3);
    stopping = true;
    fake_cycle();
    check_disabled_cycle();
    check_disabled_cycle();
    check_enabling_cycle();
}

/* A stop, then an enable: P1 and P6 ---------------------------------------------------------------------------- */

TEST(an_enable_after_a_stop_waits_for_disabled_cycles_and_begins_anew)
{
    for (unsigned int source = 0; source < EPG_STOP_SOURCES; source++) {
        for (unsigned int gate = 0; gate < EPG_REQUESTS; gate++) {
            if (!is_own(gate, source)) {
                continue;
            }
            begin(true);
            open_all_gates();
            fake_cycles(3);
            epg_stop(&fake.control, (epg_stop_source_t)source);
            epg_gate_enable(&fake.control, (epg_gate_t)gate, EPG_ENABLE_ANY);
            for (int i = 0; i < DISABLED_CYCLES; i++) {
                check_disabled_cycle();
            }
            check_enabling_cycle();
        }
    }
}

TEST(an_enable_acts_at_once_when_the_disabled_cycles_are_over)
{
    begin(true);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    check_disabled_cycle();
    check_disabled_cycle();
    check_disabled_cycle();
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    check_enabling_cycle();
}

TEST(an_enable_in_a_disabled_cycle_after_a_stop_waits_for_its_end)
{
    begin(true);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    check_disabled_cycle();
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    check_disabled_cycle();
    check_enabling_cycle();
}

TEST(each_stop_has_its_own_disabled_cycles)
{
    begin(true);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    check_disabled_cycle();
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    check_disabled_cycle();
    check_disabled_cycle();
    check_enabling_cycle();
}

TEST(an_enable_that_names_the_stop_before_it_acts)
{
    begin(true);
    epg_stop(&fake.control, EPG_STOP_FRAME);
    fake_cycles(5);
    epg_gate_open(&fake.control, EPG_GATE_CONSOLE);
    epg_gate_enable(&fake.control, EPG_GATE_CONSOLE, epg_enable_after(stop_number()) | EPG_ENABLE_LEASED);
    epg_control_extend(&fake.control, fake_port.now_ns + 1000000000U);
    check_enabling_cycle();
    CHECK(fake_status().leased);
}

/* An enable, then a stop: P2 ----------------------------------------------------------------------------------- */

TEST(an_enable_before_a_stop_never_acts)
{
    for (unsigned int source = 0; source < EPG_STOP_SOURCES; source++) {
        for (unsigned int gate = 0; gate < EPG_REQUESTS; gate++) {
            begin(false);
            open_all_gates();
            epg_gate_enable(&fake.control, (epg_gate_t)gate, EPG_ENABLE_ANY);
            epg_stop(&fake.control, (epg_stop_source_t)source);
            check_never_enabled();
            open_all_gates();
            check_never_enabled();
        }
    }
}

TEST(stop_enable_stop_stays_disabled)
{
    for (unsigned int source = 0; source < EPG_STOP_SOURCES; source++) {
        begin(true);
        for (int i = 0; i < 20; i++) {
            epg_stop(&fake.control, EPG_STOP_PROGRAM);
            epg_control_enable(&fake.control, EPG_ENABLE_ANY);
            epg_stop(&fake.control, (epg_stop_source_t)source);
            check_disabled_cycle();
        }
        check_never_enabled();
    }
}

TEST(a_request_to_enable_what_is_enabled_does_not_act_later)
{
    begin(true);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycles(3);
    CHECK_EQUAL(fake.inits, 1);
    epg_stop(&fake.control, EPG_STOP_LINE);
    check_never_enabled();
}

TEST(what_was_read_before_a_stop_does_not_act)
{
    for (unsigned int source = 0; source < EPG_STOP_SOURCES; source++) {
        for (unsigned int gate = 0; gate < EPG_GATES; gate++) {
            if (is_own(gate, source)) {
                continue;
            }
            begin(false);
            CHECK(epg_gate_poll(&fake.control, (epg_gate_t)gate)); /* the command is read here */
            epg_stop(&fake.control, (epg_stop_source_t)source);
            fake_cycles(5);
            epg_gate_enable(&fake.control, (epg_gate_t)gate, EPG_ENABLE_ANY); /* it is carried out here */
            CHECK(!epg_gate_is_open(&fake.control, (epg_gate_t)gate));
            check_never_enabled();
            CHECK(!epg_gate_poll(&fake.control, (epg_gate_t)gate)); /* the reader learns of the stop, once */
            check_never_enabled();
            CHECK(epg_gate_poll(&fake.control, (epg_gate_t)gate));
            epg_gate_enable(&fake.control, (epg_gate_t)gate, EPG_ENABLE_ANY);
            check_enabling_cycle();
        }
    }
}

TEST(a_stop_keeps_the_gate_of_its_own_context_only)
{
    for (unsigned int source = 0; source < EPG_STOP_SOURCES; source++) {
        for (unsigned int gate = 0; gate < EPG_REQUESTS; gate++) {
            begin(true);
            open_all_gates();
            epg_stop(&fake.control, (epg_stop_source_t)source);
            CHECK(epg_gate_is_open(&fake.control, (epg_gate_t)gate) == is_own(gate, source));
        }
    }
}

TEST(a_gate_that_is_opened_drops_what_was_requested_while_it_was_closed)
{
    begin(false);
    epg_gate_close(&fake.control, EPG_GATE_EDGE);
    epg_gate_enable(&fake.control, EPG_GATE_EDGE, EPG_ENABLE_ANY);
    check_never_enabled();
    epg_gate_open(&fake.control, EPG_GATE_EDGE);
    check_never_enabled();
    epg_gate_enable(&fake.control, EPG_GATE_EDGE, EPG_ENABLE_ANY);
    check_enabling_cycle();
}

TEST(a_closed_gate_does_not_stop_another_one)
{
    begin(false);
    open_all_gates();
    epg_gate_close(&fake.control, EPG_GATE_CONSOLE);
    epg_gate_enable(&fake.control, EPG_GATE_CONSOLE, EPG_ENABLE_ANY | EPG_ENABLE_LEASED);
    epg_gate_enable(&fake.control, EPG_GATE_SERVICE, EPG_ENABLE_ANY);
    check_enabling_cycle();
    CHECK(!fake_status().leased);
}

/* Numbers: P3 -------------------------------------------------------------------------------------------------- */

TEST(a_request_with_an_old_number_is_refused)
{
    begin(false);
    const uint64_t old = stop_number();
    epg_stop(&fake.control, EPG_STOP_LINE);
    fake_cycles(5);
    epg_control_enable(&fake.control, epg_enable_after(old));
    check_never_enabled();
    epg_control_enable(&fake.control, epg_enable_after(stop_number()));
    check_enabling_cycle();
}

TEST(a_request_with_an_old_number_clears_no_fault)
{
    begin(true);
    const uint64_t old = stop_number();
    fake.stop = true;
    fake_cycle();
    fake.stop = false;
    CHECK(fake_status().fault == EPG_FAULT_MODEL_STOPPED);
    CHECK_EQUAL(stop_number(), old + 1);
    epg_control_enable(&fake.control, epg_enable_after(old));
    check_never_enabled();
    CHECK(fake_status().fault == EPG_FAULT_MODEL_STOPPED);
    epg_control_enable(&fake.control, epg_enable_after(old + 1));
    check_enabling_cycle();
}

TEST(a_number_is_compared_bit_by_bit)
{
    for (unsigned int bit = 0; bit < 32 - EPG_ENABLE_SHIFT; bit++) {
        begin(false);
        epg_control_enable(&fake.control, epg_enable_after(stop_number() ^ (uint64_t)1 << bit));
        check_disabled_cycle();
        check_disabled_cycle();
    }
}

TEST(a_number_counts_stops_and_faults_and_keeps_the_id_of_the_boot)
{
    const uint64_t first = (uint64_t)FAKE_BOOT_ID << 32U;
    begin(true);
    CHECK(stop_number() == first);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_START);
    epg_stop(&fake.control, EPG_STOP_LINE);
    fake_cycle();
    CHECK(stop_number() == first + 1);
    epg_control_fault(&fake.control, EPG_FAULT_OUTPUT, FAKE_COMPONENT);
    fake_cycle();
    CHECK(stop_number() == first + 2);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_FAULT);
    CHECK_EQUAL(fake_status().stop_ns, FAKE_PERIOD_NS);
    epg_control_fault(&fake.control, EPG_FAULT_TICK, EPG_NO_COMPONENT); /* the first fault stays latched */
    fake_cycle();
    CHECK(stop_number() == first + 2);
}

TEST(a_number_at_its_wrap_keeps_the_id_of_the_boot)
{
    begin(false);
    fake.control.stop_number |= UINT32_MAX;
    epg_stop(&fake.control, EPG_STOP_LINE);
    fake_cycles(3);
    CHECK(stop_number() == (uint64_t)FAKE_BOOT_ID << 32U);
    epg_control_enable(&fake.control, epg_enable_after(UINT32_MAX));
    check_disabled_cycle();
    epg_control_enable(&fake.control, epg_enable_after(stop_number()));
    check_enabling_cycle();
}

TEST(requests_of_the_program_with_and_without_a_number_do_not_replace_each_other)
{
    begin(false);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    epg_control_enable(&fake.control, epg_enable_after(stop_number() + 1));
    check_enabling_cycle();
    begin(false);
    epg_control_enable(&fake.control, epg_enable_after(stop_number()));
    epg_stop(&fake.control, EPG_STOP_LINE);
    fake_cycles(5);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    check_enabling_cycle();
}

/* Faults ------------------------------------------------------------------------------------------------------- */

TEST(a_fault_stops_what_waits)
{
    for (unsigned int gate = 0; gate < EPG_REQUESTS; gate++) {
        begin(true);
        open_all_gates();
        epg_gate_enable(&fake.control, (epg_gate_t)gate, EPG_ENABLE_ANY); /* it waits, because it has nothing to do */
        fake_cycle();
        fake.fault = (epg_fault_t)300;
        fake_cycle();
        fake.fault = EPG_FAULT_NONE;
        CHECK_EQUAL(fake.actuator, 0.0);
        check_never_enabled();
        CHECK(fake_status().fault == (epg_fault_t)300);
        CHECK(epg_gate_is_open(&fake.control, (epg_gate_t)gate) == (gate >= EPG_GATES));
    }
}

TEST(a_fault_is_followed_by_a_disabled_cycle)
{
    begin(true);
    epg_control_fault(&fake.control, EPG_FAULT_OUTPUT, FAKE_COMPONENT);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    check_disabled_cycle();
    check_enabling_cycle();
}

TEST(a_stop_clears_no_fault)
{
    begin(true);
    fake.stop = true;
    fake_cycle();
    fake.stop = false;
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    check_never_enabled();
    CHECK(fake_status().fault == EPG_FAULT_MODEL_STOPPED);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_PROGRAM);
}

TEST(a_reset_of_a_fault_is_not_an_enable_and_not_a_stop)
{
    begin(true);
    fake.stop = true;
    fake_cycle();
    fake.stop = false;
    const uint64_t number = stop_number();
    check_never_enabled();
    epg_control_reset(&fake.control);
    check_never_enabled();
    CHECK(fake_status().fault == EPG_FAULT_NONE);
    CHECK_EQUAL(stop_number(), number);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    check_enabling_cycle();
    fake.stop = true;
    fake_cycle();
    fake.stop = false;
    check_never_enabled();
    CHECK(fake_status().fault == EPG_FAULT_MODEL_STOPPED); /* one reset clears one fault */
}

static bool fail_safe_input(void)
{
    return fake.fail_safe;
}

TEST(an_enable_that_waits_behind_a_stop_obeys_the_fail_safe_input)
{
    begin(true);
    fake.application.fail_safe = fail_safe_input;
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    check_disabled_cycle();
    fake.fail_safe = false;
    check_disabled_cycle();
    CHECK(fake_status().fault == EPG_FAULT_FAIL_SAFE);
    fake.fail_safe = true; /* the fault was a stop: the request that waited is gone */
    check_never_enabled();
}

/* Starts ------------------------------------------------------------------------------------------------------- */

TEST(a_stop_before_the_start_is_kept)
{
    fake_reset();
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_start();
    check_never_enabled();
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_PROGRAM);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    check_enabling_cycle();
}

TEST(an_enable_before_a_stop_before_the_start_does_not_act)
{
    fake_reset();
    fake.application.enable_at_start = false;
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_start();
    check_never_enabled();
}

TEST(an_enable_before_the_first_start_acts)
{
    fake_reset();
    fake.application.enable_at_start = false;
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_start();
    check_enabling_cycle();
}

TEST(a_second_start_counts_and_keeps_no_request)
{
    begin(false);
    open_all_gates();
    epg_gate_enable(&fake.control, EPG_GATE_CONSOLE, EPG_ENABLE_ANY);
    epg_control_enable(&fake.control, epg_enable_after(stop_number()));
    const uint64_t number = stop_number();
    fake_start();
    check_disabled_cycle();
    CHECK_EQUAL(stop_number(), number + 1);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_START);
    for (unsigned int gate = 0; gate < EPG_GATES; gate++) {
        CHECK(!epg_gate_is_open(&fake.control, (epg_gate_t)gate));
    }
    check_never_enabled();
}

TEST(the_first_cycle_of_a_second_start_may_be_enabled)
{
    begin(true);
    fake_start();
    fake_cycle();
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake.actuator, 1.0);
}

TEST(a_stop_between_two_starts_is_kept)
{
    begin(true);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_start();
    check_never_enabled();
}

/* Movements by hand -------------------------------------------------------------------------------------------- */

static unsigned int drives;

static void drive(double duty)
{
    fake.actuator = duty;
    drives++;
}

static const epg_jog_actuator_t actuators[1] = {{"motor", drive, NULL}};
static epg_jog_t jog = {.actuator_count = 1, .actuators = actuators};

static void begin_with_jog(void)
{
    fake_reset();
    drives = 0;
    fake.application.enable_at_start = false;
    fake.application.jog = &jog;
    fake_start();
    open_all_gates();
    fake_cycle();
}

TEST(a_movement_by_hand_that_waits_when_a_stop_comes_never_moves)
{
    for (unsigned int source = 0; source < EPG_STOP_SOURCES; source++) {
        begin_with_jog();
        CHECK(epg_gate_move(&fake.control));
        epg_stop(&fake.control, (epg_stop_source_t)source);
        CHECK(epg_jog_start(&jog, 0, 1.0, 100)); /* its command was on its way */
        check_never_enabled();
        CHECK_EQUAL(drives, 0);
        CHECK(jog.end == EPG_JOG_REFUSED);
    }
}

TEST(a_stop_ends_a_movement_by_hand)
{
    for (unsigned int source = 0; source < EPG_STOP_SOURCES; source++) {
        begin_with_jog();
        CHECK(epg_gate_move(&fake.control));
        CHECK(epg_jog_start(&jog, 0, 1.0, 100));
        fake_cycles(5);
        CHECK_EQUAL(drives, 5);
        epg_stop(&fake.control, (epg_stop_source_t)source);
        check_never_enabled();
        CHECK_EQUAL(drives, 5);
        CHECK(jog.end == EPG_JOG_STOPPED);
    }
}

TEST(a_fault_ends_a_movement_by_hand_also_if_one_is_latched)
{
    for (int latched = 0; latched < 2; latched++) {
        begin_with_jog();
        if (latched != 0) {
            epg_control_fault(&fake.control, EPG_FAULT_OUTPUT, FAKE_COMPONENT);
        }
        fake_cycles(3);
        epg_gate_open(&fake.control, EPG_GATE_CONSOLE);
        CHECK(epg_gate_move(&fake.control));
        CHECK(epg_jog_start(&jog, 0, 1.0, 100));
        fake_cycles(5);
        CHECK_EQUAL(drives, 5);
        fake.fault = (epg_fault_t)300;
        check_disabled_cycle();
        fake.fault = EPG_FAULT_NONE;
        check_never_enabled();
        CHECK_EQUAL(drives, 5);
    }
}

TEST(a_movement_by_hand_must_not_begin_if_it_was_read_before_a_stop)
{
    begin_with_jog();
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(5);
    CHECK(!epg_gate_move(&fake.control));
    CHECK(!epg_gate_poll(&fake.control, EPG_GATE_CONSOLE));
    CHECK(epg_gate_move(&fake.control));
}

TEST(the_end_of_a_movement_by_hand_is_not_a_stop)
{
    begin_with_jog();
    const uint64_t number = stop_number();
    CHECK(epg_gate_move(&fake.control));
    CHECK(epg_jog_start(&jog, 0, 1.0, 100));
    fake_cycles(5);
    epg_gate_end_move(&fake.control);
    check_never_enabled();
    CHECK_EQUAL(drives, 5);
    CHECK_EQUAL(stop_number(), number);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_START);
    epg_control_enable(&fake.control, epg_enable_after(number));
    epg_gate_end_move(&fake.control); /* the request stays */
    check_enabling_cycle();
}

TEST(a_movement_by_hand_without_permission_does_not_move)
{
    begin_with_jog();
    CHECK(epg_jog_start(&jog, 0, 1.0, 100));
    check_never_enabled();
    CHECK_EQUAL(drives, 0);
}

RUN()
