/**
 * @file
 * Messages: their bytes, and messages of foreign programs.
 */
#include "epg/message.h"

#include <math.h>

#include "check.h"
#include "epg/cdr.h"
#include "epg/target.h"

enum { ROOM = 512, MAX_VALUES = 8 };

static const epg_stamp_t stamp = {.seconds = 7, .nanoseconds = 500};
static unsigned char bytes[ROOM];
static double values[MAX_VALUES];

static const uint8_t three_of_array[] = {0, 1, 2};
static const uint8_t one_of_array[] = {1};
static const uint8_t of_twist[] = {0, 5};
static const uint8_t of_joints[] = {0, 1, 4}; /* pan.position, pan.velocity, tilt.velocity */
static const char *const joints[] = {"pan", "tilt"};
static const epg_message_layout_t array_layout = {.fields = three_of_array, .count = 3, .frame_id = ""};
static const epg_message_layout_t part_layout = {.fields = one_of_array, .count = 3, .frame_id = ""};
static const epg_message_layout_t twist_layout = {.fields = of_twist, .count = 6, .frame_id = "base"};
static const epg_message_layout_t joint_layout = {.fields = of_joints, .count = 2, .names = joints, .frame_id = "base"};

static const epg_topic_t float64 = {.message = &epg_message_float64, .count = 1};
static const epg_topic_t float32 = {.message = &epg_message_float32, .count = 1};
static const epg_topic_t int32 = {.message = &epg_message_int32, .count = 1};
static const epg_topic_t boolean = {.message = &epg_message_bool, .count = 1};
static const epg_topic_t array = {.message = &epg_message_float64_array, .layout = &array_layout, .count = 3};
static const epg_topic_t part = {.message = &epg_message_float64_array, .layout = &part_layout, .count = 1};
static const epg_topic_t twist = {.message = &epg_message_twist, .layout = &twist_layout, .count = 2};
static const epg_topic_t stamped = {.message = &epg_message_twist_stamped, .layout = &twist_layout, .count = 2};
static const epg_topic_t joint_state = {.message = &epg_message_joint_state, .layout = &joint_layout, .count = 3};

static const epg_topic_t *const topics[] = {&float64, &float32, &int32,   &boolean,    &array,
                                            &part,    &twist,   &stamped, &joint_state};
enum { TOPICS = sizeof topics / sizeof topics[0] };

static size_t write_values(const epg_topic_t *topic, const double *numbers)
{
    memset(bytes, 0xAA, sizeof bytes);
    return topic->message->write(topic, numbers, stamp, bytes, sizeof bytes);
}

/** Reads from a copy of exactly this size, so that sanitizers detect a read beyond it. */
static bool read_values(const epg_topic_t *topic, const void *data, size_t size)
{
    unsigned char *copy = malloc(size > 0 ? size : 1);
    CHECK(copy != NULL);
    memcpy(copy, data, size);
    memset(values, 0, sizeof values);
    const bool good = topic->message->read(topic, copy, size, values);
    free(copy);
    return good;
}

static void check_bytes(const epg_topic_t *topic, const double *numbers, const void *expected, size_t size)
{
    CHECK_EQUAL(write_values(topic, numbers), size);
    CHECK(memcmp(bytes, expected, size) == 0);
}

TEST(numbers_are_little_endian)
{
    check_bytes(&float64, (const double[]){1.5}, "\0\0\0\0\0\0\xf8\x3f", 8);
    check_bytes(&float32, (const double[]){1.5}, "\0\0\xc0\x3f", 4);
    check_bytes(&int32, (const double[]){-2.0}, "\xfe\xff\xff\xff", 4);
    check_bytes(&boolean, (const double[]){1.0}, "\1", 1);
}

