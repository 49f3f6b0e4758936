/**
 * @file
 * Parameters as those of a ROS 2 node: requests of every shape, replies in pieces, changes in one cycle, events.
 */
#include "epg/parameter_services.h"

#include <math.h>
#include <string.h>

#include "check.h"
#include "epg/cdr.h"
#include "epg/store.h"
#include "fake_application.h"
#include "fake_port.h"

enum { KP, TAU, A, B, COUNT };
enum { LIST, GET, TYPES, DESCRIBE, SET, ATOMIC, STORE, SERVICES };
enum { INTEGER = 2, DOUBLE = 3, STRING = 4, REQUEST = 1200, REPLY = 1024, MS = 1000000 };

static const epg_service_t services[SERVICES] = {
    [LIST] = {.name = "~/list_parameters", .kind = &epg_service_list_parameters, .request_size = 256},
    [GET] = {.name = "~/get_parameters", .kind = &epg_service_get_parameters, .request_size = 256},
    [TYPES] = {.name = "~/get_parameter_types", .kind = &epg_service_get_parameter_types, .request_size = 256},
    [DESCRIBE] = {.name = "~/describe_parameters", .kind = &epg_service_describe_parameters, .request_size = 256},
    [SET] = {.name = "~/set_parameters", .kind = &epg_service_set_parameters, .request_size = REQUEST},
    [ATOMIC] = {.name = "~/atomically", .kind = &epg_service_set_parameters_atomically, .request_size = REQUEST},
    [STORE] = {.name = "~/store_parameters", .kind = &epg_service_store_parameters, .request_size = 8},
};
static const epg_parameter_t table[COUNT] = {
    {"Pan\\PID\\kp", "", 2.6}, {"Pan\\PID\\tauD", "s", 0.05}, {"Tilt\\a", "", 1.0}, {"b", "", 2.0}};
static const epg_parameter_text_t texts[COUNT] = {
    {"Pan.PID.kp", "gain"}, {"Pan.PID.tauD", "[s]"}, {"Tilt.a", ""}, {"b", ""}};
static const epg_parameter_limits_t limits[COUNT] = {
    {0.0, 10.0}, {0.0, INFINITY}, {-INFINITY, INFINITY}, {-INFINITY, INFINITY}};

static double model[COUNT];
static unsigned int sets;
static unsigned int steps_at_set;
static double values[COUNT];
static double applied[COUNT];
static double copy[COUNT];
static bool wanted[COUNT];
static bool changed[COUNT];
static uint8_t news[COUNT];
static epg_parameters_t parameters;
static unsigned char store_bytes[EPG_STORE_SIZE(COUNT)];
static epg_store_t store;
static unsigned char request[REQUEST];
static epg_service_state_t state;
static epg_node_publication_t publication;
static double node_values[4];
static unsigned char node_buffer[512];
static epg_node_t node;
static epg_target_t target;

static const epg_parameter_event_t event = {.node = &node, .publication = &publication};
static const epg_topic_t publications[] = {{.name = "/parameter_events",
                                            .message = &epg_message_parameter_event,
                                            .layout = &event,
                                            .role = EPG_TOPIC_PARAMETERS,
                                            .period_ns = 5 * MS}};

static bool room;
static unsigned int sent;
static unsigned char last[sizeof node_buffer];
static size_t last_size;

static bool send_message(size_t index, const void *data, size_t size)
{
    CHECK_EQUAL(index, 0);
    if (room) {
        memcpy(last, data, size);
        last_size = size;
        sent++;
    }
    return room;
}

static void set(const double *new_values, const bool *which)
{
    for (size_t i = 0; i < COUNT; i++) {
        model[i] = which[i] ? new_values[i] : model[i];
    }
    sets++;
    steps_at_set = fake.steps;
}

