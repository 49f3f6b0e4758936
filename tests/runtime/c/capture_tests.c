/**
 * @file
 * Recordings around a trigger.
 */
#include "epg/capture.h"

#include <math.h>

#include "check.h"
#include "fake_application.h"
#include "fake_port.h"

enum { CAPACITY = 60 };

static double memory[CAPACITY];
static epg_capture_t capture;
static double ramp; /* the value of a signal, set by the test */

/** Ticks are at whole milliseconds, which the tests count. */
static void begin(void)
{
    fake_reset();
    capture = (epg_capture_t){.memory = memory, .capacity = CAPACITY};
    fake.application.capture = &capture;
    fake_start();
    ramp = 0.0;
}

/** Runs `count` cycles, in each of which the signal grows by `slope`. */
static void cycles(unsigned int count, double slope)
{
    for (unsigned int i = 0; i < count; i++) {
        ramp += slope;
        fake.sensor = ramp;
        fake_cycle();
    }
}

static epg_capture_request_t request_of(size_t rows)
{
    return (epg_capture_request_t){
        .columns = 2, .signals = {&fake.input, &fake.output}, .rows = rows, .every = 1, .trigger = EPG_CAPTURE_NOW};
}

/** The tick of a row in milliseconds; `*value` is the row's first signal. */
static uint64_t row(size_t index, double *value)
{
    uint64_t tick_ns;
    const double *values;
    CHECK(epg_capture_row(&capture, index, &tick_ns, &values));
    *value = values[0];
    CHECK(tick_ns % FAKE_PERIOD_NS == 0);
    return tick_ns / FAKE_PERIOD_NS;
}

TEST(every_cycle_has_a_row_with_the_values_of_that_cycle)
{
    begin();
    cycles(5, 1.0);
    const epg_capture_request_t request = request_of(20);
    CHECK_EQUAL(epg_capture_rows(&capture, 2), 20);
    CHECK(epg_capture_start(&capture, &request));
    CHECK(!epg_capture_idle(&capture));
    CHECK(!epg_capture_start(&capture, &request));
    cycles(19, 1.0);
    CHECK(!epg_capture_idle(&capture));
    CHECK_EQUAL(epg_capture_recorded(&capture), 19);
    cycles(1, 1.0);
    CHECK(epg_capture_idle(&capture));
    cycles(7, 1.0);
    CHECK_EQUAL(epg_capture_recorded(&capture), 20);
    CHECK(capture.triggered);
    CHECK_EQUAL(epg_capture_trigger_row(&capture), 0);
    for (size_t i = 0; i < 20; i++) {
        double value;
        CHECK_EQUAL(row(i, &value), 5 + i);
        CHECK_EQUAL(value, 6.0 + (double)i);
    }
    uint64_t tick_ns;
    const double *values;
    CHECK(!epg_capture_row(&capture, 20, &tick_ns, &values));
}

TEST(rows_from_before_the_trigger_are_kept)
{
    for (size_t before = 0; before < 10; before++) {
        for (unsigned int lead = 0; lead < 40; lead += 3) {
            begin();
            epg_capture_request_t request = request_of(10);
            request.before = before;
            request.trigger = EPG_CAPTURE_RISING;
            request.watched = &fake.input;
            request.level = 100.5;
            CHECK(epg_capture_start(&capture, &request));
            cycles(1, 50.0);
            cycles(lead, 0.5);
            const uint64_t tick = fake.tick;
            cycles(1, 60.0); /* the trigger */
            cycles(9, 0.5);
            CHECK(epg_capture_idle(&capture));
            const size_t kept = lead + 1U < before ? lead + 1U : before;
            CHECK_EQUAL(epg_capture_recorded(&capture), 10);
            CHECK_EQUAL(epg_capture_trigger_row(&capture), kept);
            for (size_t i = 0; i < 10; i++) {
                double value;
                CHECK_EQUAL(row(i, &value), tick - kept + i);
                CHECK((value >= 100.5) == (i >= kept));
            }
        }
    }
}

