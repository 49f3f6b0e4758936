/**
 * @file
 * Services of a node: one request at a time, its result after the control cycles, and replies in pieces.
 */
#include "epg/service.h"

#include "check.h"
#include "fake_application.h"
#include "fake_port.h"

enum { ENABLE, RESET, SERVICES };
enum { MS = 1000000 };

static const epg_service_t services[SERVICES] = {
    [ENABLE] = {.name = "~/enable", .kind = &epg_service_enable, .request_size = 8},
    [RESET] = {.name = "~/reset", .kind = &epg_service_reset, .request_size = 8},
};
static unsigned char request[8];
static epg_service_state_t state;
static const char *const components[] = {"a", "b", "c", "d", "e", "guard"};
static epg_node_t node;
static epg_target_t target;

static bool send_nothing(size_t publication, const void *data, size_t size)
{
    (void)publication;
    (void)data;
    (void)size;
    return true;
}

static void begin(void)
{
    fake_reset();
    fake_start();
    state = (epg_service_state_t){.request = request, .request_size = sizeof request};
    target = (epg_target_t){.control = &fake.control,
                            .application = &fake.application,
                            .node = "JIWY_node",
                            .name_space = "/robot1",
                            .component_count = sizeof components / sizeof components[0],
                            .components = components,
                            .node_state = &node,
                            .service_count = SERVICES,
                            .services = services,
                            .service_state = &state};
    node = (epg_node_t){0};
    epg_node_start(&node, &target, send_nothing);
}

static epg_service_result_t ask(size_t service, uint8_t data)
{
    epg_node_listen(&node);
    return epg_service_request(&node, service, &data, 1, fake_port.now_ns);
}

/** Runs cycles until the reply is ready, at most ten.  Returns their number. */
static unsigned int wait(void)
{
    unsigned int cycles = 0;
    while (!epg_service_poll(&node, fake_port.now_ns)) {
        CHECK(cycles++ < 10);
        fake_cycle();
    }
    return cycles;
}

/** Checks the reply of a SetBool or Trigger, reads it in pieces of every size, and ends the request. */
static void check_reply(bool success, const char *message)
{
    unsigned char whole[128];
    const size_t size = epg_service_reply_size(&node);
    CHECK(size <= sizeof whole);
    CHECK_EQUAL(epg_service_reply(&node, 0, whole, sizeof whole), size);
    epg_cdr_reader_t reader = {.data = whole, .size = size};
    CHECK_EQUAL(epg_cdr_read_u8(&reader), success ? 1 : 0);
    const char *text = epg_cdr_read_string(&reader);
    CHECK(text != NULL && strcmp(text, message) == 0);
    CHECK_EQUAL(reader.position, size);
    for (size_t step = 1; step <= size; step++) {
        for (size_t offset = 0; offset < size; offset += step) {
            unsigned char piece[sizeof whole + 1];
            const size_t expected = size - offset < step ? size - offset : step;
            piece[expected] = 0xA5;
            CHECK_EQUAL(epg_service_reply(&node, offset, piece, step), expected);
            CHECK(memcmp(piece, whole + offset, expected) == 0);
            CHECK_EQUAL(piece[expected], 0xA5);
        }
    }
    CHECK_EQUAL(epg_service_reply(&node, size, whole, 1), 0);
    epg_service_done(&node);
    CHECK(epg_service_idle(&node));
}

TEST(topics_of_a_service_have_the_names_of_ros)
{
    char name[64];
    begin();
    CHECK_EQUAL(epg_service_topic(&node, ENABLE, false, name, sizeof name), strlen(name));
    CHECK(strcmp(name, "rq/robot1/JIWY_node/enableRequest") == 0);
    CHECK_EQUAL(epg_service_topic(&node, RESET, true, name, sizeof name), strlen(name));
    CHECK(strcmp(name, "rr/robot1/JIWY_node/resetReply") == 0);
    const size_t size = strlen(name) + 1;
    CHECK_EQUAL(epg_service_topic(&node, RESET, true, name, size), size - 1);
    for (size_t small = 0; small < size; small++) {
        CHECK_EQUAL(epg_service_topic(&node, RESET, true, name, small), 0);
    }
}

TEST(enable_is_answered_when_the_target_is_enabled)
{
    begin();
    fake.application.enable_at_start = false;
    fake_start();
    fake_cycles(3);
    epg_node_listen(&node); /* a start counts as a stop: requests from before do not act */
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(ask(ENABLE, 1), EPG_SERVICE_TAKEN);
    CHECK(!epg_service_idle(&node));
    CHECK(wait() >= 2);
    CHECK(fake_status().enabled);
    check_reply(true, "enabled");
    CHECK_EQUAL(ask(ENABLE, 0), EPG_SERVICE_TAKEN);
    wait();
    CHECK(!fake_status().enabled);
    check_reply(true, "disabled");
}

TEST(enable_that_is_refused_names_the_fault_and_the_component)
{
    begin();
    fake_cycles(3);
    fake.fault = EPG_FAULT_FAIL_SAFE;
    fake_cycles(1);
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(ask(ENABLE, 1), EPG_SERVICE_TAKEN);
    wait();
    check_reply(false, "refused, stopped by fault: fault 'fail-safe' of guard");
}