TEST(numbers_are_rounded_and_limited)
{
    static const struct {
        double value;
        double expected;
    } cases[] = {{2.5, 3.0}, {-2.5, -3.0}, {2.4999, 2.0}, {1e12, 2147483647.0}, {-1e12, -2147483648.0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CHECK(write_values(&int32, &cases[i].value) == 4 && read_values(&int32, bytes, 4));
        CHECK_EQUAL(values[0], cases[i].expected);
    }
    CHECK(write_values(&int32, (const double[]){NAN}) == 4 && read_values(&int32, bytes, 4));
    CHECK_EQUAL(values[0], 0.0);
    check_bytes(&boolean, (const double[]){0.5}, "\0", 1);
    CHECK(!read_values(&boolean, "\2", 1));
}

TEST(an_array_has_its_length_and_padding)
{
    const double numbers[] = {1.5, 0.0, 1.5};
    static const char expected[] = "\0\0\0\0\0\0\0\0\3\0\0\0\0\0\0\0"
                                   "\0\0\0\0\0\0\xf8\x3f\0\0\0\0\0\0\0\0\0\0\0\0\0\0\xf8\x3f";
    check_bytes(&array, numbers, expected, 40);
    CHECK(write_values(&part, (const double[]){9.0}) == 40 && read_values(&array, bytes, 40));
    CHECK_EQUAL(values[0], 0.0);
    CHECK_EQUAL(values[1], 9.0);
}

TEST(an_array_may_describe_itself)
{
    epg_cdr_writer_t writer = {.data = bytes, .size = sizeof bytes};
    epg_cdr_write_u32(&writer, 1); /* a dimension */
    epg_cdr_write_string(&writer, "joints");
    epg_cdr_write_u32(&writer, 3);
    epg_cdr_write_u32(&writer, 3);
    epg_cdr_write_u32(&writer, 2); /* offset */
    epg_cdr_write_u32(&writer, 5);
    for (int i = 0; i < 5; i++) {
        epg_cdr_write_f64(&writer, i);
    }
    CHECK(read_values(&array, bytes, writer.length));
    CHECK_EQUAL(values[0], 2.0);
    CHECK_EQUAL(values[2], 4.0);
    CHECK(!read_values(&array, bytes, writer.length - 8));
}

TEST(an_array_of_another_length_is_refused)
{
    static const unsigned char four[] = {0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
                                         0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    static const unsigned char empty[12] = {0};
    static const unsigned char boundless[] = {0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0};
    CHECK(!read_values(&array, four, sizeof four));
    CHECK(!read_values(&array, empty, sizeof empty));
    CHECK(!read_values(&array, boundless, sizeof boundless));
}

TEST(a_twist_has_zeros_where_nothing_is_bound)
{
    CHECK_EQUAL(write_values(&twist, (const double[]){1.0, 2.0}), 48);
    epg_cdr_reader_t reader = {.data = bytes, .size = 48};
    const double expected[] = {1.0, 0.0, 0.0, 0.0, 0.0, 2.0};
    for (size_t i = 0; i < 6; i++) {
        CHECK_EQUAL(epg_cdr_read_f64(&reader), expected[i]);
    }
    CHECK(read_values(&twist, bytes, 48));
    CHECK_EQUAL(values[0], 1.0);
    CHECK_EQUAL(values[1], 2.0);
}

TEST(a_header_has_the_time_and_the_frame)
{
    const size_t size = write_values(&stamped, (const double[]){1.0, 2.0});
    CHECK_EQUAL(size, 4 + 4 + 4 + 5 + 7 + 48);
    CHECK(memcmp(bytes, "\7\0\0\0\xf4\1\0\0\5\0\0\0base\0", 17) == 0);
    CHECK(read_values(&stamped, bytes, size));
    CHECK_EQUAL(values[1], 2.0);
}

TEST(joints_leave_out_what_none_has)
{
    const size_t size = write_values(&joint_state, (const double[]){1.0, 2.0, 3.0});
    epg_cdr_reader_t reader = {.data = bytes, .size = size};
    size_t first;
    CHECK_EQUAL(epg_cdr_read_i32(&reader), 7);
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 500);
    CHECK(strcmp(epg_cdr_read_string(&reader), "base") == 0);
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 2);
    CHECK(strcmp(epg_cdr_read_string(&reader), "pan") == 0);
    CHECK(strcmp(epg_cdr_read_string(&reader), "tilt") == 0);
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 2);
    CHECK_EQUAL(epg_cdr_read_f64(&reader), 1.0);
    CHECK(isnan(epg_cdr_read_f64(&reader))); /* tilt has a velocity only */
    CHECK_EQUAL(epg_cdr_read_u32(&reader), 2);
    CHECK_EQUAL(epg_cdr_read_f64(&reader), 2.0);
    CHECK_EQUAL(epg_cdr_read_f64(&reader), 3.0);
    CHECK_EQUAL(epg_cdr_read_sequence(&reader, 8, &first), 0);
    CHECK(!reader.failed && reader.position == size);
}

