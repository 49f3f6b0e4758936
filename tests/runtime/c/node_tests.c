/**
 * @file
 * The node: due messages, received messages, names, diagnostics.
 */
#include "epg/node.h"

#include <math.h>

#include "check.h"
#include "epg/cdr.h"
#include "epg/diagnostics.h"
#include "epg/store.h"
#include "fake_application.h"
#include "fake_port.h"

enum { AT_PERIOD, AT_CYCLES, ON_CHANGE, ANSWER, DIAGNOSTICS, STATES, PUBLICATIONS };
enum { PAIR, ASKED, ENABLE, SUBSCRIPTIONS };
enum { OUTPUT, STEPS, TIME, VALUES };
enum { MS = 1000000 };

#define EPOCH (UINT64_C(1700000000) * 1000U * MS)

static const uint8_t two[] = {0, 1};
static const uint8_t speed[] = {0};
static const epg_message_layout_t motion = {.fields = speed, .count = 6, .frame_id = ""};
static const epg_message_layout_t pair = {.fields = two, .count = 2, .frame_id = ""};

static const epg_topic_t subscriptions[SUBSCRIPTIONS] = {
    [PAIR] = {.name = "pair", .message = &epg_message_float64_array, .layout = &pair, .count = 2},
    [ASKED] = {.name = "/ping", .message = &epg_message_float64, .role = EPG_TOPIC_ECHO, .index = ANSWER},
    [ENABLE] = {.name = "~/enable", .message = &epg_message_bool, .role = EPG_TOPIC_ENABLE, .count = 1},
};
static const epg_topic_t publications[PUBLICATIONS] = {
    [AT_PERIOD] = {.name = "period", .message = &epg_message_float64, .count = 1, .period_ns = 5 * MS},
    [AT_CYCLES] = {.name = "cycles",
                   .message = &epg_message_float64,
                   .trigger = EPG_TOPIC_CYCLES,
                   .cycles = 3,
                   .index = STEPS,
                   .count = 1},
    [ON_CHANGE] = {.name = "change", .message = &epg_message_float64, .trigger = EPG_TOPIC_CHANGE, .count = 1},
    [ANSWER] = {.name = "/pong", .message = &epg_message_float64, .role = EPG_TOPIC_ECHO},
    [DIAGNOSTICS] = {.name = "/diagnostics",
                     .message = &epg_message_diagnostic_array,
                     .role = EPG_TOPIC_DIAGNOSTICS,
                     .period_ns = 20 * MS},
    [STATES] = {.name = "states",
                .message = &epg_message_twist_stamped,
                .layout = &motion,
                .trigger = EPG_TOPIC_CYCLES,
                .cycles = 1,
                .index = STEPS,
                .count = 1},
};

static double node_values[VALUES];
static double sent_values[VALUES];
static double received[2];
static epg_node_publication_t states[PUBLICATIONS];
static unsigned char buffer[EPG_DIAGNOSTICS_SIZE];
static epg_node_t node;
static epg_target_t target;

static unsigned int sent[PUBLICATIONS];
static double last[PUBLICATIONS]; /* value in the last message */
static size_t last_size;
static uint64_t stamps[PUBLICATIONS]; /* stamp of the last message */
static bool room;

static double cycle_values[16]; /* values in the messages of AT_CYCLES */

static double monitor_values[VALUES];
static double monitor_buffers[4][VALUES];
static epg_exchange_t monitor_exchange = EPG_EXCHANGE(monitor_buffers);

static void monitor(double *values)
{
    values[OUTPUT] = floor(fake.output / 4.0); /* changes at every fourth cycle */
    values[STEPS] = fake.steps;
    memcpy(&values[TIME], &fake.control.time_ns, sizeof fake.control.time_ns);
}

static bool send_message(size_t publication, const void *data, size_t size)
{
    epg_cdr_reader_t reader = {.data = data, .size = size};
    epg_cdr_reader_t stamp = {.data = data, .size = size};
    CHECK(publication < PUBLICATIONS);
    if (!room) {
        return false;
    }
    sent[publication]++;
    last[publication] = epg_cdr_read_f64(&reader);
    stamps[publication] = (uint64_t)epg_cdr_read_i32(&stamp) * 1000U * MS;
    stamps[publication] += epg_cdr_read_u32(&stamp);
    if (publication == AT_CYCLES && sent[publication] <= sizeof cycle_values / sizeof cycle_values[0]) {
        cycle_values[sent[publication] - 1] = last[publication];
    }
    last_size = size;
    return true;
}

