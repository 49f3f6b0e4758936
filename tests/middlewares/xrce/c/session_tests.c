/**
 * @file
 * The middleware and eProsima's client against a minimal agent, in the clock of the test.
 */
#include "agent.h"
#include "check.h"
#include "epg/node.h"
#include "fake_application.h"
#include "fake_port.h"
#include "xrce.h"

enum { HISTORY = 4, MTU = 384, PERIOD_MS = 33, MS = 1000000 };
enum { OUTPUT, TIME, VALUES };
enum { DELETE = 0x03, DATA = 0x09, ACKNACK = 0x0A, HEARTBEAT = 0x0B };

static const uint8_t fields[] = {0};
static const epg_message_layout_t motion = {.fields = fields, .count = 6, .frame_id = ""};

/** One published value, one setpoint, and the topic that enables.  Tests of stamps have a second publication. */
static const epg_topic_t publications[] = {
    {.name = "kept", .message = &epg_message_float64, .size = 8, .depth = 10, .count = 1, .period_ns = PERIOD_MS * MS},
    {.name = "stamped",
     .message = &epg_message_twist_stamped,
     .layout = &motion,
     .size = 64,
     .qos = EPG_QOS_BEST_EFFORT,
     .depth = 1,
     .count = 1,
     .period_ns = PERIOD_MS * MS},
};
static const epg_topic_t subscriptions[] = {
    {.name = "command", .message = &epg_message_float64, .size = 8, .depth = 1, .count = 1},
    {.name = "~/enable", .message = &epg_message_bool, .size = 1, .depth = 1, .role = EPG_TOPIC_ENABLE, .count = 1},
};
static double values[VALUES];
static double monitor_values[VALUES];
static double monitor_buffers[4][VALUES];
static epg_exchange_t monitor_exchange = EPG_EXCHANGE(monitor_buffers);
static double received[1];
static epg_node_publication_t states[2];
static unsigned char buffer[64];
static epg_node_t node;
static uint8_t frame[MTU];
static uint8_t input[EPG_XRCE_HISTORY_SIZE(HISTORY, MTU)];
static uint8_t output[EPG_XRCE_HISTORY_SIZE(HISTORY, MTU)];
static uint8_t best_effort[MTU];
static const epg_xrce_options_t options = {
    .history = HISTORY,
    .input_frame = MTU,
    .output_frame = MTU,
    .received = frame,
    .input = input,
    .output = output,
    .best_effort = best_effort,
};
static epg_target_t target;

static void monitor(double *monitored)
{
    monitored[OUTPUT] = fake.output;
    memcpy(&monitored[TIME], &fake.control.time_ns, sizeof fake.control.time_ns);
}

static void start(void)
{
    fake_reset();
    agent_reset();
    fake.application.monitor = monitor;
    fake.application.monitor_count = VALUES;
    fake.application.monitor_values = monitor_values;
    fake.application.monitor_exchange = &monitor_exchange;
    fake_start();
    node = (epg_node_t){
        .values = values, .received = received, .publications = states, .buffer = buffer, .buffer_size = sizeof buffer};
    target = (epg_target_t){
        .control = &fake.control,
        .application = &fake.application,
        .node = "robot",
        .name_space = "/lab",
        .domain = EPG_DOMAIN_DEFAULT,
        .subscription_count = 2,
        .subscriptions = subscriptions,
        .publication_count = 1,
        .publications = publications,
        .middleware = &epg_xrce,
        .options = &options,
        .node_state = &node,
        .time_index = TIME,
    };
    fake_cycle();
    epg_xrce.start(&target, &agent_stream);
}

static uint64_t now_ms(void)
{
    return fake_port.now_ns / MS;
}

/** Runs a control cycle and a poll in each of `milliseconds`. */
static void run(unsigned int milliseconds)
{
    for (unsigned int i = 0; i < milliseconds; i++) {
        fake_cycle();
        epg_xrce.poll(fake_port.now_ns);
    }
}

static epg_xrce_state_t state(void)
{
    return epg_xrce_status().state;
}

/** Runs until the middleware is serving, at most 5 s; returns the milliseconds. */
static uint64_t connect(void)
{
    const uint64_t began = now_ms();
    while (state() != EPG_XRCE_RUNNING && now_ms() < began + 5000) {
        run(1);
    }
    CHECK(state() == EPG_XRCE_RUNNING);
    return now_ms() - began;
}