static void begin(void)
{
    fake_reset();
    for (size_t i = 0; i < COUNT; i++) {
        model[i] = table[i].value;
        news[i] = EPG_PARAMETER_TOLD;
    }
    sets = 0;
    parameters = (epg_parameters_t){.count = COUNT,
                                    .table = table,
                                    .limits = limits,
                                    .model = 1,
                                    .set = set,
                                    .values = values,
                                    .wanted = wanted,
                                    .applied = applied,
                                    .changed = changed,
                                    .news = news};
    store = (epg_store_t){.bytes = store_bytes, .parameters = &parameters};
    epg_store_load(&store);
    fake.application.parameters = &parameters;
    fake_start();
    state = (epg_service_state_t){.request = request, .request_size = sizeof request, .texts = texts, .copy = copy};
    target = (epg_target_t){.control = &fake.control,
                            .application = &fake.application,
                            .node = "JIWY_node",
                            .name_space = "/robot1",
                            .publication_count = 1,
                            .publications = publications,
                            .store = &store,
                            .node_state = &node,
                            .service_count = SERVICES,
                            .services = services,
                            .service_state = &state};
    node = (epg_node_t){
        .values = node_values, .publications = &publication, .buffer = node_buffer, .buffer_size = sizeof node_buffer};
    room = true;
    sent = 0;
    epg_node_start(&node, &target, send_message);
    for (int i = 0; i < EPG_CLOCK_ANSWERS; i++) { /* messages with a stamp do not wait for the clock */
        epg_clock_answer(&node.clock, UINT64_C(1700000000000000000), fake_port.now_ns, 0);
    }
    epg_node_connected(&node, fake_port.now_ns);
    fake_cycles(3);
}

/* Requests ----------------------------------------------------------------------------------------------------- */

static unsigned char asked[2 * REQUEST];
static epg_cdr_writer_t writer;

/** Begins a request with a sequence of `count` elements. */
static void write_count(uint32_t count)
{
    memset(asked, 0xEE, sizeof asked);
    writer = (epg_cdr_writer_t){.data = asked, .size = sizeof asked};
    epg_cdr_write_u32(&writer, count);
}

static void write_names(uint32_t count, const char *const *names)
{
    write_count(count);
    for (uint32_t i = 0; i < count; i++) {
        epg_cdr_write_string(&writer, names[i]);
    }
}

/** Writes a parameter whose value also has a text and arrays, which must be passed over. */
static void write_parameter(const char *name, uint8_t type, double value)
{
    epg_cdr_write_string(&writer, name);
    epg_cdr_write_u8(&writer, type);
    epg_cdr_write_u8(&writer, 1);
    const int64_t integer = type == INTEGER ? (int64_t)value : INT64_MIN; /* the value of another type is not used */
    double bits;
    memcpy(&bits, &integer, sizeof bits);
    epg_cdr_write_f64(&writer, bits);
    epg_cdr_write_f64(&writer, type == INTEGER ? -1e300 : value);
    epg_cdr_write_string(&writer, "text");
    epg_cdr_write_u32(&writer, 1); /* bytes */
    epg_cdr_write_u8(&writer, 7);
    epg_cdr_write_u32(&writer, 0); /* booleans */
    epg_cdr_write_u32(&writer, 1); /* integers */
    epg_cdr_write_f64(&writer, 1.0);
    epg_cdr_write_u32(&writer, 0); /* doubles */
    epg_cdr_write_u32(&writer, 1); /* texts */
    epg_cdr_write_string(&writer, "more");
}

static epg_service_result_t send_request(size_t service)
{
    CHECK(!writer.failed);
    return epg_service_request(&node, service, asked, writer.length, fake_port.now_ns);
}

/* Replies ------------------------------------------------------------------------------------------------------ */

static unsigned char reply[REPLY];
static epg_cdr_reader_t reader;

/** Checks that pieces of every size give the same reply, in both orders of the pieces. */
static void check_pieces(size_t size)
{
    for (size_t step = 1; step <= size; step = step < 20 ? step + 1 : step * 2) {
        for (size_t i = 0; i * step < 2 * size; i++) {
            const size_t forward = i * step < size ? i * step : (2 * size - 1 - i * step) / step * step;
            unsigned char piece[2 * REPLY];
            const size_t expected = size - forward < step ? size - forward : step;
            piece[expected] = 0xA5;
            CHECK_EQUAL(epg_service_reply(&node, forward, piece, step), expected);
            CHECK(memcmp(piece, reply + forward, expected) == 0);
            CHECK_EQUAL(piece[expected], 0xA5);
        }
    }
}