/** A message of joints from a foreign program: `names` in their order, positions from 10 and velocities from 20. */
static size_t foreign_joints(const char *const *names, uint32_t count, uint32_t positions, uint32_t velocities)
{
    epg_cdr_writer_t writer = {.data = bytes, .size = sizeof bytes};
    epg_cdr_write_i32(&writer, 0);
    epg_cdr_write_u32(&writer, 0);
    epg_cdr_write_string(&writer, "");
    epg_cdr_write_u32(&writer, count);
    for (uint32_t i = 0; i < count; i++) {
        epg_cdr_write_string(&writer, names[i]);
    }
    epg_cdr_write_u32(&writer, positions);
    for (uint32_t i = 0; i < positions; i++) {
        epg_cdr_write_f64(&writer, 10.0 + i);
    }
    epg_cdr_write_u32(&writer, velocities);
    for (uint32_t i = 0; i < velocities; i++) {
        epg_cdr_write_f64(&writer, 20.0 + i);
    }
    epg_cdr_write_u32(&writer, 0);
    return writer.length;
}

TEST(joints_are_found_by_their_names)
{
    static const char *const names[] = {"wheel", "tilt", "pan"};
    CHECK(read_values(&joint_state, bytes, foreign_joints(names, 3, 3, 3)));
    CHECK_EQUAL(values[0], 12.0);
    CHECK_EQUAL(values[1], 22.0);
    CHECK_EQUAL(values[2], 21.0);
}

TEST(joints_that_are_not_all_there_are_refused)
{
    static const char *const names[] = {"pan", "tilt", "wheel"};
    CHECK(!read_values(&joint_state, bytes, foreign_joints(names, 1, 1, 1))); /* no tilt */
    CHECK(!read_values(&joint_state, bytes, foreign_joints(names, 2, 2, 0))); /* no velocities */
    CHECK(!read_values(&joint_state, bytes, foreign_joints(names, 2, 2, 1)));
    CHECK(!read_values(&joint_state, bytes, foreign_joints(names, 0, 0, 0)));
    CHECK(read_values(&joint_state, bytes, foreign_joints(names, 2, 2, 2)));
}

TEST(what_does_not_fit_is_not_written)
{
    const double numbers[MAX_VALUES] = {1.0, 2.0, 3.0};
    for (size_t t = 0; t < TOPICS; t++) {
        const size_t size = write_values(topics[t], numbers);
        CHECK(size > 0);
        for (size_t room = 0; room < size; room++) {
            unsigned char *exactly = malloc(room > 0 ? room : 1);
            CHECK(exactly != NULL);
            CHECK(topics[t]->message->write(topics[t], numbers, stamp, exactly, room) == 0);
            free(exactly);
        }
    }
}

TEST(what_is_cut_off_is_refused)
{
    const double numbers[MAX_VALUES] = {1.0, 0.0, 1.0};
    for (size_t t = 0; t < TOPICS; t++) {
        const size_t size = write_values(topics[t], numbers);
        CHECK(read_values(topics[t], bytes, size) || topics[t] == &joint_state);
        for (size_t cut = 0; cut < size; cut++) {
            CHECK(!read_values(topics[t], bytes, cut) || (topics[t] == &joint_state && cut + 4 >= size));
        }
    }
}

TEST(any_bytes_at_all)
{
    unsigned char noise[120];
    srand(2);
    for (int i = 0; i < 100000; i++) {
        const size_t size = (size_t)rand() % sizeof noise;
        for (size_t k = 0; k < size; k++) {
            noise[k] = (unsigned char)(rand() % 3 == 0 ? rand() : rand() % 6);
        }
        (void)read_values(topics[(size_t)i % TOPICS], noise, size);
    }
}

RUN()