/** Sets the clock as a middleware does: it was EPOCH when the board's time was 0. */
static void set_clock(void)
{
    for (int i = 0; i < EPG_CLOCK_ANSWERS; i++) {
        epg_clock_answer(&node.clock, EPOCH + fake_port.now_ns, fake_port.now_ns, 3 * MS);
    }
}

/** A node that is connected, and whose clock is not set. */
static void begin_without_clock(void)
{
    fake_reset();
    fake.application.monitor = monitor;
    fake.application.monitor_count = VALUES;
    fake.application.monitor_values = monitor_values;
    fake.application.monitor_exchange = &monitor_exchange;
    fake_start();
    target = (epg_target_t){.control = &fake.control,
                            .application = &fake.application,
                            .node = "robot_$serial",
                            .name_space = "/fleet",
                            .subscription_count = SUBSCRIPTIONS,
                            .subscriptions = subscriptions,
                            .publication_count = STATES, /* all but this one */
                            .publications = publications,
                            .version = "1.2.3",
                            .hash = "0123456789abcdef",
                            .node_state = &node,
                            .time_index = TIME};
    node = (epg_node_t){.values = node_values,
                        .sent_values = sent_values,
                        .received = received,
                        .publications = states,
                        .buffer = buffer,
                        .buffer_size = sizeof buffer};
    memset(sent, 0, sizeof sent);
    room = true;
    epg_node_start(&node, &target, send_message);
    epg_node_connected(&node, fake_port.now_ns);
}

static void begin(void)
{
    begin_without_clock();
    set_clock();
}

/** Runs `count` cycles, with a poll after each. */
static void run(unsigned int count)
{
    for (unsigned int i = 0; i < count; i++) {
        fake_cycle();
        epg_node_listen(&node);
        (void)epg_node_poll(&node, fake_port.now_ns);
    }
}

TEST(each_publication_has_its_own_time)
{
    begin();
    (void)epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(sent[AT_PERIOD] + sent[AT_CYCLES] + sent[ON_CHANGE], 0); /* no cycle has run */
    run(30);
    CHECK_EQUAL(sent[AT_PERIOD], 6);  /* at 0, 5, ... 25 ms */
    CHECK_EQUAL(sent[AT_CYCLES], 10); /* cycles 0, 3, ... 27 */
    CHECK_EQUAL(last[AT_CYCLES], 28); /* number of steps; the first one is in cycle 0 */
    CHECK_EQUAL(sent[ON_CHANGE], 8);
    CHECK_EQUAL(sent[ANSWER], 0);
    CHECK_EQUAL(node.unsent, 0);
}

TEST(diagnostics_wait_for_a_call_without_values)
{
    begin();
    run(21); /* values are due at 20 ms, too */
    CHECK_EQUAL(sent[AT_PERIOD], 5);
    CHECK_EQUAL(sent[DIAGNOSTICS], 0);
    run(1); /* those of cycle 21 */
    CHECK_EQUAL(sent[AT_CYCLES], 8);
    CHECK_EQUAL(sent[DIAGNOSTICS], 0);
    run(1);
    CHECK_EQUAL(sent[DIAGNOSTICS], 1);
    CHECK_EQUAL(node.unsent, 0);
}

TEST(diagnostics_wait_for_at_most_5_ms)
{
    begin();
    for (unsigned int i = 0; i < 7; i++) {
        fake_cycles(4); /* each call has a value that has changed */
        (void)epg_node_poll(&node, fake_port.now_ns);
        CHECK_EQUAL(sent[ON_CHANGE], i + 1);
        CHECK_EQUAL(sent[DIAGNOSTICS], fake_port.now_ns < 25 * MS ? 0 : 1);
    }
    CHECK_EQUAL(sent[DIAGNOSTICS], 1);
    CHECK_EQUAL(node.unsent, 0);
}