TEST(it_creates_all_and_publishes)
{
    start();
    CHECK(connect() <= 20);
    CHECK_EQUAL(agent.sessions, 1);
    CHECK_EQUAL(agent.created, 3 + 2 * 3); /* participant, publisher, subscriber; three topics and their ends */
    run(1);
    CHECK_EQUAL(agent.readers, 2);
    run(10 * PERIOD_MS);
    CHECK(agent.samples >= 10 && agent.samples <= 11);
    CHECK_EQUAL(agent.mtu, MTU);
    CHECK(agent.key != 0);
    CHECK_EQUAL(epg_xrce_status().connections, 1);
    CHECK_EQUAL(epg_xrce_status().lost, 0);
}

TEST(samples_are_setpoints)
{
    start();
    (void)connect();
    run(5);
    agent.reader[0] = 0x00; /* the first reader: number 1, a data reader */
    agent.reader[1] = 0x16;
    agent_publish(2.5);
    run(3);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 2.5);
}

TEST(without_an_agent_it_asks_less_and_less_often)
{
    static const uint64_t expected[] = {0, 200, 500, 950, 1450, 1950, 2450};
    size_t found = 0;
    start();
    agent.absent = true;
    const uint64_t began = fake_port.now_ns;
    run(2800);
    for (size_t i = 0; i < agent.sent_count; i++) {
        if (agent.sent[i].data[0] == 0x80) {
            const uint64_t after = (agent.sent[i].time_ns - began) / MS;
            CHECK(found < sizeof expected / sizeof expected[0]);
            CHECK(after >= expected[found] && after <= expected[found] + 5);
            found++;
        }
    }
    CHECK_EQUAL(found, sizeof expected / sizeof expected[0]);
    CHECK_EQUAL(agent_count(DELETE), found); /* each one first closes the older session */
    agent.absent = false;
    CHECK(connect() <= 520);
    CHECK_EQUAL(fake.control.reconnects, 0);
}

/** A sample for the topic that enables, whose reader is the last one. */
static void publish_enable(bool enable)
{
    const unsigned char payload[] = {agent.request[0], agent.request[1], agent.reader[0], agent.reader[1], enable};
    agent_say(true, DATA, payload, sizeof payload);
}

TEST(what_has_waited_in_a_busy_agent_does_not_enable)
{
    start();
    (void)connect();
    run(1500);
    publish_enable(false);
    run(1500);
    CHECK(!fake_status().enabled);
    agent.busy = true;
    run(1200);
    publish_enable(true);
    agent.busy = false;
    run(200);
    CHECK(!fake_status().enabled);
    publish_enable(false);
    run(1500);
    publish_enable(true);
    run(20);
    CHECK(!fake_status().enabled); /* that false came within a second after the silence */
    publish_enable(false);
    run(1500);
    publish_enable(true);
    run(20);
    CHECK(fake_status().enabled);
    CHECK_EQUAL(epg_xrce_status().lost, 0);
}

TEST(the_last_message_before_it_is_unplugged_acts)
{
    start();
    (void)connect();
    run(5);
    CHECK(fake_status().enabled);
    publish_enable(false);
    agent.unplugged = true;
    run(2);
    CHECK(!fake_status().enabled);
    CHECK(state() == EPG_XRCE_WAITING);
}

TEST(what_arrives_while_unplugged_does_not_act_later)
{
    start();
    (void)connect();
    run(5);
    agent.unplugged = true;
    run(2);
    publish_enable(false);
    run(2);
    CHECK_EQUAL(agent.waiting_count, 0);
    agent.unplugged = false;
    (void)connect();
    run(50);
    CHECK(fake_status().enabled);
}

TEST(nothing_is_sent_while_unplugged)
{
    start();
    agent.unplugged = true; /* the stream's write() checks it */
    run(3000);
    CHECK_EQUAL(agent.sent_count, 0);
    agent.unplugged = false;
    (void)connect();
    agent.unplugged = true;
    run(1);
    CHECK(state() == EPG_XRCE_WAITING);
    agent.unplugged = false;
    (void)connect();
    run(2);
    CHECK_EQUAL(atomic_load(&fake.control.reconnects), 1);
}

TEST(an_agent_that_was_restarted_is_noticed_by_the_next_ping)
{
    start();
    (void)connect();
    run(500);
    agent_restart();
    const uint64_t began = now_ms();
    while (state() == EPG_XRCE_RUNNING) {
        run(1);
    }
    CHECK(now_ms() - began <= 105);
    CHECK(connect() <= 20);
    CHECK_EQUAL(agent.sessions, 2);
}

