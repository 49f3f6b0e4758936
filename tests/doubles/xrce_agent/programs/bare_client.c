/**
 * @file
 * eProsima's client, used as in its own examples.
 *
 *     bare_client udp:127.0.0.1:8888 | serial:/dev/pts/3 [options]
 *
 * Answers each sample of rt/ping with the same sample on rt/pong.  Options: "key=<n>", "best_effort", "xml" (describes
 * entities in XML instead of the binary form), "count=<ms>" (a counter on rt/count), "large=<ms>" (1200 bytes on
 * rt/large, which need several fragments).  Prints "connected", the time offset, and at the end the reason for ending.
 */
#define _POSIX_C_SOURCE 200809L

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <ucdr/microcdr.h>
#include <uxr/client/client.h>
#include <uxr/client/util/ping.h>
#include <uxr/client/util/time.h>

enum {
    HISTORY = 8,
    LARGE = 1200,
    MTU = UXR_CONFIG_CUSTOM_TRANSPORT_MTU,
    PONG_TIMEOUT = 100, /* ms */
    PINGS = 5,
    PING_PERIOD = 500 /* ms */
};

typedef struct options {
    const char *address;
    uint32_t key;
    bool best_effort;
    bool xml;
    int64_t count_period;
    int64_t large_period;
} options_t;

static int file = -1;
static volatile sig_atomic_t ending;
static uint8_t output_best_effort[MTU];
static uint8_t output_reliable[MTU * HISTORY];
static uint8_t input_reliable[MTU * HISTORY];
static uxrStreamId best_effort_out, reliable_out, best_effort_in, reliable_in;
static uxrObjectId pong_writer, count_writer, large_writer;
static uxrStreamId data_out;

/* Transport -------------------------------------------------------------------------------------------------------- */

static bool open_udp(const char *address)
{
    char host[64];
    const char *colon = strrchr(address, ':');
    snprintf(host, sizeof host, "%.*s", (int)(colon - address), address);
    struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)atoi(colon + 1))};
    inet_pton(AF_INET, host, &to.sin_addr);
    file = socket(AF_INET, SOCK_DGRAM, 0);
    return file >= 0 && connect(file, (struct sockaddr *)&to, sizeof to) == 0;
}

static bool open_serial(const char *path)
{
    struct termios settings;
    file = open(path, O_RDWR | O_NOCTTY);
    if (file < 0 || tcgetattr(file, &settings) != 0) {
        return false;
    }
    settings.c_iflag = 0;
    settings.c_oflag = 0;
    settings.c_lflag = 0;
    settings.c_cc[VMIN] = 0;
    return tcsetattr(file, TCSANOW, &settings) == 0;
}

static bool transport_open(uxrCustomTransport *transport)
{
    const char *address = transport->args;
    return strncmp(address, "udp:", 4) == 0 ? open_udp(address + 4) : open_serial(address + 7);
}

static bool transport_close(uxrCustomTransport *transport)
{
    return close(file) == 0;
}

static size_t transport_write(uxrCustomTransport *transport, const uint8_t *data, size_t size, uint8_t *error)
{
    const ssize_t done = write(file, data, size);
    *error = done < 0;
    return done < 0 ? 0 : (size_t)done;
}

static size_t transport_read(uxrCustomTransport *transport, uint8_t *data, size_t size, int timeout, uint8_t *error)
{
    struct pollfd wait = {.fd = file, .events = POLLIN};
    if (poll(&wait, 1, timeout) <= 0) {
        *error = 1;
        return 0;
    }
    const ssize_t done = read(file, data, size);
    if (done <= 0 && (wait.revents & POLLHUP) != 0) {
        ending = 1; /* the line was closed */
    }
    *error = done <= 0;
    return done < 0 ? 0 : (size_t)done;
}

/* Entities --------------------------------------------------------------------------------------------------------- */

static bool accepted(uxrSession *session, uint16_t request)
{
    uint8_t status;
    return uxr_run_session_until_all_status(session, 3000, &request, &status, 1);
}

static bool create_topic(uxrSession *session, const options_t *options, uint16_t id, const char *name, const char *type)
{
    const uxrObjectId topic = uxr_object_id(id, UXR_TOPIC_ID), participant = uxr_object_id(1, UXR_PARTICIPANT_ID);
    char xml[256];
    snprintf(xml, sizeof xml, "<dds><topic><name>%s</name><dataType>%s</dataType></topic></dds>", name, type);
    return accepted(
        session, options->xml
                     ? uxr_buffer_create_topic_xml(session, reliable_out, topic, participant, xml, UXR_REPLACE)
                     : uxr_buffer_create_topic_bin(session, reliable_out, topic, participant, name, type, UXR_REPLACE));
}