TEST(a_late_poll_makes_nothing_up_and_moves_nothing)
{
    begin();
    run(2);
    fake_cycles(20); /* no poll for 20 ms */
    run(1);
    CHECK_EQUAL(sent[AT_PERIOD], 2);
    run(3); /* the next one is due at 25 ms */
    CHECK_EQUAL(sent[AT_PERIOD], 3);
}

TEST(without_room_the_newest_values_wait)
{
    begin();
    run(1);
    room = false;
    run(5); /* due at 5 ms */
    CHECK_EQUAL(sent[AT_PERIOD], 1);
    CHECK_EQUAL(states[AT_PERIOD].waiting, true);
    run(6); /* due again at 10 ms: the first message is lost */
    CHECK(node.unsent >= 1);
    room = true;
    run(1);
    CHECK_EQUAL(sent[AT_PERIOD], 2);
    CHECK_EQUAL(last[AT_PERIOD], floor(fake.output / 4.0));
}

TEST(a_connection_begins_with_what_is_new)
{
    begin();
    run(3);
    room = false;
    run(20);
    room = true;
    memset(sent, 0, sizeof sent);
    epg_node_connected(&node, fake_port.now_ns);
    (void)epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(sent[AT_PERIOD], 1);
    CHECK_EQUAL(sent[ON_CHANGE], 1); /* a new subscriber has no value yet */
    (void)epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(sent[DIAGNOSTICS], 1);
    CHECK_EQUAL(sent[AT_PERIOD] + sent[ON_CHANGE], 2);
}

static void receive_pair(double first, double second)
{
    unsigned char message[64];
    const double pair_values[] = {first, second};
    const epg_stamp_t none = {0};
    const size_t size =
        epg_message_float64_array.write(&subscriptions[PAIR], pair_values, none, message, sizeof message);
    epg_node_receive(&node, PAIR, message, size, 0, fake_port.now_ns);
}

TEST(values_of_a_message_arrive_together)
{
    begin();
    receive_pair(3.0, 4.0);
    run(1);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 3.0);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 1), 4.0);
    receive_pair(5.0, NAN);
    receive_pair(INFINITY, 6.0);
    run(1);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 3.0);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 1), 4.0);
    run(1);
    CHECK_EQUAL(fake_status().statistics.setpoints_dropped, 2);
    CHECK_EQUAL(node.malformed, 0);
}

TEST(a_message_of_another_type_is_counted)
{
    begin();
    epg_node_receive(&node, PAIR, "1234567", 8, 0, fake_port.now_ns);
    epg_node_receive(&node, ENABLE, "\7", 1, 0, fake_port.now_ns);
    epg_node_receive(&node, PAIR, "", 0, 0, fake_port.now_ns);
    epg_node_receive(&node, SUBSCRIPTIONS, "1234567", 8, 0, fake_port.now_ns);
    CHECK_EQUAL(node.malformed, 3);
    run(2);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 0.0);
    CHECK(fake_status().enabled);
}

/** Receives a message of the topic that enables the target, in a poll of its own. */
static void receive_enable(bool enable, uint32_t publisher)
{
    epg_node_listen(&node);
    epg_node_receive(&node, ENABLE, enable ? "\1" : "\0", 1, publisher, fake_port.now_ns);
}

static const char *advice(void)
{
    return node.edge.advice == NULL ? "" : node.edge.advice;
}

/** A node that has been connected for long. */
static void begin_topic(void)
{
    begin();
    run(1100);
    CHECK(fake_status().enabled);
}

static void receive_false_and_true_of(uint32_t first, uint32_t second)
{
    receive_enable(false, first);
    run(1500);
    receive_enable(true, second);
    run(3);
}

TEST(a_false_and_then_a_true_enable_again)
{
    begin_topic();
    receive_enable(false, 0);
    run(5);
    CHECK(!fake_status().enabled);
    CHECK(fake_status().stop_source == EPG_STOP_TOPIC);
    receive_enable(true, 0);
    run(1);
    CHECK(fake_status().enabled);
    CHECK_EQUAL(node.edge.ignored, 0);
    receive_enable(false, 0);
    run(1000);
    receive_enable(true, 0); /* a second time */
    run(1);
    CHECK(fake_status().enabled);
}