TEST(every_nth_cycle_and_always_that_of_the_trigger)
{
    begin();
    epg_capture_request_t request = request_of(6);
    request.every = 4;
    request.before = 2;
    request.trigger = EPG_CAPTURE_FALLING;
    request.watched = &fake.input;
    request.level = -10.0;
    CHECK(epg_capture_start(&capture, &request));
    cycles(30, -1.0);
    CHECK(epg_capture_idle(&capture));
    double value;
    /* The trigger is in the tenth cycle; the rows before it are from the first, fifth and ninth cycle. */
    CHECK_EQUAL(epg_capture_trigger_row(&capture), 2);
    CHECK_EQUAL(row(0, &value), 4);
    CHECK_EQUAL(row(1, &value), 8);
    CHECK_EQUAL(row(2, &value), 9);
    CHECK_EQUAL(value, -10.0);
    CHECK_EQUAL(row(3, &value), 13);
    CHECK_EQUAL(row(5, &value), 21);
}

TEST(a_level_that_holds_already_is_no_trigger)
{
    begin();
    cycles(3, 100.0);
    epg_capture_request_t request = request_of(5);
    request.trigger = EPG_CAPTURE_RISING;
    request.watched = &fake.input;
    request.level = 50.0;
    CHECK(epg_capture_start(&capture, &request));
    cycles(20, 1.0);
    CHECK(!epg_capture_idle(&capture));
    cycles(1, -400.0);
    cycles(5, 400.0);
    CHECK(epg_capture_idle(&capture));
}

TEST(a_fault_with_what_led_to_it)
{
    begin();
    cycles(3, 1.0);
    epg_capture_request_t request = request_of(8);
    request.before = 7;
    request.trigger = EPG_CAPTURE_FAULT;
    CHECK(epg_capture_start(&capture, &request));
    cycles(20, 1.0);
    CHECK(!epg_capture_idle(&capture));
    fake.output_error = NAN;
    cycles(1, 1.0);
    CHECK(epg_capture_idle(&capture));
    double value;
    CHECK_EQUAL(epg_capture_trigger_row(&capture), 7);
    CHECK_EQUAL(row(7, &value), 23);
    uint64_t tick_ns;
    const double *values;
    CHECK(epg_capture_row(&capture, 7, &tick_ns, &values));
    CHECK(isnan(values[1]));
}

TEST(a_recording_can_be_stopped_before_and_after_its_trigger)
{
    begin();
    epg_capture_request_t request = request_of(10);
    request.before = 5;
    request.trigger = EPG_CAPTURE_RISING;
    request.watched = &fake.input;
    request.level = 1000.0;
    CHECK(epg_capture_start(&capture, &request));
    cycles(13, 1.0);
    epg_capture_stop(&capture);
    cycles(1, 1.0);
    CHECK(epg_capture_idle(&capture));
    CHECK(!capture.triggered);
    CHECK_EQUAL(epg_capture_recorded(&capture), 10);
    double value;
    CHECK_EQUAL(row(0, &value), 3);
    CHECK_EQUAL(row(9, &value), 12);

    CHECK(epg_capture_start(&capture, &request));
    cycles(2, 1.0);
    cycles(3, 1000.0);
    epg_capture_stop(&capture);
    cycles(1, 1.0);
    CHECK(epg_capture_idle(&capture));
    CHECK(capture.triggered);
    CHECK_EQUAL(epg_capture_recorded(&capture), 5);
    CHECK_EQUAL(epg_capture_trigger_row(&capture), 2);
}

TEST(it_records_while_disabled_and_while_the_model_rests)
{
    begin();
    fake.output_error = NAN;
    fake_cycle();
    const epg_capture_request_t request = request_of(4);
    CHECK(epg_capture_start(&capture, &request));
    cycles(4, 1.0);
    CHECK(epg_capture_idle(&capture));
    double value;
    CHECK_EQUAL(row(3, &value), 4);
    CHECK_EQUAL(value, 4.0);
}

TEST(a_stop_of_the_loop_ends_it)
{
    begin();
    const epg_capture_request_t request = request_of(10);
    CHECK(epg_capture_start(&capture, &request));
    fake_cycles(3);
    fake_start();
    CHECK(epg_capture_idle(&capture));
    fake_cycles(3);
    CHECK_EQUAL(epg_capture_recorded(&capture), 3);
    CHECK(epg_capture_start(&capture, &request));
    fake_cycles(10);
    CHECK_EQUAL(epg_capture_recorded(&capture), 10);
}

RUN()
