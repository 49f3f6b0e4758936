/**
 * @file
 * Hostile bytes for the functions that read messages.  Each message and its values are in memory of exactly their size.
 *
 * A value that was read, written and read again must be the same.
 */
#include <stdlib.h>
#include <string.h>

#include "epg/message.h"
#include "epg/target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char *const joints[3] = {"pan", "tilt", ""};
static const uint8_t some_elements[3] = {0, 2, 4};
static const uint8_t twist_fields[2] = {0, 5};
static const uint8_t all_fields[6] = {0, 1, 2, 3, 4, 5};
static const uint8_t joint_fields[4] = {0, 1, 5, 6};
static const epg_message_layout_t elements = {.fields = some_elements, .count = 5, .frame_id = ""};
static const epg_message_layout_t two = {.fields = twist_fields, .count = 6, .frame_id = "base_link"};
static const epg_message_layout_t six = {.fields = all_fields, .count = 6, .frame_id = ""};
static const epg_message_layout_t of_joints = {.fields = joint_fields, .count = 3, .names = joints, .frame_id = ""};

/* int16, string[], bool, float32[], a stamp, string, int32, float32; texts and sequences are sent empty */
static const epg_message_step_t steps[] = {
    {.type = EPG_FIELD_INT16, .count = 1, .value = 0},
    {.type = EPG_FIELD_STRING, .sequence = true, .value = EPG_STEP_SKIP},
    {.type = EPG_FIELD_BOOL, .count = 1, .value = 1},
    {.type = EPG_FIELD_FLOAT32, .sequence = true, .value = EPG_STEP_SKIP},
    {.type = EPG_FIELD_UINT32, .count = 2, .value = EPG_STEP_SKIP},
    {.type = EPG_FIELD_STRING, .count = 1, .value = EPG_STEP_SKIP},
    {.type = EPG_FIELD_INT32, .count = 1, .value = 2},
    {.type = EPG_FIELD_FLOAT32, .count = 1, .value = 3},
};
static const uint8_t table_data[40] = {[24] = 1};
static const epg_message_place_t places[] = {
    {.offset = 0, .type = EPG_FIELD_INT16},  {.offset = 8, .type = EPG_FIELD_BOOL},
    {.offset = 32, .type = EPG_FIELD_INT32}, {.offset = 36, .type = EPG_FIELD_FLOAT32},
    {.offset = 16, .type = EPG_FIELD_STAMP},
};
static const epg_message_table_t table = {
    .message = {.type = "t", .hash = "", .write = epg_message_table_write, .read = epg_message_table_read},
    .data = table_data,
    .size = sizeof table_data,
    .places = places,
    .place_count = 5,
    .steps = steps,
    .step_count = 8,
};

static const epg_topic_t topics[] = {
    {.name = "a", .message = &epg_message_float64, .count = 1},
    {.name = "b", .message = &epg_message_float32, .count = 1},
    {.name = "c", .message = &epg_message_int32, .count = 1},
    {.name = "d", .message = &epg_message_bool, .count = 1},
    {.name = "e", .message = &epg_message_float64_array, .layout = &elements, .count = 3},
    {.name = "f", .message = &epg_message_twist, .layout = &six, .count = 6},
    {.name = "g", .message = &epg_message_twist_stamped, .layout = &two, .count = 2},
    {.name = "h", .message = &epg_message_joint_state, .layout = &of_joints, .count = 4},
    {.name = "i", .message = &table.message, .count = 4},
};

static void write_again(const epg_topic_t *topic, const double *values)
{
    unsigned char written[1024];
    double again[8];
    const size_t length = topic->message->write(topic, values, (epg_stamp_t){7, 8}, written, sizeof written);
    if (length == 0 || !topic->message->read(topic, written, length, again)) {
        abort();
    }
    for (size_t i = 0; i < topic->count; i++) {
        const bool both_nan = values[i] != values[i] && again[i] != again[i];
        if (!both_nan && values[i] != again[i]) {
            abort();
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0) {
        return 0;
    }
    const epg_topic_t *topic = &topics[data[0] % (sizeof topics / sizeof topics[0])];
    unsigned char *message = malloc(size - 1 > 0 ? size - 1 : 1);
    double *values = malloc(topic->count * sizeof *values);
    if (message != NULL && values != NULL) {
        memcpy(message, data + 1, size - 1);
        if (topic->message->read(topic, message, size - 1, values)) {
            write_again(topic, values);
        }
    }
    free(values);
    free(message);
    return 0;
}