TEST(both_in_one_poll_enable_too)
{
    begin_topic();
    epg_node_listen(&node);
    epg_node_receive(&node, ENABLE, "\0", 1, 0, fake_port.now_ns);
    epg_node_receive(&node, ENABLE, "\1", 1, 0, fake_port.now_ns);
    run(1);
    CHECK(!fake_status().enabled);
    run(2);
    CHECK(fake_status().enabled);
}

TEST(a_true_alone_enables_nothing_and_clears_no_fault)
{
    begin_topic();
    fake.fault = EPG_FAULT_FAIL_SAFE;
    run(1);
    fake.fault = EPG_FAULT_NONE;
    receive_enable(true, 0);
    run(5);
    CHECK(!fake_status().enabled);
    CHECK(fake_status().fault == EPG_FAULT_FAIL_SAFE);
    CHECK_EQUAL(node.edge.ignored, 1);
    CHECK(strstr(advice(), "send false, then true") != NULL);
}

TEST(a_node_that_repeats_true_never_enables_after_the_false_of_another)
{
    for (uint32_t publisher = 0; publisher < 2; publisher++) { /* unnamed, named */
        begin_topic();
        for (int i = 0; i < 10; i++) {
            receive_enable(true, publisher);
            run(100);
        }
        CHECK(fake_status().enabled);
        receive_enable(false, 2 * publisher);
        for (int i = 0; i < 50; i++) {
            run(100);
            receive_enable(true, publisher);
            run(1);
            CHECK(!fake_status().enabled);
        }
        CHECK_EQUAL(node.edge.ignored, 50);
    }
}

TEST(a_named_node_that_repeats_true_slowly_does_not_enable_either)
{
    begin_topic();
    receive_enable(true, 1);
    receive_enable(false, 2);
    run(3000);
    receive_enable(true, 1);
    run(3);
    CHECK(!fake_status().enabled);
    CHECK(strstr(advice(), "its own node") != NULL);
    receive_false_and_true_of(3, 4); /* as `ros2 topic pub --once` twice: each is a node of its own */
    CHECK(fake_status().enabled);
    receive_false_and_true_of(1, 1);
    CHECK(fake_status().enabled);
}

TEST(as_many_nodes_as_there_is_room_for_are_told_apart)
{
    begin_topic();
    for (uint32_t publisher = 1; publisher <= EPG_NODE_PUBLISHERS; publisher++) {
        receive_enable(true, publisher);
    }
    for (uint32_t publisher = 1; publisher <= EPG_NODE_PUBLISHERS; publisher++) {
        receive_false_and_true_of(100, publisher);
        CHECK(!fake_status().enabled);
    }
    for (uint32_t publisher = 11; publisher < 20; publisher++) {
        receive_false_and_true_of(publisher, publisher);
        CHECK(fake_status().enabled);
    }
}

TEST(a_stop_or_a_fault_after_the_false_makes_the_true_void)
{
    for (int kind = 0; kind < 3; kind++) {
        begin_topic();
        receive_enable(false, 0);
        run(3);
        if (kind == 0) {
            epg_stop(&fake.control, EPG_STOP_SERVICE);
        } else if (kind == 1) {
            fake.fault = EPG_FAULT_FAIL_SAFE;
        } else {
            epg_node_connected(&node, fake_port.now_ns);
        }
        run(1);
        fake.fault = EPG_FAULT_NONE;
        receive_enable(true, 0);
        run(5);
        CHECK(!fake_status().enabled);
        CHECK_EQUAL(node.edge.ignored, 1);
    }
}

TEST(a_true_that_waited_when_a_stop_came_does_not_act)
{
    begin_topic();
    receive_enable(false, 0);
    run(3);
    epg_node_listen(&node);
    epg_stop(&fake.control, EPG_STOP_PROGRAM); /* after both had arrived, before they are read */
    epg_node_receive(&node, ENABLE, "\0", 1, 0, fake_port.now_ns);
    epg_node_receive(&node, ENABLE, "\1", 1, 0, fake_port.now_ns);
    run(10);
    CHECK(!fake_status().enabled);
}

