/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * eProsima's client over the SDK's serial port on USB, as in its own examples: two setpoints in, two positions out.
 *
 * It waits for each answer of the agent.  It has none of these: services, parameters, diagnostics, time stamps, checks
 * of received frames, a limit for the time that a setpoint is valid.
 */
#include <uxr/client/client.h>
#include <uxr/client/util/ping.h>
#include <uxr/client/util/time.h>

#include "handwritten.h"
#include "pico/stdlib.h"

enum {
    MTU = UXR_CONFIG_CUSTOM_TRANSPORT_MTU,
    HISTORY = 4,
    PARTICIPANT = 1, /* ids of the entities; the topics of axis n are 2n + 1 (position) and 2n + 2 (setpoint) */
    ANSWER_MS = 1000,
    PONG_MS = 100,
    PERIOD_MS = 33,
    PING_PERIOD_MS = 1000
};

static const char *const positions[AXES] = {"rt/pan_publisher", "rt/tilt_publisher"};
static const char *const setpoints[AXES] = {"rt/pan_subscriber", "rt/tilt_subscriber"};

static uxrCustomTransport transport;
static uxrSession session;
static uint8_t output_best_effort[MTU], output_reliable[MTU * HISTORY], input_reliable[MTU * HISTORY];
static uxrStreamId reliable, best_effort, arriving;

/* Functions that the client calls ------------------------------------------------------------------------------ */

int64_t uxr_nanos(void)
{
    return (int64_t)time_us_64() * 1000;
}

int64_t uxr_millis(void)
{
    return (int64_t)(time_us_64() / 1000u);
}

static bool open_or_close(uxrCustomTransport *of)
{
    (void)of;
    return true;
}

static size_t write_bytes(uxrCustomTransport *of, const uint8_t *bytes, size_t size, uint8_t *error)
{
    (void)of;
    (void)error;
    for (size_t i = 0; i < size; i++) {
        putchar_raw(bytes[i]);
    }
    return size;
}

static size_t read_bytes(uxrCustomTransport *of, uint8_t *bytes, size_t size, int timeout, uint8_t *error)
{
    (void)of;
    (void)error;
    const absolute_time_t end = make_timeout_time_ms((uint32_t)timeout);
    size_t count = 0;
    do {
        control_alive();
        for (int byte = getchar_timeout_us(0); byte >= 0; byte = getchar_timeout_us(0)) {
            bytes[count++] = (uint8_t)byte;
            if (count == size) {
                break;
            }
        }
    } while (count == 0 && !time_reached(end));
    return count;
}

static void on_sample(uxrSession *of, uxrObjectId object, uint16_t request, uxrStreamId stream, ucdrBuffer *data,
                      uint16_t length, void *context)
{
    double value = 0.0;
    (void)of;
    (void)request;
    (void)stream;
    (void)length;
    (void)context;
    if (ucdr_deserialize_double(data, &value)) {
        control_setpoint(object.id == 2 ? PAN : TILT, value);
    }
}

/* Entities ----------------------------------------------------------------------------------------------------- */

static bool accepted(uint16_t request)
{
    uint8_t status = UXR_STATUS_NONE;
    return uxr_run_session_until_all_status(&session, ANSWER_MS, &request, &status, 1);
}

static bool create_topic(uint16_t id, const char *name)
{
    return accepted(uxr_buffer_create_topic_bin(&session, reliable, uxr_object_id(id, UXR_TOPIC_ID),
                                                uxr_object_id(PARTICIPANT, UXR_PARTICIPANT_ID), name,
                                                "std_msgs::msg::dds_::Float64_", UXR_REPLACE));
}

