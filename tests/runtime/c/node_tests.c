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

enum { AT_PERIOD, AT_CYCLES, ON_CHANGE, ANSWER, DIAGNOSTICS, PUBLICATIONS };
enum { PAIR, ASKED, ENABLE, SUBSCRIPTIONS };
enum { OUTPUT, STEPS, TIME, VALUES };
enum { MS = 1000000 };

static const uint8_t two[] = {0, 1};
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
    CHECK(publication < PUBLICATIONS);
    if (!room) {
        return false;
    }
    sent[publication]++;
    last[publication] = epg_cdr_read_f64(&reader);
    if (publication == AT_CYCLES && sent[publication] <= sizeof cycle_values / sizeof cycle_values[0]) {
        cycle_values[sent[publication] - 1] = last[publication];
    }
    last_size = size;
    return true;
}

static void begin(void)
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
                            .publication_count = PUBLICATIONS,
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

/** Runs `count` cycles, with a poll after each. */
static void run(unsigned int count)
{
    for (unsigned int i = 0; i < count; i++) {
        fake_cycle();
        epg_node_poll(&node, fake_port.now_ns);
    }
}

TEST(each_publication_has_its_own_time)
{
    begin();
    epg_node_poll(&node, fake_port.now_ns);
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
        epg_node_poll(&node, fake_port.now_ns);
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
    epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(sent[AT_PERIOD], 1);
    CHECK_EQUAL(sent[ON_CHANGE], 1); /* a new subscriber has no value yet */
    epg_node_poll(&node, fake_port.now_ns);
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
    epg_node_receive(&node, PAIR, message, size, fake_port.now_ns);
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
    epg_node_receive(&node, PAIR, "1234567", 8, fake_port.now_ns);
    epg_node_receive(&node, ENABLE, "\7", 1, fake_port.now_ns);
    epg_node_receive(&node, PAIR, "", 0, fake_port.now_ns);
    epg_node_receive(&node, SUBSCRIPTIONS, "1234567", 8, fake_port.now_ns);
    CHECK_EQUAL(node.malformed, 3);
    run(2);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 0.0);
    CHECK(fake_status().enabled);
}

TEST(enabling_by_a_topic)
{
    begin();
    run(1);
    epg_node_receive(&node, ENABLE, "\0", 1, fake_port.now_ns);
    run(2);
    CHECK(!fake_status().enabled);
    epg_node_receive(&node, ENABLE, "\1", 1, fake_port.now_ns);
    run(2);
    CHECK(fake_status().enabled);
}

TEST(an_echo_goes_out_at_once_and_unchanged)
{
    const double number = 0.1;
    begin();
    epg_node_receive(&node, ASKED, &number, sizeof number, fake_port.now_ns);
    CHECK_EQUAL(sent[ANSWER], 1);
    CHECK_EQUAL(last[ANSWER], 0.1);
    room = false;
    epg_node_receive(&node, ASKED, &number, sizeof number, fake_port.now_ns);
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
    run(8);
    CHECK_EQUAL(node.time_ns, 7 * MS);
    epg_node_set_time(&node, UINT64_C(1700000000) * 1000000000U + 9 * MS, 9 * MS);
    CHECK_EQUAL(epg_diagnostics_write(&node, (epg_stamp_t){0}, buffer, sizeof buffer) > 0, true);
    run(15); /* diagnostics at 22 ms */
    CHECK_EQUAL(sent[DIAGNOSTICS], 1);
    epg_cdr_reader_t reader = {.data = buffer, .size = last_size};
    CHECK_EQUAL(epg_cdr_read_i32(&reader), 1700000000);
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 22 * MS);
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
    CHECK(strcmp(epg_cdr_read_string(&reader), "robot_E6616407E3A51B2C") == 0);
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
    epg_control_request(&fake.control, false);
    run(1);
    CHECK(strcmp(diagnosed("fault", diagnose(), &level), "none") == 0);
    CHECK_EQUAL(level, 1);
    epg_control_request(&fake.control, true);
    fake.state_error = NAN;
    run(2);
    CHECK(strcmp(diagnosed("faults", diagnose(), &level), "1") == 0);
    CHECK_EQUAL(level, 2);
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
    epg_node_receive(&node, PAIR, short_message, sizeof short_message, fake_port.now_ns);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled; malformed messages") == 0);
    CHECK_EQUAL(level, 1);
    run(CYCLES - 10);
    fake.control.statistics.setpoint_timeouts++;
    run(1);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled; setpoint timeouts; malformed messages") == 0);
    run(10);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "enabled; setpoint timeouts") == 0);
    CHECK_EQUAL(level, 1);
    epg_control_request(&fake.control, false);
    run(1);
    CHECK(strcmp(diagnosed("message", diagnose(), &level), "disabled") == 0);
    epg_control_request(&fake.control, true);
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
        epg_node_poll(&node, fake_port.now_ns);
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
    epg_node_poll(&node, fake_port.now_ns);
    fake_cycles(3);
    epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(sent[AT_CYCLES], 0);
    room = true;
    epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(sent[AT_CYCLES], 3);
    CHECK_EQUAL(cycle_values[0], 2); /* its own value, and not that of the newest cycle */
    CHECK_EQUAL(cycle_values[1], 4);
    CHECK_EQUAL(cycle_values[2], 7);
}

TEST(cycles_that_a_history_cannot_hold_are_counted)
{
    begin_with_history();
    fake_cycles(KEPT + 3);
    epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(node.unsent, 3);
    CHECK_EQUAL(sent[AT_CYCLES], 3); /* of cycles 1, 3 and 6; cycles 9 to 11 are lost */
    fake_cycles(3);
    epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(node.unsent, 3);
    CHECK_EQUAL(sent[AT_CYCLES], 4);
    fake_cycles(2 * KEPT); /* while it is not connected, nothing counts as lost */
    epg_node_connected(&node, fake_port.now_ns);
    epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(node.unsent, 3);
    CHECK_EQUAL(sent[AT_CYCLES], 4);
    fake_cycle();
    epg_node_poll(&node, fake_port.now_ns);
    CHECK_EQUAL(sent[AT_CYCLES], 5);
}

RUN(ENTRY(no_cycle_of_a_history_is_left_out), ENTRY(a_cycle_of_a_history_waits_for_room),
    ENTRY(cycles_that_a_history_cannot_hold_are_counted), ENTRY(each_publication_has_its_own_time),
    ENTRY(diagnostics_wait_for_a_call_without_values), ENTRY(diagnostics_wait_for_at_most_5_ms),
    ENTRY(a_late_poll_makes_nothing_up_and_moves_nothing), ENTRY(without_room_the_newest_values_wait),
    ENTRY(a_connection_begins_with_what_is_new), ENTRY(values_of_a_message_arrive_together),
    ENTRY(a_message_of_another_type_is_counted), ENTRY(enabling_by_a_topic),
    ENTRY(an_echo_goes_out_at_once_and_unchanged), ENTRY(topics_have_full_names),
    ENTRY(names_that_the_board_keeps_replace_those_of_the_firmware), ENTRY(stamps_are_of_the_control_cycle),
    ENTRY(diagnostics_tell_state_and_statistics), ENTRY(diagnostics_warn_for_five_seconds),
    ENTRY(diagnostics_fit_whatever_they_hold))