TEST(a_false_that_may_have_waited_in_the_agent_stops_and_prepares_nothing)
{
    begin_topic();
    epg_node_connected(&node, fake_port.now_ns);
    run(500);
    receive_enable(false, 0);
    run(3);
    CHECK(!fake_status().enabled);
    receive_enable(true, 0);
    run(5);
    CHECK(!fake_status().enabled);
    CHECK(strstr(advice(), "within a second after the connection") != NULL);
}

TEST(an_echo_goes_out_at_once_and_unchanged)
{
    const double number = 0.1;
    begin();
    epg_node_receive(&node, ASKED, &number, sizeof number, 0, fake_port.now_ns);
    CHECK_EQUAL(sent[ANSWER], 1);
    CHECK_EQUAL(last[ANSWER], 0.1);
    room = false;
    epg_node_receive(&node, ASKED, &number, sizeof number, 0, fake_port.now_ns);
    CHECK_EQUAL(sent[ANSWER], 1);
    CHECK_EQUAL(node.unsent, 1);
}

TEST(topics_have_full_names)
{
    char name[EPG_NODE_TOPIC_SIZE];
    begin();
    CHECK(strcmp(node.name, "robot_E6616407E3A51B2C") == 0);
    CHECK_EQUAL(epg_node_topic(&node, &subscriptions[PAIR], name, sizeof name), strlen("/fleet/pair"));
    CHECK(strcmp(name, "/fleet/pair") == 0);
    CHECK(epg_node_topic(&node, &subscriptions[ASKED], name, sizeof name) > 0 && strcmp(name, "/ping") == 0);
    CHECK(epg_node_topic(&node, &subscriptions[ENABLE], name, sizeof name) > 0);
    CHECK(strcmp(name, "/fleet/robot_E6616407E3A51B2C/enable") == 0);
    CHECK_EQUAL(epg_node_topic(&node, &subscriptions[PAIR], name, strlen("/fleet/pair")), 0);
    CHECK_EQUAL(epg_node_topic(&node, &subscriptions[PAIR], name, strlen("/fleet/pair") + 1), strlen("/fleet/pair"));
    target.name_space = "";
    epg_node_start(&node, &target, send_message);
    CHECK(epg_node_topic(&node, &subscriptions[PAIR], name, sizeof name) > 0 && strcmp(name, "/pair") == 0);
}

TEST(names_that_the_board_keeps_replace_those_of_the_firmware)
{
    epg_store_t store = {.node = "kept_$serial", .name_space = "/lab"};
    char name[EPG_NODE_TOPIC_SIZE];
    begin();
    target.store = &store;
    epg_node_start(&node, &target, send_message);
    CHECK(strcmp(node.name, "kept_E6616407E3A51B2C") == 0);
    CHECK(epg_node_topic(&node, &subscriptions[PAIR], name, sizeof name) > 0 && strcmp(name, "/lab/pair") == 0);
    store.name_space[1] = '\0'; /* none */
    epg_node_start(&node, &target, send_message);
    CHECK(epg_node_topic(&node, &subscriptions[PAIR], name, sizeof name) > 0 && strcmp(name, "/pair") == 0);
}

TEST(stamps_are_of_the_control_cycle)
{
    begin();
    run(23); /* diagnostics at 22 ms */
    CHECK_EQUAL(sent[DIAGNOSTICS], 1);
    CHECK_EQUAL(stamps[DIAGNOSTICS] - EPOCH, 22 * MS);
}

TEST(topics_with_a_stamp_wait_for_the_clock)
{
    begin_without_clock();
    target.publication_count = PUBLICATIONS;
    epg_node_connected(&node, fake_port.now_ns);
    run(300);
    CHECK_EQUAL(sent[STATES] + sent[DIAGNOSTICS], 0);
    CHECK_EQUAL(sent[AT_PERIOD], 60);
    CHECK_EQUAL(sent[AT_CYCLES], 100);
    set_clock();
    run(1); /* a call in which the clock was set has enough work */
    CHECK_EQUAL(sent[STATES], 0);
    run(1);
    CHECK_EQUAL(sent[STATES], 1); /* of the newest cycle; the others are not made up for */
    CHECK_EQUAL(sent[DIAGNOSTICS], 0);
    CHECK_EQUAL(stamps[STATES] - EPOCH, 301 * MS);
    CHECK_EQUAL(node.unsent, 0);
    run(30); /* the first diagnostics only ask the control side for its state */
    CHECK_EQUAL(sent[STATES], 31);
    CHECK_EQUAL(sent[DIAGNOSTICS], 1);
}

