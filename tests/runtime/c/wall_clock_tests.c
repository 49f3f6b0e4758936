/**
 * @file
 * The clock of the network: rounds of requests, the best answer, corrections and steps.
 *
 * A simulated agent answers after the time of both ways.  Its clock is an offset and a drift away from the board's.
 */
#include "epg/wall_clock.h"

#include "check.h"

#define MS UINT64_C(1000000)
#define SECOND (1000 * MS)
#define EPOCH (UINT64_C(1700000000) * SECOND)

enum { REQUESTS = 256 };

static struct {
    epg_clock_t clock;
    uint64_t now_ns;   /* board time */
    uint64_t epoch_ns; /* the agent's time is board time + this */
    uint64_t there_ns;
    uint64_t back_ns;
    uint64_t slow_ns; /* additional time of an answer, but for each `lucky`-th */
    unsigned int lucky;
    bool silent;              /* requests are lost */
    bool busy;                /* each poll has other work */
    uint64_t asked[REQUESTS]; /* 0: the answer has arrived */
    unsigned int requests;
    uint64_t newest_ns; /* newest stamp */
} network;

static void begin(uint64_t there_ns, uint64_t back_ns)
{
    memset(&network, 0, sizeof network);
    network.now_ns = 5 * SECOND;
    network.epoch_ns = EPOCH;
    network.there_ns = there_ns;
    network.back_ns = back_ns;
    network.lucky = 1;
    epg_clock_start(&network.clock, false);
    epg_clock_connected(&network.clock, network.now_ns);
}

static uint64_t stamp(uint64_t time_ns)
{
    return epg_clock_stamp_ns(&network.clock, time_ns);
}

/** Returns the error of a stamp of this instant. */
static int64_t error(void)
{
    return (int64_t)(stamp(network.now_ns) - (network.now_ns + network.epoch_ns));
}

static int64_t size_of(int64_t number)
{
    return number < 0 ? -number : number;
}

static uint64_t back_of(unsigned int request)
{
    return network.back_ns + (request % network.lucky == network.lucky - 1 ? 0 : network.slow_ns);
}

/** Takes the answers that have arrived.  A fast one overtakes slow ones. */
static void take_answers(void)
{
    for (unsigned int i = 0; i < network.requests; i++) {
        const uint64_t asked_ns = network.asked[i];
        const uint64_t round_trip_ns = network.there_ns + back_of(i);
        if (asked_ns > 0 && asked_ns + round_trip_ns <= network.now_ns) {
            const uint64_t agent_ns = asked_ns + network.there_ns + network.epoch_ns;
            epg_clock_answer(&network.clock, agent_ns + round_trip_ns / 2, network.now_ns, round_trip_ns);
            network.asked[i] = 0;
        }
    }
}

/** Runs for `milliseconds`, with a poll in each of them.  Stamps must not run backwards. */
static void run(unsigned int milliseconds)
{
    for (unsigned int i = 0; i < milliseconds; i++) {
        network.now_ns += MS;
        take_answers();
        if (epg_clock_poll(&network.clock, network.now_ns, network.busy) && !network.silent) {
            CHECK(network.requests < REQUESTS);
            network.asked[network.requests++] = network.now_ns;
        }
        const uint64_t newest_ns = stamp(network.now_ns);
        CHECK(newest_ns >= network.newest_ns);
        CHECK(newest_ns == 0 || newest_ns >= EPOCH / 2); /* the time since the board's start is not a stamp */
        network.newest_ns = newest_ns;
    }
}

TEST(a_clock_that_is_not_set_has_the_stamp_0)
{
    begin(5 * MS, 5 * MS);
    network.silent = true;
    run(5000);
    CHECK(!network.clock.set);
    CHECK_EQUAL(stamp(network.now_ns), 0);
    network.silent = false;
    run(1200);
    CHECK(network.clock.set);
    CHECK_EQUAL(error(), 0);
    CHECK(stamp(network.now_ns - 10 * SECOND) == EPOCH + network.now_ns - 10 * SECOND); /* also of a cycle before */
}

TEST(it_is_set_by_the_best_of_eight_answers)
{
    begin(20 * MS, 20 * MS);
    network.slow_ns = 300 * MS;
    network.lucky = 6; /* the sixth answer is the only fast one */
    run(400);
    CHECK(!network.clock.set);
    run(100);
    CHECK(network.clock.set);
    CHECK_EQUAL(network.clock.uncertainty_ns, 20 * MS);
    CHECK_EQUAL(error(), 0);
}

