/**
 * @file
 * Frames on a stream of bytes.
 */
#include "check.h"
#include "xrce_link.h"

enum { LINE = 8192, FRAME = 512 };

static struct {
    unsigned char in[LINE];
    size_t in_length;
    size_t in_position;
    size_t at_once; /**< largest number of bytes per read */
    unsigned char out[LINE];
    size_t out_length;
    size_t room;
} line;

static unsigned char frame[FRAME];
static epg_xrce_link_t link;

static bool connected(void *context)
{
    (void)context;
    return true;
}

static size_t read_line(void *context, void *data, size_t size)
{
    (void)context;
    size_t count = line.in_length - line.in_position;
    count = count < size ? count : size;
    count = count < line.at_once ? count : line.at_once;
    memcpy(data, line.in + line.in_position, count);
    line.in_position += count;
    return count;
}

static size_t write_line(void *context, const void *data, size_t size)
{
    (void)context;
    CHECK(size <= line.room && line.out_length + size <= LINE);
    memcpy(line.out + line.out_length, data, size);
    line.out_length += size;
    line.room -= size;
    return size;
}

static size_t writable(void *context)
{
    (void)context;
    return line.room;
}

static const epg_stream_t bytes = {
    .connected = connected, .read = read_line, .write = write_line, .writable = writable};

static void start(void)
{
    memset(&line, 0, sizeof line);
    line.room = LINE;
    line.at_once = LINE;
    epg_xrce_link_start(&link, &bytes, frame, sizeof frame);
}

static void arrive(const void *data, size_t size)
{
    CHECK(line.in_length + size <= LINE);
    memcpy(line.in + line.in_length, data, size);
    line.in_length += size;
}

/** Returns the sent frames as if the agent had sent them: to the client, from the agent. */
static void turn_round(void)
{
    unsigned char data[LINE];
    memcpy(data, line.out, line.out_length);
    CHECK(data[0] == 0x7E && data[1] == 1 && data[2] == 0);
    data[1] = 0;
    data[2] = 1;
    arrive(data, line.out_length);
    line.out_length = 0;
}

static void fill(unsigned char *data, size_t size, unsigned int seed)
{
    for (size_t i = 0; i < size; i++) {
        seed = seed * 1664525U + 1013904223U;
        data[i] = (unsigned char)(seed >> 24);
    }
}

TEST(known_bytes_are_those_of_other_implementations)
{
    static const unsigned char message[] = {0x80, 0x00, 0x7E, 0x7D, 0x01};
    start();
    CHECK(epg_xrce_link_send(&link, message, sizeof message));
    static const unsigned char head[] = {0x7E, 0x01, 0x00, 0x05, 0x00, 0x80, 0x00, 0x7D, 0x5E, 0x7D, 0x5D, 0x01,
                                         /* CRC-16/ARC of the message, 0x5681, computed by another program */
                                         0x81, 0x56};
    CHECK(line.out_length == sizeof head);
    CHECK(memcmp(line.out, head, sizeof head) == 0);
}

TEST(every_frame_arrives_as_it_was_sent)
{
    for (size_t size = 1; size <= FRAME; size += size < 40 ? 1 : 59) {
        unsigned char message[FRAME];
        fill(message, size, (unsigned int)size);
        start();
        line.at_once = 1 + size % 7;
        CHECK(epg_xrce_link_send(&link, message, size));
        CHECK(line.out_length <= epg_xrce_link_cost(&link, message, size));
        turn_round();
        CHECK_EQUAL(epg_xrce_link_receive(&link), size);
        CHECK(memcmp(frame, message, size) == 0);
        CHECK_EQUAL(epg_xrce_link_receive(&link), 0);
        CHECK_EQUAL(link.broken, 0);
    }
}

TEST(a_frame_of_nothing_but_special_bytes_costs_twice)
{
    unsigned char message[100];
    memset(message, 0x7E, sizeof message);
    start();
    const size_t cost = epg_xrce_link_cost(&link, message, sizeof message);
    CHECK(cost >= 200 && cost <= 220);
    line.room = cost;
    CHECK(epg_xrce_link_send(&link, message, sizeof message));
}