TEST(a_silent_agent_is_lost_after_four_seconds)
{
    start();
    (void)connect();
    run(500);
    agent.absent = true;
    run(3880);
    CHECK(state() == EPG_XRCE_RUNNING);
    run(130);
    CHECK(state() == EPG_XRCE_WAITING);
    CHECK_EQUAL(epg_xrce_status().lost, 1);
}

TEST(an_agent_that_was_busy_for_four_seconds_is_not_lost)
{
    start();
    (void)connect();
    run(500);
    for (int i = 0; i < 3; i++) {
        const unsigned int samples = agent.samples;
        agent.busy = true;
        run(3850); /* also the streams stand still, which must not count */
        CHECK(state() == EPG_XRCE_RUNNING);
        agent.busy = false;
        run(100);
        CHECK(agent.samples > samples + HISTORY);
        run(2500);
        agent.sent_count = 0;
        agent.samples = 0;
    }
    CHECK_EQUAL(epg_xrce_status().lost, 0);
    CHECK_EQUAL(agent.sessions, 1);
}

TEST(an_agent_that_is_busy_while_it_creates_is_not_lost)
{
    start();
    for (int i = 0; i < 1000 && agent.created < 5; i++) {
        run(1);
    }
    CHECK_EQUAL(agent.created, 5);
    agent.busy = true;
    run(3850);
    agent.busy = false;
    CHECK(connect() <= 20);
    CHECK_EQUAL(epg_xrce_status().lost, 0);
    CHECK_EQUAL(agent.sessions, 1);
}

TEST(an_agent_that_is_silent_while_it_creates_is_lost)
{
    start();
    run(2);
    CHECK(state() == EPG_XRCE_CREATING);
    agent.absent = true;
    run(4010);
    CHECK(state() == EPG_XRCE_WAITING);
}

TEST(a_restarted_agent_is_noticed_by_its_first_answer_after_a_silence)
{
    start();
    (void)connect();
    run(500);
    agent.absent = true;
    run(2000);
    agent.absent = false;
    agent_restart();
    CHECK(state() == EPG_XRCE_RUNNING);
    run(105);
    (void)connect();
    run(2);
    CHECK_EQUAL(agent.sessions, 2);
    CHECK_EQUAL(atomic_load(&fake.control.reconnects), 1);
}

TEST(what_is_lost_is_asked_for_and_sent_again)
{
    start();
    (void)connect();
    run(100);
    const unsigned int samples = agent.samples;
    const unsigned int heartbeats = agent.heartbeats;
    agent.losing = 1;
    run(PERIOD_MS + 2); /* that frame is lost, and the next arrives too early */
    CHECK(agent.losing == 0);
    run(60);
    CHECK(agent.heartbeats > heartbeats);
    run(5 * PERIOD_MS);
    CHECK(agent.samples >= samples + 6);
    for (unsigned int i = 1; i < agent.samples; i++) {
        CHECK(agent.values[i] > agent.values[i - 1]); /* each sample once, in order */
    }
}

TEST(a_full_history_blocks_nothing_and_then_gives_the_newest_value)
{
    start();
    (void)connect();
    run(100);
    agent.loses_every = true;
    const size_t before = agent.sent_count;
    run(25 * PERIOD_MS); /* pings are answered: the board stays connected */
    CHECK(state() == EPG_XRCE_RUNNING);
    for (size_t i = before; i < agent.sent_count; i++) { /* however often each frame is sent */
        const unsigned char *data = agent.sent[i].data;
        CHECK(data[1] != 0x80 || (uint16_t)((data[2] | data[3] << 8) - agent.expected) < HISTORY);
    }
    CHECK(node.unsent >= 15);
    agent.loses_every = false;
    run(120);
    CHECK(agent.values[agent.samples - 1] >= fake.output - 2 * PERIOD_MS);
}

TEST(a_stream_that_stands_still_ends_the_session)
{
    start();
    (void)connect();
    run(100);
    agent.loses_every = true;
    run(1900);
    CHECK(state() == EPG_XRCE_RUNNING);
    run(300);
    CHECK(epg_xrce_status().lost >= 1);
    agent.loses_every = false;
    (void)connect();
}

TEST(late_acknowledgements_do_no_harm)
{
    start();
    (void)connect();
    const uint16_t old = agent.expected;
    run(10 * PERIOD_MS);
    for (int i = 0; i < 10; i++) {
        const unsigned int samples = agent.samples;
        const unsigned char payload[5] = {(unsigned char)(old & 0xFFU), (unsigned char)(old >> 8), 0, 0, 0x80};
        agent_say(false, ACKNACK, payload, sizeof payload);
        run(PERIOD_MS);
        CHECK(agent.samples > samples);
    }
    CHECK_EQUAL(epg_xrce_status().lost, 0);
}