TEST(its_error_is_at_most_its_uncertainty_after_any_round_trip)
{
    static const uint64_t ways[][2] = {{5, 5},    {30, 30},  {150, 150}, {300, 300},
                                       {10, 200}, {200, 10}, {0, 600},   {950, 950}};
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        const uint64_t round_trip_ns = (ways[i][0] + ways[i][1]) * MS;
        begin(ways[i][0] * MS, ways[i][1] * MS);
        run(round_trip_ns < 850 * MS ? 1000 : 2100); /* within the first round, or when its answers arrive */
        CHECK(network.clock.set);
        CHECK_EQUAL(network.clock.uncertainty_ns, round_trip_ns / 2);
        CHECK_EQUAL(2 * size_of(error()), size_of((int64_t)(ways[i][0] * MS) - (int64_t)(ways[i][1] * MS)));
        run(60000);
        CHECK_EQUAL(2 * size_of(error()), size_of((int64_t)(ways[i][0] * MS) - (int64_t)(ways[i][1] * MS)));
        CHECK_EQUAL(network.clock.uncertainty_ns, round_trip_ns / 2);
        CHECK_EQUAL(network.clock.steps, 0);
    }
}

TEST(requests_come_in_rounds_of_eight)
{
    begin(5 * MS, 5 * MS);
    run(140);
    CHECK_EQUAL(network.requests, 7);
    run(1); /* every 20 ms, since the first millisecond */
    CHECK_EQUAL(network.requests, 8);
    run(9859);
    CHECK_EQUAL(network.requests, 8);
    run(1); /* 10 s after the begin of the first round */
    CHECK_EQUAL(network.requests, 9);
    run(699);
    CHECK_EQUAL(network.requests, 15);
    run(1); /* every 100 ms */
    CHECK_EQUAL(network.requests, 16);
    run(9000);
    CHECK_EQUAL(network.requests, 16);
}

TEST(a_request_waits_for_a_short_poll_for_at_most_5_ms)
{
    begin(5 * MS, 5 * MS);
    network.busy = true;
    run(4);
    CHECK_EQUAL(network.requests, 0);
    run(1);
    CHECK_EQUAL(network.requests, 1);
    run(24);
    CHECK_EQUAL(network.requests, 1);
    run(1);
    CHECK_EQUAL(network.requests, 2);
    run(15); /* 20 ms after the last one */
    network.busy = false;
    run(5);
    CHECK_EQUAL(network.requests, 3);
}

TEST(answers_that_are_missing_are_not_waited_for)
{
    begin(100 * MS, 100 * MS);
    run(50); /* three requests arrive */
    network.silent = true;
    run(940);
    CHECK(!network.clock.set);
    run(15);
    CHECK(network.clock.set);
    CHECK_EQUAL(error(), 0);
    run(10000);
    network.silent = false;
    network.epoch_ns += 40 * MS;
    run(15000); /* a round without an answer is followed by the next one at once */
    CHECK_EQUAL(error(), 0);
}

TEST(answers_after_the_end_of_a_round_do_not_count_in_the_next_one)
{
    begin(495 * MS, 495 * MS);
    run(1005);
    CHECK(network.clock.set); /* by the first answer; the others are late */
    run(1000);
    network.epoch_ns += 100 * MS;
    run(18500);
    CHECK_EQUAL(error(), 0);
}

TEST(a_difference_is_corrected_evenly_and_stamps_run_on)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        begin(MS, MS);
        run(1000);
        network.epoch_ns += (uint64_t)sign * 500 * MS;
        run(11000); /* the next round */
        CHECK_EQUAL(network.clock.steps, 0);
        const int64_t before = error();
        CHECK(size_of(before) > 300 * (int64_t)MS);
        run(1000);
        const int64_t corrected = size_of(before) - size_of(error());
        CHECK(corrected > 50 * (int64_t)MS && corrected < 60 * (int64_t)MS); /* 0.5 s in 8.6 s */
        run(8000);
        CHECK_EQUAL(error(), 0);
    }
}

