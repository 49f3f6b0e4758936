/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The platform `firmware` around the fake application: ticks of the program's timer, contexts, stop and safe state.
 */
#include "epg/firmware.h"

#include "check.h"
#include "fake_application.h"
#include "fake_port.h"
#include "tick.h"

static const epg_target_t target = {.control = &fake.control, .application = &fake.application};
static const epg_firmware_target_t firmware = {.target = &target};

/** The same state as after a reset of the processor: `state` of firmware.c survives epg_firmware_stop() only as OFF. */
static void begin(void)
{
    fake_reset();
    CHECK(epg_firmware_start(&firmware));
}

/** Runs `count` cycles of a timer whose period is `period_ns`; each call comes `late_ns` late. */
static void ticks(unsigned int count, uint64_t period_ns, uint64_t late_ns)
{
    for (unsigned int i = 0; i < count; i++) {
        fake_port.now_ns += period_ns + late_ns;
        memset(fake.calls, 0, sizeof fake.calls);
        epg_firmware_cycle();
        fake_port.now_ns -= late_ns;
    }
}

TEST(one_call_is_one_cycle)
{
    begin();
    ticks(1000, FAKE_PERIOD_NS, 0);
    CHECK_EQUAL(fake_status().statistics.cycles, 1000);
    CHECK_EQUAL(fake_status().statistics.missed, 0);
    CHECK_EQUAL(fake_status().statistics.lateness_max, 0);
    CHECK_EQUAL(fake.writes, 1000);
    CHECK(fake_status().fault == EPG_FAULT_NONE);
}

TEST(ticks_before_the_start_do_nothing)
{
    fake_reset();
    epg_firmware_cycle();
    epg_firmware_communicate();
    CHECK(!epg_firmware_alive());
    CHECK_EQUAL(fake.starts, 0);
    CHECK(epg_firmware_start(&firmware));
    CHECK(!epg_firmware_start(&firmware)); /* it runs already */
    CHECK_EQUAL(fake.starts, 1);
}

TEST(a_late_call_says_how_late)
{
    begin();
    ticks(10, FAKE_PERIOD_NS, 0);
    ticks(1, FAKE_PERIOD_NS, 300000);
    ticks(10, FAKE_PERIOD_NS, 0);
    CHECK_EQUAL(fake_status().statistics.cycles, 21);
    CHECK_EQUAL(fake_status().statistics.missed, 0);
    /* The sixteenth by which the estimate moves is missing. */
    CHECK_EQUAL(fake_status().statistics.lateness_max, 300000 - 300000 / 16);
}

TEST(missed_ticks_are_counted)
{
    begin();
    ticks(10, FAKE_PERIOD_NS, 0);
    ticks(1, 3 * FAKE_PERIOD_NS, 0);
    ticks(500, FAKE_PERIOD_NS, 0);
    CHECK_EQUAL(fake_status().statistics.cycles, 511);
    CHECK_EQUAL(fake_status().statistics.missed, 2);
    CHECK_EQUAL(fake_status().statistics.overruns, 1);
    CHECK(fake_status().fault == EPG_FAULT_NONE);
}

TEST(a_timer_and_a_clock_of_two_crystals)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        begin();
        ticks(100000, (uint64_t)(FAKE_PERIOD_NS + sign * 100), 0); /* 100 ppm */
        CHECK_EQUAL(fake_status().statistics.cycles, 100000);
        CHECK_EQUAL(fake_status().statistics.missed, 0);
        CHECK(fake_status().statistics.lateness_max <= 1600);
        CHECK(fake_status().fault == EPG_FAULT_NONE);
        CHECK(epg_firmware_stop());
    }
}