static bool create_axis(uint16_t axis)
{
    const uint16_t position = (uint16_t)(2 * axis + 1), setpoint = (uint16_t)(2 * axis + 2);
    const uxrObjectId reader = uxr_object_id(setpoint, UXR_DATAREADER_ID);
    const uxrQoS_t qos = {
        .durability = UXR_DURABILITY_VOLATILE,
        .reliability = UXR_RELIABILITY_BEST_EFFORT,
        .history = UXR_HISTORY_KEEP_LAST,
        .depth = 10,
    };
    const uxrDeliveryControl control = {.max_samples = UXR_MAX_SAMPLES_UNLIMITED};
    return create_topic(position, positions[axis]) && create_topic(setpoint, setpoints[axis]) &&
           accepted(uxr_buffer_create_datawriter_bin(&session, reliable, uxr_object_id(position, UXR_DATAWRITER_ID),
                                                     uxr_object_id(PARTICIPANT, UXR_PUBLISHER_ID),
                                                     uxr_object_id(position, UXR_TOPIC_ID), qos, UXR_REPLACE)) &&
           accepted(uxr_buffer_create_datareader_bin(&session, reliable, reader,
                                                     uxr_object_id(PARTICIPANT, UXR_SUBSCRIBER_ID),
                                                     uxr_object_id(setpoint, UXR_TOPIC_ID), qos, UXR_REPLACE)) &&
           uxr_buffer_request_data(&session, reliable, reader, arriving, &control) != UXR_INVALID_REQUEST_ID;
}

static bool create_entities(void)
{
    const uxrObjectId participant = uxr_object_id(PARTICIPANT, UXR_PARTICIPANT_ID);
    return accepted(
               uxr_buffer_create_participant_bin(&session, reliable, participant, 255, "JIWY_node", UXR_REPLACE)) &&
           accepted(uxr_buffer_create_publisher_bin(&session, reliable, uxr_object_id(PARTICIPANT, UXR_PUBLISHER_ID),
                                                    participant, UXR_REPLACE)) &&
           accepted(uxr_buffer_create_subscriber_bin(&session, reliable, uxr_object_id(PARTICIPANT, UXR_SUBSCRIBER_ID),
                                                     participant, UXR_REPLACE)) &&
           create_axis(PAN) && create_axis(TILT);
}

static bool connect(void)
{
    uxr_set_custom_transport_callbacks(&transport, true, open_or_close, open_or_close, write_bytes, read_bytes);
    if (!uxr_init_custom_transport(&transport, NULL)) {
        return false;
    }
    uxr_init_session(&session, &transport.comm, 0x4A495759);
    uxr_set_topic_callback(&session, on_sample, NULL);
    if (!uxr_create_session(&session)) {
        return false;
    }
    reliable = uxr_create_output_reliable_stream(&session, output_reliable, sizeof output_reliable, HISTORY);
    best_effort = uxr_create_output_best_effort_stream(&session, output_best_effort, sizeof output_best_effort);
    (void)uxr_create_input_reliable_stream(&session, input_reliable, sizeof input_reliable, HISTORY);
    arriving = uxr_create_input_best_effort_stream(&session);
    return create_entities();
}

/* Exchange ----------------------------------------------------------------------------------------------------- */

static void publish(void)
{
    static const uint8_t places[AXES] = {LOGGING_PAN, LOGGING_TILT};
    report_t report = {0};
    if (!control_report(&report)) {
        return;
    }
    for (uint16_t axis = 0; axis < AXES; axis++) {
        ucdrBuffer out;
        if (uxr_prepare_output_stream(&session, best_effort, uxr_object_id((uint16_t)(2 * axis + 1), UXR_DATAWRITER_ID),
                                      &out, sizeof(double)) != UXR_INVALID_REQUEST_ID) {
            (void)ucdr_serialize_double(&out, report.outputs[places[axis]]);
        }
    }
}

void communicate(void)
{
    static bool connected;
    static int64_t publish_ms, ping_ms;
    control_alive();
    if (!connected) {
        connected = connect();
        return;
    }
    const int64_t now_ms = uxr_millis();
    if (now_ms >= publish_ms) {
        publish_ms = now_ms + PERIOD_MS;
        publish();
    }
    if (now_ms >= ping_ms) {
        ping_ms = now_ms + PING_PERIOD_MS;
        connected = uxr_ping_agent_session(&session, PONG_MS, 3);
    }
    (void)uxr_run_session_timeout(&session, 1);
}