TEST(numbers_that_no_agent_has_do_no_harm)
{
    start();
    (void)connect();
    run(50);
    for (unsigned int number = 0; number < 0x10000; number += 251) {
        const unsigned char heartbeat[5] = {0, 0, (unsigned char)(number & 0xFFU), (unsigned char)(number >> 8), 0x80};
        const unsigned char missing[5] = {(unsigned char)(number & 0xFFU), (unsigned char)(number >> 8), 0xFF, 0xFF,
                                          0x80};
        agent_say(false, HEARTBEAT, heartbeat, sizeof heartbeat);
        agent_say(false, ACKNACK, missing, sizeof missing);
        run(1);
    }
    if (state() != EPG_XRCE_RUNNING) {
        (void)connect(); /* it may connect again, and does */
    }
    const unsigned int samples = agent.samples;
    run(20 * PERIOD_MS);
    CHECK(agent.samples >= samples + 10);
}

TEST(a_fragment_is_left_out_and_the_stream_goes_on)
{
    unsigned char large[300] = {0};
    start();
    (void)connect();
    run(20);
    for (int i = 0; i < 20; i++) {
        agent_say(true, 0x0D, large, sizeof large);
        run(2);
    }
    agent.reader[0] = 0x00;
    agent.reader[1] = 0x16;
    agent_publish(1.5);
    run(3);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 1.5);
    CHECK_EQUAL(epg_xrce_status().lost, 0);
}

TEST(frames_of_other_sessions_are_dropped)
{
    static const unsigned char other[] = {0x82, 0, 0, 0, 0x0B, 1, 5, 0, 0, 0, 9, 0, 0x80};
    static const unsigned char stream[] = {0x81, 0x85, 0, 0, 0x09, 1, 12, 0, 0, 12, 0, 0x16, 0, 0, 0, 0, 0, 0, 0, 0};
    static const unsigned char endless[] = {0x81, 0, 0, 0, 0x0B, 1, 0xFF, 0xFF, 0, 0, 9, 0, 0x80};
    start();
    (void)connect();
    run(20);
    const uint32_t before = epg_xrce_status().dropped;
    agent_say_raw(other, sizeof other);
    agent_say_raw(stream, sizeof stream);
    agent_say_raw(endless, sizeof endless);
    agent_say_raw("x", 1);
    run(2);
    CHECK_EQUAL(epg_xrce_status().dropped - before, 4);
    CHECK(state() == EPG_XRCE_RUNNING);
}

TEST(a_refusal_is_followed_by_a_pause)
{
    start();
    agent.status = 0x80;
    run(1900);
    CHECK_EQUAL(epg_xrce_status().refused, 1);
    CHECK_EQUAL(agent.sessions, 1);
    run(200);
    CHECK_EQUAL(epg_xrce_status().refused, 2);
    agent.status = 0;
    CHECK(connect() <= 2050);
}

TEST(one_poll_does_a_bounded_amount_of_work)
{
    unsigned char noise[16] = {0};
    start();
    (void)connect();
    run(10);
    for (int i = 0; i < 60; i++) {
        agent_say(false, HEARTBEAT, noise, 5);
    }
    const size_t before = agent.read_count;
    run(1);
    CHECK(agent.read_count - before < 60);
}

TEST(without_room_nothing_is_half_sent)
{
    start();
    (void)connect();
    run(50);
    const unsigned int samples = agent.samples;
    agent.room = 24; /* the stream checks that nothing longer is written */
    run(10 * PERIOD_MS);
    CHECK_EQUAL(agent.samples, samples);
    CHECK(state() == EPG_XRCE_RUNNING);
    agent.room = 65507;
    run(2);
    CHECK_EQUAL(agent.samples, samples + 1);
}

/** Starts with a stamped topic, and an agent far away. */
static void start_stamped(uint64_t there_ms, uint64_t back_ms)
{
    start();
    target.publication_count = 2;
    agent.there_ns = there_ms * MS;
    agent.back_ns = back_ms * MS;
    agent.ahead_ns = UINT64_C(1700000000000) * MS;
    epg_xrce.start(&target, &agent_stream);
}