/** Waits for the reply, at most ten cycles, and begins to read it.  Returns the number of cycles. */
static unsigned int wait(void)
{
    unsigned int cycles = 0;
    while (!epg_service_poll(&node, fake_port.now_ns)) {
        CHECK(cycles++ < 10);
        fake_cycle();
    }
    const size_t size = epg_service_reply_size(&node);
    CHECK(size <= sizeof reply);
    CHECK_EQUAL(epg_service_reply(&node, 0, reply, sizeof reply), size);
    check_pieces(size);
    reader = (epg_cdr_reader_t){.data = reply, .size = size};
    return cycles;
}

static void end(void)
{
    CHECK(!reader.failed);
    CHECK_EQUAL(reader.position, reader.size);
    epg_service_done(&node);
}

static void ask(size_t service)
{
    CHECK_EQUAL(send_request(service), EPG_SERVICE_TAKEN);
    wait();
}

static void check_text(const char *expected)
{
    const char *text = epg_cdr_read_string(&reader);
    CHECK(text != NULL);
    if (strcmp(text, expected) != 0) {
        fprintf(stderr, "'%s' is not '%s'\n", text, expected);
        exit(1);
    }
}

static void check_value(double expected)
{
    CHECK_EQUAL(epg_cdr_read_u8(&reader), DOUBLE);
    CHECK_EQUAL(epg_cdr_read_u8(&reader), 0);
    CHECK_EQUAL(epg_cdr_read_bits(&reader, sizeof(uint64_t)), 0);
    CHECK_EQUAL(epg_cdr_read_f64(&reader), expected);
    check_text("");
    for (size_t i = 0; i < 5; i++) {
        CHECK_EQUAL(epg_cdr_read_u32(&reader), 0);
    }
}

static void check_result(bool successful, const char *reason)
{
    CHECK_EQUAL(epg_cdr_read_u8(&reader), successful ? 1 : 0);
    check_text(reason);
}

static void check_texts(uint32_t count, const char *const *expected)
{
    CHECK_EQUAL(epg_cdr_read_u32(&reader), count);
    for (uint32_t i = 0; i < count; i++) {
        check_text(expected[i]);
    }
}

/* Reading ------------------------------------------------------------------------------------------------------ */

static void list(uint32_t prefixes, const char *const *names, uint32_t depth)
{
    write_names(prefixes, names);
    epg_cdr_write_f64(&writer, 0.0); /* eight bytes; the lower four follow */
    asked[writer.length - 8] = (unsigned char)depth;
    ask(LIST);
}

TEST(all_parameters_are_listed_with_their_prefixes)
{
    begin();
    list(0, NULL, 0);
    check_texts(4, (const char *const[]){"Pan.PID.kp", "Pan.PID.tauD", "Tilt.a", "b"});
    check_texts(2, (const char *const[]){"Pan.PID", "Tilt"});
    end();
}

TEST(prefixes_and_depths_are_those_of_rclcpp)
{
    begin();
    list(1, (const char *const[]){"Pan"}, 0);
    check_texts(2, (const char *const[]){"Pan.PID.kp", "Pan.PID.tauD"});
    check_texts(1, (const char *const[]){"Pan.PID"});
    end();
    list(2, (const char *const[]){"Pan.PID.tauD", "Til"},
         0); /* the name itself is its prefix; a part of a word is not */
    check_texts(1, (const char *const[]){"Pan.PID.tauD"});
    check_texts(1, (const char *const[]){"Pan.PID"});
    end();
    list(0, NULL, 2);
    check_texts(2, (const char *const[]){"Tilt.a", "b"});
    check_texts(1, (const char *const[]){"Tilt"});
    end();
    list(1, (const char *const[]){"Pan"}, 1);
    check_texts(0, NULL);
    check_texts(0, NULL);
    end();
}

TEST(values_are_read_in_the_order_of_the_request)
{
    begin();
    write_names(4, (const char *const[]){"b", "Pan.PID.kp", "b", "Pan.PID.tauD"});
    ask(GET);
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 4);
    check_value(2.0);
    check_value(2.6);
    check_value(2.0);
    check_value(0.05);
    end();
}