TEST(topics_with_a_stamp_wait_for_at_most_a_second_and_then_carry_0)
{
    begin_without_clock();
    target.publication_count = PUBLICATIONS;
    epg_node_connected(&node, fake_port.now_ns);
    run(1000);
    CHECK_EQUAL(sent[STATES] + sent[DIAGNOSTICS], 0);
    stamps[STATES] = 1;
    run(30);
    CHECK_EQUAL(sent[STATES], 30);
    CHECK_EQUAL(sent[DIAGNOSTICS], 1);
    CHECK_EQUAL(stamps[STATES] + stamps[DIAGNOSTICS], 0);
    set_clock();
    run(1);
    CHECK_EQUAL(stamps[STATES] - EPOCH, 1030 * MS);
    epg_node_connected(&node, fake_port.now_ns); /* the clock stays set, so no topic waits again */
    run(1);
    CHECK_EQUAL(sent[STATES], 32);
}

/** Reads the message in `buffer`; returns the value of `key`, and for "message" the text beside the level. */
static const char *diagnosed(const char *key, size_t size, uint8_t *level)
{
    epg_cdr_reader_t reader = {.data = buffer, .size = size};
    const char *found = NULL;
    (void)epg_cdr_read_i32(&reader);
    (void)epg_cdr_read_u32(&reader);
    CHECK(strcmp(epg_cdr_read_string(&reader), "") == 0);
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 1);
    *level = epg_cdr_read_u8(&reader);
    CHECK(strcmp(epg_cdr_read_string(&reader), "fleet/robot_E6616407E3A51B2C") == 0);
    const char *message = epg_cdr_read_string(&reader);
    CHECK(message != NULL);
    CHECK(strcmp(epg_cdr_read_string(&reader), "E6616407E3A51B2C") == 0);
    const uint32_t count = epg_cdr_read_u32(&reader);
    for (uint32_t i = 0; i < count; i++) {
        const char *name = epg_cdr_read_string(&reader);
        const char *value = epg_cdr_read_string(&reader);
        CHECK(name != NULL && value != NULL);
        found = strcmp(name, key) == 0 ? value : found;
    }
    CHECK(!reader.failed && reader.position == size);
    return strcmp(key, "message") == 0 ? message : found == NULL ? "" : found;
}

static size_t diagnose(void)
{
    return epg_diagnostics_write(&node, (epg_stamp_t){0}, buffer, sizeof buffer);
}

TEST(a_message_with_a_value_outside_of_its_limits_is_dropped)
{
    uint8_t level;
    begin();
    fake.setpoints[1] = (epg_setpoint_t){.minimum = -1.2, .maximum = 1.2, .guard = EPG_NO_COMPONENT};
    run(1);
    (void)diagnose(); /* the first call asks for the status of the next cycle */
    run(1);
    CHECK(strcmp(diagnosed("setpoint_refused", diagnose(), &level), "") == 0);
    receive_pair(3.0, 1.2);
    receive_pair(5.0, 1.25);
    receive_pair(6.0, -1e9);
    run(2);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 3.0);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 1), 1.2);
    CHECK(strcmp(diagnosed("setpoints_dropped", diagnose(), &level), "2") == 0);
    CHECK(strcmp(diagnosed("setpoint_refused", diagnose(), &level), epg_target_setpoint(&target, 1)) == 0);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled; refused setpoints") == 0);
    CHECK_EQUAL(level, 1);
}