/** Runs for a longer time.  Returns the largest difference between a stamp and the agent's time at its sending. */
static uint64_t largest_error(unsigned int seconds)
{
    uint64_t largest_ns = 0;
    for (unsigned int i = 0; i < 10 * seconds; i++) {
        agent.sent_count = 0;
        agent.samples = 0;
        agent.stamp_count = 0;
        run(100);
        for (unsigned int j = 0; j < agent.stamp_count; j++) {
            const uint64_t right_ns = agent.stamps[j].time_ns + agent.ahead_ns;
            const uint64_t stamp_ns = agent.stamps[j].stamp_ns;
            const uint64_t error_ns = stamp_ns > right_ns ? stamp_ns - right_ns : right_ns - stamp_ns;
            largest_ns = error_ns > largest_ns ? error_ns : largest_ns;
        }
    }
    return largest_ns;
}

TEST(the_clock_is_the_agents_over_any_distance)
{
    static const uint64_t ways[][2] = {{5, 5}, {30, 30}, {150, 150}, {300, 300}, {10, 200}, {200, 10}};
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        const uint64_t asymmetry = ways[i][0] > ways[i][1] ? ways[i][0] - ways[i][1] : ways[i][1] - ways[i][0];
        start_stamped(ways[i][0], ways[i][1]);
        CHECK(largest_error(40) <= asymmetry * MS / 2); /* also of the first message */
        CHECK(state() == EPG_XRCE_RUNNING && agent.stamp_count > 0);
        CHECK_EQUAL(node.clock.uncertainty_ns, (ways[i][0] + ways[i][1]) * MS / 2);
        CHECK_EQUAL(node.clock.steps, 0);
        CHECK_EQUAL(epg_xrce_status().connections, 1);
    }
}

TEST(without_the_time_stamped_messages_wait_a_second_and_then_carry_0)
{
    start_stamped(0, 0);
    agent.mute_clock = true;
    (void)connect();
    run(980);
    CHECK(agent.samples >= 29); /* other topics do not wait */
    CHECK_EQUAL(agent.stamp_count, 0);
    run(100);
    CHECK(agent.stamp_count >= 3);
    for (unsigned int i = 0; i < agent.stamp_count; i++) {
        CHECK_EQUAL(agent.stamps[i].stamp_ns, 0);
    }
    agent.mute_clock = false;
    run(1200);
    CHECK(largest_error(20) <= MS / 2); /* an answer is read by the next poll */
}

TEST(an_agent_whose_clock_is_set_back_is_followed_by_one_step)
{
    start_stamped(5, 5);
    CHECK_EQUAL(largest_error(10), 0);
    agent.ahead_ns -= UINT64_C(3600000) * MS;
    CHECK(largest_error(11) <= UINT64_C(3600000) * MS);
    CHECK_EQUAL(largest_error(20), 0);
    CHECK_EQUAL(node.clock.steps, 1);
    CHECK_EQUAL(node.clock.step_ns, -3600000.0 * MS);
}

TEST(an_agent_of_another_computer_has_another_clock)
{
    start_stamped(5, 5);
    CHECK_EQUAL(largest_error(2), 0);
    agent_restart();
    agent.ahead_ns += 300 * MS;
    CHECK(largest_error(1) <= 300 * MS);
    const uint64_t before_ns = agent.stamps[agent.stamp_count - 1].stamp_ns;
    run(PERIOD_MS);
    CHECK(agent.stamps[agent.stamp_count - 1].stamp_ns > before_ns + PERIOD_MS * MS); /* faster */
    CHECK(agent.stamps[agent.stamp_count - 1].stamp_ns < before_ns + (PERIOD_MS + 2) * MS);
    (void)largest_error(9);
    CHECK_EQUAL(largest_error(1), 0);
    CHECK_EQUAL(node.clock.steps, 0);
}

TEST(it_takes_leave)
{
    start();
    (void)connect();
    const unsigned int before = agent.goodbyes;
    epg_xrce.stop();
    CHECK_EQUAL(agent.goodbyes, before + 1);
    CHECK(!agent.known && state() == EPG_XRCE_WAITING);
}

TEST(the_key_is_the_nodes)
{
    start();
    (void)connect();
    const uint32_t one = agent.key;
    start();
    target.node = "other";
    epg_xrce.start(&target, &agent_stream);
    (void)connect();
    CHECK(agent.key != one && agent.key != 0);
}

TEST(two_hundred_restarts)
{
    start();
    for (unsigned int i = 0; i < 200; i++) {
        (void)connect();
        run(37 + i % 90);
        agent_restart();
        agent.sent_count = 0;
        agent.samples = 0;
        run(150);
    }
    (void)connect();
    run(2);
    CHECK_EQUAL(atomic_load(&fake.control.reconnects), 200);
}

RUN()