TEST(a_reply_has_the_values_of_one_instant)
{
    begin();
    write_names(1, (const char *const[]){"b"});
    CHECK_EQUAL(send_request(GET), EPG_SERVICE_TAKEN);
    const epg_parameter_change_t change = {B, 77.0};
    CHECK(epg_parameters_change(&parameters, &change, 1)); /* the console changes it while the reply is sent */
    wait();
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 1);
    check_value(2.0);
    end();
}

TEST(a_request_that_names_an_unknown_parameter_has_an_empty_reply)
{
    begin();
    for (size_t service = GET; service <= DESCRIBE; service++) {
        write_names(2, (const char *const[]){"b", "Pan\\PID\\kp"});
        ask(service);
        CHECK_EQUAL(epg_cdr_read_u32(&reader), 0);
        end();
    }
}

TEST(types_are_double)
{
    begin();
    write_names(3, (const char *const[]){"b", "b", "Tilt.a"});
    ask(TYPES);
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 3);
    for (size_t i = 0; i < 3; i++) {
        CHECK_EQUAL(epg_cdr_read_u8(&reader), DOUBLE);
    }
    end();
}

static void check_descriptor(size_t index, uint32_t ranges)
{
    check_text(texts[index].name);
    CHECK_EQUAL(epg_cdr_read_u8(&reader), DOUBLE);
    check_text(texts[index].description);
    check_text("");                                 /* additional_constraints */
    CHECK_EQUAL(epg_cdr_read_u8(&reader), 0);       /* read_only */
    CHECK_EQUAL(epg_cdr_read_u8(&reader), 0);       /* dynamic_typing */
    CHECK_EQUAL(epg_cdr_read_u32(&reader), ranges); /* floating_point_range */
    if (ranges > 0) {
        CHECK_EQUAL(epg_cdr_read_f64(&reader), limits[index].minimum);
        CHECK_EQUAL(epg_cdr_read_f64(&reader), limits[index].maximum);
        CHECK_EQUAL(epg_cdr_read_f64(&reader), 0.0);
    }
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 0); /* integer_range */
}

TEST(descriptions_have_limits_and_units)
{
    begin();
    write_names(3, (const char *const[]){"Pan.PID.kp", "Pan.PID.tauD", "b"});
    ask(DESCRIBE);
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 3);
    check_descriptor(KP, 1);
    check_descriptor(TAU, 1);
    check_descriptor(B, 0);
    end();
}

/* Setting ------------------------------------------------------------------------------------------------------ */

TEST(accepted_values_act_in_one_cycle_and_each_has_its_result)
{
    begin();
    write_count(8);
    write_parameter("Pan.PID.kp", DOUBLE, 10.0);
    write_parameter("Pan.PID.kp", DOUBLE, 10.5);
    write_parameter("Pan.PID.kp", INTEGER, 11.0);
    write_parameter("Pan.PID.tauD", STRING, 1.0);
    write_parameter("b", DOUBLE, NAN);
    write_parameter("Pan.PID.kx", DOUBLE, 1.0);
    write_parameter("Tilt.a", DOUBLE, 5.0);
    write_parameter("Tilt.a", INTEGER, 6.0);
    CHECK_EQUAL(send_request(SET), EPG_SERVICE_TAKEN);
    CHECK(!epg_service_poll(&node, fake_port.now_ns));
    CHECK_EQUAL(model[KP], 2.6);
    const unsigned int steps = fake.steps;
    CHECK_EQUAL(wait(), 1);
    CHECK_EQUAL(sets, 1);
    CHECK_EQUAL(steps_at_set, steps);
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 8);
    check_result(true, "");
    check_result(false, "Parameter {Pan.PID.kp} doesn't comply with floating point range.");
    check_result(false, "Parameter {Pan.PID.kp} doesn't comply with floating point range.");
    check_result(false, "Wrong parameter type, parameter {Pan.PID.tauD} is of type {double}, setting it to {string} "
                        "is not allowed.");
    check_result(false, "Parameter {b} must be a finite number.");
    check_result(false, "parameter 'Pan.PID.kx' cannot be set because it was not declared");
    check_result(true, "");
    check_result(true, "");
    end();
    CHECK_EQUAL(model[KP], 10.0);
    CHECK_EQUAL(model[TAU], 0.05);
    CHECK_EQUAL(model[A], 6.0); /* the last one of two */
    CHECK_EQUAL(model[B], 2.0);
}