TEST(a_timer_with_a_wrong_period_is_a_fault)
{
    static const uint64_t wrong[] = {FAKE_PERIOD_NS / 2,     FAKE_PERIOD_NS * 97 / 100, FAKE_PERIOD_NS * 103 / 100,
                                     FAKE_PERIOD_NS * 3 / 2, FAKE_PERIOD_NS * 2,        FAKE_PERIOD_NS * 84};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        begin();
        fake.application.overrun_limit = 0;
        ticks(EPG_FIRMWARE_WINDOW + 2U, wrong[i], 0);
        CHECK(fake_status().fault == EPG_FAULT_TICK);
        CHECK(!fake_status().enabled);
        CHECK_EQUAL(fake.actuator, 0.0);
        CHECK(epg_firmware_stop());
    }
}

TEST(a_slow_timer_is_no_overrun)
{
    begin();
    fake.application.overrun_limit = 10; /* the default of a .tcf */
    ticks(12, 2U * FAKE_PERIOD_NS, 0);
    CHECK(fake_status().fault == EPG_FAULT_TICK);
    CHECK(epg_firmware_stop());
    begin();
    for (unsigned int i = 0; i < 20; i++) { /* now and then, something else blocks the interrupt */
        ticks(1, 2U * FAKE_PERIOD_NS, 0);
        ticks(5, FAKE_PERIOD_NS, 0);
    }
    CHECK(fake_status().fault == EPG_FAULT_NONE);
}

TEST(a_clock_that_stands_still_or_goes_back_is_a_fault)
{
    begin();
    ticks(EPG_FIRMWARE_WINDOW + 2U, 0, 0);
    CHECK(fake_status().fault == EPG_FAULT_TICK);
    CHECK(epg_firmware_stop()); /* although time does not pass */
    begin();
    fake_port.now_ns = 5000000000U;
    ticks(10, FAKE_PERIOD_NS, 0);
    fake_port.now_ns -= 4294967296U; /* a counter of 32 bits has wrapped */
    ticks(EPG_FIRMWARE_WINDOW, FAKE_PERIOD_NS, 0);
    CHECK(fake_status().fault == EPG_FAULT_TICK);
}

static void call_again(void)
{
    epg_firmware_cycle();
    CHECK(!epg_firmware_stop()); /* in the context of the cycle */
}

TEST(a_call_during_a_call_does_nothing)
{
    begin();
    fake_port.on_write = call_again;
    fake.application.write = call_again;
    ticks(5, FAKE_PERIOD_NS, 0);
    CHECK_EQUAL(fake_status().statistics.cycles, 5);
}

TEST(a_cycle_longer_than_a_period_is_an_overrun)
{
    begin();
    ticks(5, FAKE_PERIOD_NS, 0);
    fake.step_ns = FAKE_PERIOD_NS * 3 / 2;
    ticks(1, FAKE_PERIOD_NS, 0);
    CHECK_EQUAL(fake_status().statistics.overruns, 1);
    CHECK_EQUAL(fake_status().statistics.computation_max, FAKE_PERIOD_NS * 3 / 2);
}

TEST(cycles_that_miss_ticks_by_themselves_are_no_wrong_timer)
{
    begin();
    fake.application.overrun_limit = 0;
    for (unsigned int i = 0; i < 1000; i++) {
        fake.step_ns = FAKE_PERIOD_NS * 5 / 2; /* two ticks are missed, one of them is pending */
        ticks(1, FAKE_PERIOD_NS / 2, 0);
    }
    CHECK_EQUAL(fake_status().statistics.overruns, 1000);
    CHECK(fake_status().statistics.missed > 1990);
    CHECK(fake_status().fault == EPG_FAULT_NONE);
}

TEST(stop_without_ticks_makes_the_outputs_safe)
{
    begin();
    ticks(5, FAKE_PERIOD_NS, 0);
    CHECK(fake.actuator != 0.0);
    CHECK(epg_firmware_stop());
    CHECK_EQUAL(fake.actuator, 0.0);
    const unsigned int writes = fake.writes;
    ticks(5, FAKE_PERIOD_NS, 0);
    CHECK_EQUAL(fake.writes, writes);
    CHECK(epg_firmware_start(&firmware)); /* it can be started again */
    ticks(5, FAKE_PERIOD_NS, 0);
    CHECK_EQUAL(fake_status().statistics.cycles, 5);
}