static bool create_endpoint(uxrSession *session, const options_t *options, uxrObjectId id, uint16_t topic,
                            const char *name, const char *type)
{
    const bool writer = id.type == UXR_DATAWRITER_ID;
    const uxrObjectId parent = uxr_object_id(1, writer ? UXR_PUBLISHER_ID : UXR_SUBSCRIBER_ID);
    const uxrObjectId topic_id = uxr_object_id(topic, UXR_TOPIC_ID);
    const uxrQoS_t qos = {
        .reliability = options->best_effort ? UXR_RELIABILITY_BEST_EFFORT : UXR_RELIABILITY_RELIABLE,
        .durability = UXR_DURABILITY_VOLATILE,
        .history = UXR_HISTORY_KEEP_LAST,
        .depth = 10,
    };
    const char *kind = writer ? "data_writer" : "data_reader";
    char xml[512];
    snprintf(
        xml, sizeof xml,
        "<dds><%s><qos><reliability><kind>%s</kind></reliability></qos><topic><kind>NO_KEY</kind><name>%s</name>"
        "<dataType>%s</dataType><historyQos><kind>KEEP_LAST</kind><depth>10</depth></historyQos></topic></%s></dds>",
        kind, options->best_effort ? "BEST_EFFORT" : "RELIABLE", name, type, kind);
    uint16_t request;
    if (writer) {
        request = options->xml
                      ? uxr_buffer_create_datawriter_xml(session, reliable_out, id, parent, xml, UXR_REPLACE)
                      : uxr_buffer_create_datawriter_bin(session, reliable_out, id, parent, topic_id, qos, UXR_REPLACE);
    } else {
        request = options->xml
                      ? uxr_buffer_create_datareader_xml(session, reliable_out, id, parent, xml, UXR_REPLACE)
                      : uxr_buffer_create_datareader_bin(session, reliable_out, id, parent, topic_id, qos, UXR_REPLACE);
    }
    return accepted(session, request);
}

static bool create_entities(uxrSession *session, const options_t *options)
{
    static const char *const type = "std_msgs::msg::dds_::Float64_", *const text = "std_msgs::msg::dds_::String_";
    const uxrObjectId participant = uxr_object_id(1, UXR_PARTICIPANT_ID),
                      publisher = uxr_object_id(1, UXR_PUBLISHER_ID);
    const uxrObjectId subscriber = uxr_object_id(1, UXR_SUBSCRIBER_ID), reader = uxr_object_id(1, UXR_DATAREADER_ID);
    char name[32], xml[128];
    snprintf(name, sizeof name, "bare_%u", options->key);
    snprintf(xml, sizeof xml, "<dds><participant><rtps><name>%s</name></rtps></participant></dds>", name);
    pong_writer = uxr_object_id(1, UXR_DATAWRITER_ID);
    count_writer = uxr_object_id(2, UXR_DATAWRITER_ID);
    large_writer = uxr_object_id(3, UXR_DATAWRITER_ID);
    const uint16_t first =
        options->xml ? uxr_buffer_create_participant_xml(session, reliable_out, participant, 255, xml, UXR_REPLACE)
                     : uxr_buffer_create_participant_bin(session, reliable_out, participant, 255, name, UXR_REPLACE);
    if (!accepted(session, first) ||
        !accepted(session,
                  options->xml
                      ? uxr_buffer_create_publisher_xml(session, reliable_out, publisher, participant, "", UXR_REPLACE)
                      : uxr_buffer_create_publisher_bin(session, reliable_out, publisher, participant, UXR_REPLACE)) ||
        !accepted(session, options->xml ? uxr_buffer_create_subscriber_xml(session, reliable_out, subscriber,
                                                                           participant, "", UXR_REPLACE)
                                        : uxr_buffer_create_subscriber_bin(session, reliable_out, subscriber,
                                                                           participant, UXR_REPLACE)) ||
        !create_topic(session, options, 1, "rt/pong", type) || !create_topic(session, options, 2, "rt/count", type) ||
        !create_topic(session, options, 3, "rt/large", text) || !create_topic(session, options, 4, "rt/ping", type) ||
        !create_endpoint(session, options, pong_writer, 1, "rt/pong", type) ||
        !create_endpoint(session, options, count_writer, 2, "rt/count", type) ||
        !create_endpoint(session, options, large_writer, 3, "rt/large", text) ||
        !create_endpoint(session, options, reader, 4, "rt/ping", type)) {
        return false;
    }
    const uxrDeliveryControl control = {.max_samples = UXR_MAX_SAMPLES_UNLIMITED};
    const uint16_t request = uxr_buffer_request_data(session, reliable_out, reader,
                                                     options->best_effort ? best_effort_in : reliable_in, &control);
    return request != UXR_INVALID_REQUEST_ID;
}