TEST(atomically_all_values_or_none)
{
    begin();
    write_count(2);
    write_parameter("b", DOUBLE, 5.0);
    write_parameter("Pan.PID.kp", DOUBLE, -0.1);
    ask(ATOMIC);
    check_result(false, "Parameter {Pan.PID.kp} doesn't comply with floating point range.");
    end();
    fake_cycles(2);
    CHECK_EQUAL(sets, 0);
    write_count(2);
    write_parameter("b", DOUBLE, 5.0);
    write_parameter("Pan.PID.kp", DOUBLE, 0.1);
    ask(ATOMIC);
    check_result(true, "");
    end();
    CHECK_EQUAL(sets, 1);
    CHECK_EQUAL(model[B], 5.0);
    CHECK_EQUAL(model[KP], 0.1);
    write_count(0);
    ask(ATOMIC);
    check_result(true, "");
    end();
}

TEST(a_request_waits_for_the_changes_of_another_one)
{
    begin();
    const epg_parameter_change_t change = {A, 1.5};
    CHECK(epg_parameters_change(&parameters, &change, 1));
    write_count(1);
    write_parameter("b", DOUBLE, 5.0);
    CHECK_EQUAL(send_request(SET), EPG_SERVICE_TAKEN);
    CHECK_EQUAL(wait(), 2);
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 1);
    check_result(true, "");
    end();
    CHECK_EQUAL(model[A], 1.5);
    CHECK_EQUAL(model[B], 5.0);
}

TEST(without_cycles_the_result_says_so)
{
    begin();
    write_count(1);
    write_parameter("b", DOUBLE, 5.0);
    CHECK_EQUAL(send_request(SET), EPG_SERVICE_TAKEN);
    CHECK(!epg_service_poll(&node, fake_port.now_ns));
    fake_port.now_ns += 501U * MS;
    CHECK(epg_service_poll(&node, fake_port.now_ns));
    wait();
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 1);
    check_result(false, "the control loop does not run");
    end();
}

TEST(no_value_enables_the_target)
{
    begin();
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(2);
    write_count(2);
    write_parameter("enable", DOUBLE, 1.0);
    write_parameter("b", DOUBLE, 1.0);
    ask(SET);
    epg_service_done(&node);
    fake_cycles(3);
    CHECK(!fake_status().enabled);
}

/* Hostile requests --------------------------------------------------------------------------------------------- */

TEST(requests_that_are_cut_off_are_malformed)
{
    begin();
    for (size_t service = LIST; service <= ATOMIC; service++) {
        write_names(2, (const char *const[]){"Pan.PID.kp", "b"});
        if (service == LIST) {
            epg_cdr_write_f64(&writer, 0.0);
        } else if (service >= SET) {
            write_count(2);
            write_parameter("Pan.PID.kp", DOUBLE, 1.0);
            write_parameter("b", DOUBLE, 1.0);
        }
        const size_t size = writer.length;
        for (size_t length = 0; length < size; length++) {
            const uint32_t malformed = node.malformed;
            CHECK_EQUAL(epg_service_request(&node, service, asked, length, 0), EPG_SERVICE_MALFORMED);
            CHECK_EQUAL(node.malformed, malformed + 1);
        }
        CHECK_EQUAL(epg_service_request(&node, service, asked, size, 0), EPG_SERVICE_TAKEN);
        epg_service_done(&node);
    }
    CHECK_EQUAL(epg_service_request(&node, SET, asked, REQUEST + 1, 0), EPG_SERVICE_MALFORMED);
    CHECK_EQUAL(epg_service_request(&node, GET, asked, 257, 0), EPG_SERVICE_MALFORMED);
    fake_cycles(2);
    CHECK_EQUAL(sets, 0);
}