TEST(a_frame_goes_out_whole_or_not_at_all)
{
    unsigned char message[64];
    fill(message, sizeof message, 3);
    start();
    line.room = epg_xrce_link_cost(&link, message, sizeof message) - 1;
    CHECK(!epg_xrce_link_send(&link, message, sizeof message));
    CHECK_EQUAL(line.out_length, 0);
    line.room++;
    CHECK(epg_xrce_link_send(&link, message, sizeof message));
}

TEST(half_a_frame_is_waited_for)
{
    static const unsigned char message[] = {0x81, 0, 0, 0, 1, 2, 3, 4};
    start();
    CHECK(epg_xrce_link_send(&link, message, sizeof message));
    turn_round();
    const size_t whole = line.in_length;
    for (size_t i = 0; i + 1 < whole; i++) {
        line.in_length = i + 1;
        CHECK_EQUAL(epg_xrce_link_receive(&link), 0);
    }
    line.in_length = whole;
    CHECK_EQUAL(epg_xrce_link_receive(&link), sizeof message);
}

TEST(noise_before_and_between_frames_is_passed_over)
{
    static const unsigned char message[] = {0x81, 0, 0, 0, 1, 2, 3, 4};
    unsigned char noise[300];
    fill(noise, sizeof noise, 7);
    start();
    for (int i = 0; i < 5; i++) {
        arrive(noise, sizeof noise);
        CHECK(epg_xrce_link_send(&link, message, sizeof message));
        turn_round();
    }
    unsigned int good = 0;
    for (int i = 0; i < 20; i++) {
        const size_t size = epg_xrce_link_receive(&link);
        good += size == sizeof message && memcmp(frame, message, size) == 0 ? 1U : 0U;
    }
    CHECK_EQUAL(good, 5);
}

TEST(a_changed_byte_spoils_a_frame_and_nothing_else)
{
    unsigned char message[40];
    fill(message, sizeof message, 11);
    for (size_t i = 5; i < sizeof message + 5; i++) {
        start();
        CHECK(epg_xrce_link_send(&link, message, sizeof message));
        turn_round();
        line.in[i] ^= 0x01;
        CHECK(epg_xrce_link_send(&link, message, sizeof message));
        turn_round();
        size_t size = 0;
        for (int call = 0; call < 3 && size == 0; call++) {
            size = epg_xrce_link_receive(&link);
        }
        CHECK_EQUAL(size, sizeof message);
        CHECK(memcmp(frame, message, size) == 0);
        CHECK(link.broken >= 1);
    }
}

TEST(a_frame_that_does_not_fit_is_no_frame)
{
    static const unsigned char head[] = {0x7E, 0, 1, 0x01, 0x02}; /* 513 bytes */
    static const unsigned char message[] = {0x81, 0, 0, 0, 1, 2, 3, 4};
    unsigned char body[600] = {0};
    start();
    arrive(head, sizeof head);
    arrive(body, sizeof body);
    CHECK(epg_xrce_link_send(&link, message, sizeof message));
    turn_round();
    CHECK_EQUAL(epg_xrce_link_receive(&link), sizeof message);
    CHECK_EQUAL(link.broken, 1);
}

TEST(frames_for_others_are_passed_over)
{
    static const unsigned char message[] = {0x81, 0, 0, 0, 1, 2, 3, 4};
    start();
    CHECK(epg_xrce_link_send(&link, message, sizeof message));
    arrive(line.out, line.out_length); /* unchanged: addressed to the agent */
    CHECK_EQUAL(epg_xrce_link_receive(&link), 0);
    CHECK_EQUAL(link.broken, 0);
}

TEST(one_call_takes_a_bounded_number_of_bytes)
{
    start();
    memset(line.in, 0x55, LINE);
    line.in_length = LINE;
    CHECK_EQUAL(epg_xrce_link_receive(&link), 0);
    CHECK(line.in_position >= 4096 && line.in_position <= 4096 + EPG_XRCE_CHUNK);
}

RUN()
