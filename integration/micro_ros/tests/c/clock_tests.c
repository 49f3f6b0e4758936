/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The agent's time by libmicroros: answers that come late, or never.
 *
 * The library of this test treats answers as eProsima's client does: each one that arrives sets the offset, by the
 * instant of its own question, and ends the wait for any question.  Answers arrive in the order of their questions.
 */
#include "micro_ros_clock.h"

#include <rmw_microros/rmw_microros.h>

#include "check.h"
#include "fake_port.h"

#define MS UINT64_C(1000000)
#define EPOCH (UINT64_C(1700000000) * 1000 * MS)

enum { QUESTIONS = 256 };

static struct {
    epg_clock_t clock;
    epg_micro_ros_question_t question;
    uint64_t usual_ms;               /* round trip of a question */
    uint64_t first_ms;               /* that of the first one; 0: it has no answer */
    bool slow_there;                 /* all of the round trip is the way to the agent */
    uint64_t asked_ns[QUESTIONS];    /* of each question */
    uint64_t answered_ns[QUESTIONS]; /* when its answer arrives; UINT64_MAX: it has arrived, or never will */
    unsigned int questions;
    bool synchronised;
    int64_t offset_ns;
} network;

static void take_answers(void)
{
    for (unsigned int i = 0; i < network.questions; i++) {
        if (network.answered_ns[i] <= fake_port.now_ns) {
            const uint64_t took_ns = network.answered_ns[i] - network.asked_ns[i];
            const uint64_t agent_ns = EPOCH + network.asked_ns[i] + (network.slow_there ? took_ns : took_ns / 2);
            network.offset_ns = (int64_t)(network.asked_ns[i] + fake_port.now_ns) / 2 - (int64_t)agent_ns;
            network.synchronised = true;
            network.answered_ns[i] = UINT64_MAX;
        }
    }
}

static void wait_a_millisecond(void)
{
    fake_port.now_ns += MS;
    take_answers();
}

rmw_ret_t rmw_uros_sync_session(int timeout_ms)
{
    const unsigned int number = network.questions++;
    const uint64_t took_ms = number == 0 ? network.first_ms : network.usual_ms;
    CHECK(number < QUESTIONS);
    network.asked_ns[number] = fake_port.now_ns;
    network.answered_ns[number] = took_ms > 0 ? fake_port.now_ns + took_ms * MS : UINT64_MAX;
    network.synchronised = false;
    for (int i = 0; i < timeout_ms && !network.synchronised; i++) {
        wait_a_millisecond();
    }
    return network.synchronised ? RMW_RET_OK : RMW_RET_ERROR;
}

bool rmw_uros_epoch_synchronized(void)
{
    return network.synchronised;
}

int64_t rmw_uros_epoch_nanos(void)
{
    return (int64_t)fake_port.now_ns - network.offset_ns;
}

static void begin(uint64_t first_ms, uint64_t usual_ms)
{
    memset(&network, 0, sizeof network);
    fake_port_reset();
    fake_port.now_ns = 5000 * MS;
    network.first_ms = first_ms;
    network.usual_ms = usual_ms;
    epg_clock_start(&network.clock, false);
    epg_clock_connected(&network.clock, fake_port.now_ns);
}

/** Returns the size of the error of a stamp. */
static uint64_t error(void)
{
    const uint64_t stamp_ns = epg_clock_stamp_ns(&network.clock, fake_port.now_ns);
    const uint64_t true_ns = EPOCH + fake_port.now_ns;
    return stamp_ns > true_ns ? stamp_ns - true_ns : true_ns - stamp_ns;
}

/** Polls for `milliseconds`.  The clock must never be further off than its uncertainty. */
static void run(unsigned int milliseconds)
{
    const uint64_t end_ns = fake_port.now_ns + milliseconds * MS;
    while (fake_port.now_ns < end_ns) {
        wait_a_millisecond();
        epg_micro_ros_clock_poll(&network.question, &network.clock, fake_port.now_ns, false);
        CHECK(!network.clock.set || error() <= network.clock.uncertainty_ns);
    }
}

TEST(fast_answers_set_the_clock)
{
    begin(4, 4);
    run(200);
    CHECK(network.clock.set);
    CHECK_EQUAL(error(), 0);
    CHECK_EQUAL(network.clock.uncertainty_ns, 2 * MS);
}

TEST(a_late_answer_is_not_that_of_the_next_question)
{
    for (uint64_t first_ms = 40; first_ms < 1010; first_ms++) {
        begin(first_ms, 4);
        network.slow_there = true;
        run(3000);
        CHECK(network.clock.set);
        CHECK_EQUAL(error(), network.clock.uncertainty_ns); /* half of the true round trip */
        CHECK(first_ms > 990 || error() == 2 * MS);
    }
}

TEST(late_answers_set_the_clock_with_their_own_round_trips)
{
    begin(80, 80);
    run(1000);
    CHECK(network.clock.set);
    CHECK_EQUAL(network.clock.uncertainty_ns, 40 * MS);
    CHECK_EQUAL(error(), 0);
}

TEST(a_question_without_an_answer_is_given_up_after_a_second)
{
    begin(0, 4);
    run(990);
    CHECK_EQUAL(network.questions, 1);
    run(20);
    CHECK_EQUAL(network.questions, 2);
    run(1100);
    CHECK(network.clock.set);
    CHECK_EQUAL(error(), 0);
    CHECK_EQUAL(network.clock.uncertainty_ns, 2 * MS);
}

TEST(an_answer_to_the_session_before_is_not_that_of_the_next_question)
{
    begin(300, 4);
    network.slow_there = true;
    run(299); /* the answer comes 2 ms later */
    network.synchronised = false;
    epg_clock_connected(&network.clock, fake_port.now_ns);
    run(1000);
    CHECK(network.clock.set);
    CHECK_EQUAL(error(), 2 * MS);
    CHECK_EQUAL(network.clock.uncertainty_ns, 2 * MS);
}

RUN()