TEST(any_bytes_are_taken_or_refused)
{
    uint32_t random = 1;
    begin();
    for (unsigned int round = 0; round < 20000; round++) {
        write_count(1 + round % 3);
        write_parameter("Pan.PID.kp", DOUBLE, 1.0);
        write_parameter("b", DOUBLE, 1.0);
        for (unsigned int i = 0; i < 1 + round % 8; i++) {
            random = random * 1664525U + 1013904223U;
            asked[(random >> 8) % writer.length] = (unsigned char)(random >> 24);
        }
        const size_t service = round % STORE;
        const size_t size = writer.length < services[service].request_size ? writer.length : 256;
        if (epg_service_request(&node, service, asked, size, fake_port.now_ns) == EPG_SERVICE_TAKEN) {
            unsigned char piece[64];
            while (!epg_service_poll(&node, fake_port.now_ns)) {
                fake_cycle();
            }
            const size_t length = epg_service_reply_size(&node);
            size_t offset = 0;
            for (size_t got = 1; got > 0; offset += got) {
                got = epg_service_reply(&node, offset, piece, sizeof piece);
            }
            CHECK_EQUAL(offset, length);
            epg_service_done(&node);
        }
    }
    for (size_t i = 0; i < COUNT; i++) {
        CHECK(epg_parameters_can_be(&parameters, i, model[i]));
    }
}

/* Events ------------------------------------------------------------------------------------------------------- */

/** Begins to read the last event.  Returns the number of its changed parameters. */
static uint32_t read_event(void)
{
    reader = (epg_cdr_reader_t){.data = last, .size = last_size};
    (void)epg_cdr_read_i32(&reader);
    (void)epg_cdr_read_u32(&reader);
    check_text("/robot1/JIWY_node");
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 0);
    return epg_cdr_read_u32(&reader);
}

static void change(size_t index, double value)
{
    const epg_parameter_change_t one = {index, value};
    CHECK(epg_parameters_change(&parameters, &one, 1));
}

static void poll(void)
{
    for (unsigned int i = 0; i < 6; i++) { /* one period */
        fake_cycle();
        (void)epg_node_poll(&node, fake_port.now_ns);
    }
}

TEST(an_event_tells_each_change_once)
{
    begin();
    poll();
    CHECK_EQUAL(sent, 0);
    change(A, 4.0);
    poll();
    poll();
    CHECK_EQUAL(sent, 1);
    CHECK_EQUAL(read_event(), 1);
    check_text("Tilt.a");
    check_value(4.0);
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 0);
    CHECK_EQUAL(reader.position, reader.size);
}

TEST(an_event_that_could_not_be_sent_is_told_later_with_the_newest_value)
{
    begin();
    room = false;
    change(A, 4.0);
    poll();
    change(A, 5.0);
    poll();
    change(B, 6.0);
    poll();
    room = true;
    poll();
    poll();
    CHECK_EQUAL(sent, 1);
    CHECK_EQUAL(read_event(), 2);
    check_text("Tilt.a");
    check_value(5.0);
    check_text("b");
    check_value(6.0);
}

TEST(changes_that_do_not_fit_into_one_event_follow)
{
    begin();
    node.buffer_size = 8 + 24 + 8 + 72 + 72 + 8;
    const epg_parameter_change_t all[COUNT] = {{KP, 1.0}, {TAU, 2.0}, {A, 3.0}, {B, 4.0}};
    CHECK(epg_parameters_change(&parameters, all, COUNT));
    uint32_t told = 0;
    for (unsigned int i = 0; i < 60; i++) {
        const unsigned int before = sent;
        fake_cycle();
        (void)epg_node_poll(&node, fake_port.now_ns);
        told += sent > before ? read_event() : 0U;
    }
    CHECK_EQUAL(sent, 2);
    CHECK_EQUAL(told, COUNT);
}

/* Store -------------------------------------------------------------------------------------------------------- */

TEST(parameters_are_stored_while_the_actuators_are_off)
{
    begin();
    change(A, 4.0);
    write_count(0);
    ask(STORE);
    check_result(false, "the actuators must be off: disable first");
    end();
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(2);
    ask(STORE);
    check_result(true, "1 value is stored");
    end();
    change(B, 4.0);
    fake_cycles(2);
    ask(STORE);
    check_result(true, "2 values are stored");
    end();
    fake_port.store_refuses = true;
    ask(STORE);
    check_result(false, "the fake memory is worn out");
    end();
}

RUN()