TEST(diagnostics_tell_state_and_statistics)
{
    uint8_t level;
    begin();
    CHECK_EQUAL(diagnose(), 0); /* no cycle has run */
    run(5);
    CHECK(strcmp(diagnosed("cycles", diagnose(), &level), "5") == 0);
    CHECK_EQUAL(level, 0);
    node.malformed = UINT32_MAX;
    node.unsent = 1020;
    CHECK(strcmp(diagnosed("malformed", diagnose(), &level), "4294967295") == 0);
    CHECK(strcmp(diagnosed("unsent", diagnose(), &level), "1020") == 0);
    CHECK(strcmp(diagnosed("firmware", diagnose(), &level), "0123456789abcdef") == 0);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    run(1);
    CHECK(strcmp(diagnosed("fault", diagnose(), &level), "none") == 0);
    CHECK_EQUAL(level, 1);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake.state_error = NAN;
    run(2);
    CHECK(strcmp(diagnosed("faults", diagnose(), &level), "1") == 0);
    CHECK_EQUAL(level, 2);
}

TEST(diagnostics_tell_how_long_ago_a_target_was_stopped_only_if_it_was)
{
    uint8_t level;
    begin();
    (void)diagnose();
    run(50);
    CHECK(strcmp(diagnosed("stops", diagnose(), &level), "0") == 0);
    CHECK(strcmp(diagnosed("stopped_by", diagnose(), &level), "start") == 0);
    CHECK(strcmp(diagnosed("stopped_ms_ago", diagnose(), &level), "") == 0);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    run(8);
    CHECK(strcmp(diagnosed("stops", diagnose(), &level), "1") == 0);
    CHECK(strcmp(diagnosed("stopped_by", diagnose(), &level), "firmware") == 0);
    CHECK(strcmp(diagnosed("stopped_ms_ago", diagnose(), &level), "7") == 0);
}

TEST(diagnostics_tell_about_the_clock)
{
    uint8_t level;
    begin_without_clock();
    (void)diagnose();
    run(2);
    CHECK(strcmp(diagnosed("clock", diagnose(), &level), "not set") == 0);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled; clock not set") == 0);
    CHECK_EQUAL(level, 1);
    set_clock();
    CHECK(strcmp(diagnosed("clock", diagnose(), &level), "set") == 0);
    CHECK(strcmp(diagnosed("clock_uncertainty_ns", diagnose(), &level), "1500000") == 0);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled") == 0);
    CHECK_EQUAL(level, 0);
    for (int i = 0; i < EPG_CLOCK_ANSWERS; i++) { /* an hour back */
        epg_clock_answer(&node.clock, EPOCH - UINT64_C(3600000) * MS + fake_port.now_ns, fake_port.now_ns, MS);
    }
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled; step of the clock") == 0);
    CHECK_EQUAL(level, 1);
    CHECK(strcmp(diagnosed("clock_steps", diagnose(), &level), "1") == 0);
    CHECK(strcmp(diagnosed("clock_step_ms", diagnose(), &level), "-3600000") == 0);
    run(5001);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled") == 0);
}

TEST(diagnostics_warn_for_five_seconds)
{
    enum { CYCLES = 5001 };
    uint8_t level;
    begin();
    run(5);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled") == 0);
    CHECK_EQUAL(level, 0);
    const unsigned char short_message[2] = {0};
    epg_node_receive(&node, PAIR, short_message, sizeof short_message, 0, fake_port.now_ns);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled; malformed messages") == 0);
    CHECK_EQUAL(level, 1);
    run(CYCLES - 10);
    fake.control.statistics.setpoint_timeouts++;
    run(1);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled; setpoint timeouts; malformed messages") == 0);
    run(10);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled; setpoint timeouts") == 0);
    CHECK_EQUAL(level, 1);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    run(1);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "disabled") == 0);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    run(CYCLES);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled") == 0);
    CHECK_EQUAL(level, 0);
}