static void on_topic(uxrSession *session, uxrObjectId id, uint16_t request, uxrStreamId stream, ucdrBuffer *data,
                     uint16_t length, void *unused)
{
    double value;
    ucdrBuffer out;
    if (length == sizeof value && ucdr_deserialize_double(data, &value) &&
        uxr_prepare_output_stream(session, data_out, pong_writer, &out, sizeof value) != UXR_INVALID_REQUEST_ID) {
        ucdr_serialize_double(&out, value);
    }
}

/* The program ------------------------------------------------------------------------------------------------------ */

static void end(int signal_number)
{
    ending = 1;
}

static options_t read_options(int count, char **words)
{
    options_t options = {.address = words[1], .key = 1};
    for (int i = 2; i < count; i++) {
        if (strncmp(words[i], "key=", 4) == 0) {
            options.key = (uint32_t)strtoul(words[i] + 4, NULL, 10);
        } else if (strncmp(words[i], "count=", 6) == 0) {
            options.count_period = atoi(words[i] + 6);
        } else if (strncmp(words[i], "large=", 6) == 0) {
            options.large_period = atoi(words[i] + 6);
        } else if (strcmp(words[i], "best_effort") == 0) {
            options.best_effort = true;
        } else if (strcmp(words[i], "xml") == 0) {
            options.xml = true;
        }
    }
    return options;
}

static void write_count(uxrSession *session, double *count)
{
    ucdrBuffer out;
    if (uxr_prepare_output_stream(session, data_out, count_writer, &out, sizeof *count) != UXR_INVALID_REQUEST_ID) {
        ucdr_serialize_double(&out, (*count)++);
    }
}

static void write_large(uxrSession *session)
{
    static char text[LARGE];
    ucdrBuffer out;
    memset(text, 'x', sizeof text - 1);
    if (uxr_prepare_output_stream(session, reliable_out, large_writer, &out, 4 + LARGE) != UXR_INVALID_REQUEST_ID) {
        ucdr_serialize_string(&out, text);
    }
}

static void run(uxrSession *session, const options_t *options)
{
    double count = 0;
    int64_t next_count = 0, next_large = 0, next_ping = uxr_millis() + PING_PERIOD;
    while (!ending) {
        const int64_t now = uxr_millis();
        if (options->count_period > 0 && now >= next_count) {
            next_count = now + options->count_period;
            write_count(session, &count);
        }
        if (options->large_period > 0 && now >= next_large) {
            next_large = now + options->large_period;
            write_large(session);
        }
        if (now >= next_ping) {
            next_ping = now + PING_PERIOD;
            if (!uxr_ping_agent_session(session, PONG_TIMEOUT, PINGS)) {
                printf("lost\n");
                return;
            }
        }
        (void)uxr_run_session_until_timeout(session, options->count_period > 0 ? 5 : 50);
    }
    printf("deleted %d\n", uxr_delete_session_retries(session, 2));
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        return 2;
    }
    const options_t options = read_options(argc, argv);
    setvbuf(stdout, NULL, _IOLBF, 0);
    signal(SIGTERM, end);
    static uxrCustomTransport transport;
    uxr_set_custom_transport_callbacks(&transport, strncmp(argv[1], "serial:", 7) == 0, transport_open, transport_close,
                                       transport_write, transport_read);
    if (!uxr_init_custom_transport(&transport, argv[1])) {
        printf("no transport\n");
        return 1;
    }
    static uxrSession session;
    uxr_init_session(&session, &transport.comm, options.key);
    uxr_set_topic_callback(&session, on_topic, NULL);
    best_effort_out = uxr_create_output_best_effort_stream(&session, output_best_effort, sizeof output_best_effort);
    reliable_out = uxr_create_output_reliable_stream(&session, output_reliable, sizeof output_reliable, HISTORY);
    best_effort_in = uxr_create_input_best_effort_stream(&session);
    reliable_in = uxr_create_input_reliable_stream(&session, input_reliable, sizeof input_reliable, HISTORY);
    data_out = options.best_effort ? best_effort_out : reliable_out;
    if (!uxr_create_session(&session)) {
        printf("no agent\n");
        return 1;
    }
    if (!create_entities(&session, &options)) {
        printf("refused\n");
        return 1;
    }
    printf("connected\n");
    const bool synchronised = uxr_sync_session(&session, 1000);
    printf("synchronised %d offset %lld\n", synchronised, (long long)session.time_offset);
    run(&session, &options);
    return 0;
}