TEST(safe_lasts)
{
    begin();
    ticks(5, FAKE_PERIOD_NS, 0);
    epg_firmware_safe(&firmware);
    CHECK_EQUAL(fake.actuator, 0.0);
    const unsigned int writes = fake.writes;
    ticks(5, FAKE_PERIOD_NS, 0);
    CHECK_EQUAL(fake.writes, writes);
    CHECK(!epg_firmware_start(&firmware));
    CHECK(!epg_firmware_alive());
}

static void (*make_safe)(void);

static void fault_during_safe(void)
{
    fake.application.safe = make_safe;
    epg_firmware_safe(&firmware);
}

TEST(safe_during_a_stop_lasts)
{
    begin();
    ticks(5, FAKE_PERIOD_NS, 0);
    make_safe = fake.application.safe;
    fake.application.safe = fault_during_safe; /* a fault handler interrupts the stop */
    CHECK(epg_firmware_stop());
    CHECK(!epg_firmware_start(&firmware));
}

static void (*write_outputs)(void);

static void write_after_safe(void)
{
    epg_firmware_safe(&firmware);
    write_outputs();
}

TEST(safe_during_a_cycle_is_the_last_word)
{
    begin();
    write_outputs = fake.application.write;
    fake.application.write = write_after_safe;
    ticks(1, FAKE_PERIOD_NS, 0);
    CHECK_EQUAL(fake.writes, 1);
    CHECK_EQUAL(fake.actuator, 0.0);
}

TEST(it_is_alive_while_both_sides_are)
{
    begin();
    ticks(10, FAKE_PERIOD_NS, 0);
    epg_firmware_communicate();
    ticks(999, FAKE_PERIOD_NS, 0);
    CHECK(epg_firmware_alive());
    ticks(3, FAKE_PERIOD_NS, 0);
    CHECK(!epg_firmware_alive());
    epg_firmware_communicate();
    ticks(1, FAKE_PERIOD_NS, 0);
    CHECK(epg_firmware_alive());
}

/* Streams ------------------------------------------------------------------------------------------------------ */

static unsigned char sent[64];
static size_t sent_count;
static size_t room;

static size_t take(const void *data, size_t size)
{
    const size_t count = size < room ? size : room;
    memcpy(sent + sent_count, data, count);
    sent_count += count;
    room -= count;
    return count;
}

static size_t give(void *data, size_t size)
{
    memcpy(data, "abc", size < 3 ? size : 3);
    return size < 3 ? size : 3;
}

TEST(a_stream_keeps_bytes_until_they_can_be_sent)
{
    static unsigned char ring[8];
    epg_firmware_stream_t stream = {.read = give, .write = take, .bytes = ring, .size = sizeof ring};
    const epg_transport_t transport = EPG_FIRMWARE_TRANSPORT(&stream);
    void *context = transport.stream.context;
    CHECK(transport.start(context, ""));
    CHECK(transport.stream.connected(context));
    CHECK_EQUAL(transport.stream.writable(context), 8);
    CHECK_EQUAL(transport.stream.write(context, "0123456789", 10), 8);
    CHECK_EQUAL(transport.stream.writable(context), 0);
    room = 3;
    transport.flush(context);
    CHECK_EQUAL(transport.stream.write(context, "89ABCD", 6), 3); /* round the end of the ring */
    room = 64;
    transport.flush(context);
    CHECK_EQUAL(transport.stream.writable(context), 8);
    CHECK_EQUAL(sent_count, 11);
    CHECK(memcmp(sent, "0123456789A", 11) == 0);
    char read[4] = "";
    CHECK_EQUAL(transport.stream.read(context, read, 2), 2);
    CHECK(strcmp(read, "ab") == 0);
}

RUN()