TEST(diagnostics_fit_whatever_they_hold)
{
    static char component[64];
    static const char *components[1] = {component};
    memset(component, 'c', sizeof component - 1);
    begin();
    run(2);
    memset(node.name, 'n', sizeof node.name - 1);
    memset(node.name_space, 's', sizeof node.name_space - 1);
    node.name_space[0] = '/';
    node.edge.advice = "the false came within a second after the connection: send false, then true";
    node.client_advice = "a client of another RMW gets no reply: run it with RMW_IMPLEMENTATION=rmw_cyclonedds_cpp";
    target.components = components;
    target.component_count = 1;
    target.version = "12.34.56.dev789+g0123456789";
    fake.control.statistics = (epg_statistics_t){
        .cycles = UINT32_MAX,
        .overruns = UINT32_MAX,
        .missed = UINT32_MAX,
        .lateness_max = UINT32_MAX,
        .computation_min = UINT32_MAX,
        .computation_total = UINT64_MAX,
        .computation_max = UINT32_MAX,
        .clamped = UINT32_MAX,
        .setpoints_dropped = UINT32_MAX,
        .setpoint_timeouts = UINT32_MAX,
        .faults = UINT32_MAX,
        .reconnects = UINT32_MAX,
    };
    epg_control_fault(&fake.control, EPG_FAULT_FAIL_SAFE, 0);
    fake_cycle();
    node.unsent = UINT32_MAX;
    node.malformed = UINT32_MAX;
    node.clock = (epg_clock_t){.uncertainty_ns = UINT32_MAX, .steps = UINT32_MAX, .step_ns = INT64_MIN};
    static char setpoint[300];
    memset(setpoint, 's', sizeof setpoint - 1);
    target.subscriptions = &(const epg_topic_t){.name = setpoint, .count = 1};
    target.subscription_count = 1;
    fake.control.refused = 1;
    const size_t size = diagnose();
    CHECK(size > 600);
    CHECK(size + 64 - strlen(epg_port_serial()) + 32 <=
          EPG_DIAGNOSTICS_SIZE); /* serial number and fault are short here */
}

enum { KEPT = 8 };
static double history_values[KEPT][VALUES];
static epg_history_t history = {.values = history_values[0], .count = VALUES, .depth = KEPT};

/** As begin(), with a history, and connected after cycle 0: AT_CYCLES is due in cycles 1, 3, 6, 9, ... */
static void begin_with_history(void)
{
    begin();
    epg_history_clear(&history);
    fake.application.history = &history;
    fake_cycle();
    epg_node_connected(&node, fake_port.now_ns);
}

TEST(no_cycle_of_a_history_is_left_out)
{
    begin_with_history();
    for (int i = 0; i < 4; i++) {
        fake_cycles(6); /* between two calls, two cycles in which the publication is due */
        (void)epg_node_poll(&node, fake_port.now_ns);
    }
    CHECK_EQUAL(sent[AT_CYCLES], 9);
    CHECK_EQUAL(cycle_values[0], 2);
    for (int i = 1; i < 9; i++) {
        CHECK_EQUAL(cycle_values[i], 1 + 3 * i);
    }
    CHECK_EQUAL(sent[AT_PERIOD], 4); /* the others publish the newest cycle */
    CHECK_EQUAL(node.unsent, 0);
}

TEST(a_cycle_of_a_history_waits_for_room)
{
    begin_with_history();
    room = false;
    fake_cycles(3);
    (void)epg_node_poll(&node, fake_port.now_ns);
    fake_cycles(3);
    (void)epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(sent[AT_CYCLES], 0);
    room = true;
    (void)epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(sent[AT_CYCLES], 3);
    CHECK_EQUAL(cycle_values[0], 2); /* its own value, and not that of the newest cycle */
    CHECK_EQUAL(cycle_values[1], 4);
    CHECK_EQUAL(cycle_values[2], 7);
}

TEST(cycles_that_a_history_cannot_hold_are_counted)
{
    begin_with_history();
    fake_cycles(KEPT + 3);
    (void)epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(node.unsent, 3);
    CHECK_EQUAL(sent[AT_CYCLES], 3); /* of cycles 1, 3 and 6; cycles 9 to 11 are lost */
    fake_cycles(3);
    (void)epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(node.unsent, 3);
    CHECK_EQUAL(sent[AT_CYCLES], 4);
    fake_cycles(2 * KEPT); /* while it is not connected, nothing counts as lost */
    epg_node_connected(&node, fake_port.now_ns);
    (void)epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(node.unsent, 3);
    CHECK_EQUAL(sent[AT_CYCLES], 4);
    fake_cycle();
    (void)epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(sent[AT_CYCLES], 5);
}

RUN()