TEST(a_request_that_was_read_before_a_stop_is_refused)
{
    begin();
    fake_cycles(3);
    epg_node_listen(&node);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(5);
    CHECK_EQUAL(ask(ENABLE, 1), EPG_SERVICE_TAKEN); /* it may have arrived before the stop */
    wait();
    check_reply(false, "refused, stopped by firmware");
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(ask(ENABLE, 1), EPG_SERVICE_TAKEN);
    wait();
    check_reply(true, "enabled");
}

TEST(a_request_that_a_later_one_has_overtaken_is_refused)
{
    begin();
    fake_cycles(3);
    epg_node_listen(&node);
    const unsigned char off = 0;
    CHECK(epg_service_is_stop(&node, ENABLE, &off, 1));
    CHECK(!epg_service_is_stop(&node, ENABLE, &off, 0));
    CHECK(!epg_service_is_stop(&node, RESET, &off, 1));
    epg_stop(&fake.control, EPG_STOP_SERVICE);
    state.overtaken = true;
    CHECK_EQUAL(ask(ENABLE, 1), EPG_SERVICE_TAKEN); /* it arrived before the request to disable */
    wait();
    check_reply(false, "refused, stopped by service");
    CHECK(!fake_status().enabled);
    CHECK(!state.overtaken);
}

TEST(a_request_that_has_stopped_the_target_while_it_waited_stops_it_once)
{
    begin();
    fake_cycles(3);
    epg_stop(&fake.control, EPG_STOP_SERVICE);
    fake_cycles(3);
    CHECK(!fake_status().enabled);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY); /* somebody else enables it after the stop */
    fake_cycles(5);
    CHECK(fake_status().enabled);
    state.stopped = true;
    CHECK_EQUAL(ask(ENABLE, 0), EPG_SERVICE_TAKEN);
    wait();
    check_reply(false, "it was enabled again");
    CHECK(fake_status().enabled);
    CHECK_EQUAL(ask(ENABLE, 0), EPG_SERVICE_TAKEN);
    wait();
    check_reply(true, "disabled");
}

TEST(reset_clears_a_fault_and_does_not_enable)
{
    begin();
    fake_cycles(3);
    fake.fault = EPG_FAULT_FAIL_SAFE;
    fake_cycles(1);
    CHECK_EQUAL(ask(RESET, 0), EPG_SERVICE_TAKEN);
    wait();
    check_reply(false, "the cause remains: fault 'fail-safe' of guard");
    fake.fault = EPG_FAULT_NONE;
    CHECK_EQUAL(epg_service_request(&node, RESET, NULL, 0, fake_port.now_ns), EPG_SERVICE_TAKEN);
    wait();
    check_reply(true, "disabled, without a fault");
    CHECK_EQUAL(fake_status().fault, EPG_FAULT_NONE);
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake.actuator, 0.0);
}

TEST(reset_does_not_disable)
{
    begin();
    fake_cycles(3);
    CHECK_EQUAL(ask(RESET, 0), EPG_SERVICE_TAKEN);
    wait();
    check_reply(true, "enabled");
    CHECK(fake_status().enabled);
}

TEST(a_second_request_is_busy)
{
    begin();
    fake_cycles(3);
    CHECK_EQUAL(ask(ENABLE, 0), EPG_SERVICE_TAKEN);
    CHECK_EQUAL(ask(ENABLE, 1), EPG_SERVICE_BUSY);
    CHECK_EQUAL(ask(RESET, 1), EPG_SERVICE_BUSY);
    wait();
    CHECK_EQUAL(ask(ENABLE, 1), EPG_SERVICE_BUSY); /* until its reply is sent */
    check_reply(true, "disabled");
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(node.malformed, 0);
}

TEST(malformed_requests_are_counted_and_change_nothing)
{
    const unsigned char large[9] = {1};
    begin();
    fake_cycles(3);
    CHECK_EQUAL(epg_service_request(&node, ENABLE, NULL, 0, 0), EPG_SERVICE_MALFORMED);
    CHECK_EQUAL(ask(ENABLE, 2), EPG_SERVICE_MALFORMED);
    CHECK_EQUAL(epg_service_request(&node, ENABLE, large, sizeof large, 0), EPG_SERVICE_MALFORMED);
    CHECK_EQUAL(node.malformed, 3);
    CHECK(epg_service_idle(&node));
    CHECK(!epg_service_poll(&node, fake_port.now_ns));
    fake_cycles(2);
    CHECK(fake_status().enabled);
}

TEST(a_loop_that_does_not_run_is_reported_after_half_a_second)
{
    begin();
    fake_cycles(3);
    CHECK_EQUAL(ask(ENABLE, 0), EPG_SERVICE_TAKEN);
    CHECK(!epg_service_poll(&node, fake_port.now_ns + 499U * MS));
    CHECK(epg_service_poll(&node, fake_port.now_ns + 501U * MS));
    check_reply(false, "the control loop does not run");
}

RUN()