TEST(a_clock_that_drifts_is_followed_smoothly)
{
    begin(5 * MS, 5 * MS);
    run(1000);
    for (int i = 0; i < 300; i++) {
        const uint64_t before_ns = stamp(network.now_ns);
        network.epoch_ns += 20000; /* 100 parts per million */
        run(200);
        const int64_t rate = (int64_t)(stamp(network.now_ns) - before_ns) - 200 * (int64_t)MS;
        CHECK(size_of(rate) < 60000); /* never more than 300 parts per million */
        CHECK(size_of(error()) < 2500000);
    }
    CHECK_EQUAL(network.clock.steps, 0);
}

TEST(cycles_that_have_waited_get_the_stamps_of_their_time)
{
    begin(MS, MS);
    run(1000);
    network.epoch_ns -= 400 * MS;
    run(9000);
    uint64_t told_ns = 0;
    for (int i = 0; i < 16000; i++) { /* each cycle is sent 300 ms late, while the clock is corrected */
        if (i == 4000) {              /* a connection, and a round with it, in the middle of the correction */
            network.epoch_ns -= 100 * MS;
            epg_clock_connected(&network.clock, network.now_ns);
        }
        run(1);
        const uint64_t cycle_ns = stamp(network.now_ns - 300 * MS);
        CHECK(cycle_ns >= told_ns);
        told_ns = cycle_ns;
    }
    CHECK_EQUAL(error(), 0);
}

TEST(a_clock_that_is_set_back_is_a_step)
{
    begin(5 * MS, 5 * MS);
    run(1000);
    network.epoch_ns -= 3600 * SECOND;
    for (int i = 0; i < 12000 && network.clock.steps == 0; i++) {
        network.newest_ns = 0; /* the only case in which stamps run backwards */
        run(1);
    }
    CHECK_EQUAL(network.clock.steps, 1);
    CHECK_EQUAL(network.clock.step_ns, -3600 * (int64_t)SECOND);
    CHECK_EQUAL(error(), 0);
    run(60000);
    CHECK_EQUAL(error(), 0);
    CHECK_EQUAL(network.clock.steps, 1);
    network.epoch_ns += 501 * MS;
    run(12000);
    CHECK_EQUAL(error(), 0);
    CHECK_EQUAL(network.clock.steps, 2);
    CHECK_EQUAL(network.clock.step_ns, 501 * MS);
}

TEST(a_clock_stays_set_while_there_is_no_connection)
{
    begin(5 * MS, 5 * MS);
    run(1000);
    const unsigned int requests = network.requests;
    network.now_ns += 100 * SECOND;
    CHECK_EQUAL(error(), 0);
    epg_clock_connected(&network.clock, network.now_ns);
    run(1);
    CHECK_EQUAL(network.requests, requests + 1);
    CHECK_EQUAL(error(), 0);
}

TEST(answers_that_cannot_be_right_are_ignored)
{
    begin(0, 0);
    for (int i = 0; i < 2 * EPG_CLOCK_ANSWERS; i++) {
        epg_clock_answer(&network.clock, EPOCH, network.now_ns, 2 * SECOND + 1);
        epg_clock_answer(&network.clock, 0, network.now_ns, MS);
        epg_clock_answer(&network.clock, UINT64_MAX, network.now_ns, MS);
        epg_clock_answer(&network.clock, (UINT64_C(1) << 31) * SECOND, network.now_ns, MS);
    }
    CHECK(!network.clock.set);
    for (int i = 0; i < EPG_CLOCK_ANSWERS; i++) {
        epg_clock_answer(&network.clock, 1, network.now_ns, 0); /* the agent's computer does not know the time either */
    }
    CHECK_EQUAL(stamp(network.now_ns), 1);
    CHECK_EQUAL(stamp(network.now_ns - SECOND), 0); /* not before 1970 */
}

TEST(simulated_time_is_the_stamp)
{
    begin(0, 0);
    epg_clock_start(&network.clock, true);
    epg_clock_connected(&network.clock, 0);
    CHECK(!epg_clock_poll(&network.clock, SECOND, false));
    for (int i = 0; i < EPG_CLOCK_ANSWERS; i++) {
        epg_clock_answer(&network.clock, EPOCH, network.now_ns, 0);
    }
    CHECK_EQUAL(stamp(7), 7);
    CHECK_EQUAL(stamp(network.now_ns + 7), network.now_ns + 7);
}

RUN()
