/**
 * @file
 * The connection of the console to a program by UDP, datagram by datagram.
 */
#include "links/realtime/udp_session.h"

#include "check.h"

enum { MS = 1000000, MOST = 4096 };

typedef struct datagram {
    unsigned char bytes[EPG_HOST_UDP_HEADER + EPG_HOST_UDP_FRAME];
    size_t size;
    epg_host_udp_header_t header;
} datagram_t;

static epg_host_udp_session_t session;
static datagram_t sent[MOST];
static size_t sent_count;
static bool full; /* the system has no room for a datagram */
static uint64_t now_ns;

static bool keep(void *context, const unsigned char *data, size_t size)
{
    (void)context;
    if (full) {
        return false;
    }
    CHECK(size <= sizeof sent[0].bytes && sent_count < MOST);
    datagram_t *next = &sent[sent_count++];
    memcpy(next->bytes, data, size);
    next->size = size;
    CHECK(epg_host_udp_read_header(data, size, &next->header));
    return true;
}

static void begin(void)
{
    session.send = keep;
    sent_count = 0;
    full = false;
    now_ns = 1;
    epg_host_udp_session_begin(&session, 9);
}

/* Lets the program send commands. */
static void command(uint32_t number, uint32_t lowest, const char *body)
{
    const epg_host_udp_header_t header = {.number = number, .received = session.first_line, .more = lowest};
    epg_host_udp_session_take(&session, &header, (const unsigned char *)body, strlen(body));
}

static void check_input(const char *expected)
{
    char input[EPG_HOST_UDP_INPUT + 1] = "";
    const size_t length = epg_host_udp_session_read(&session, input, EPG_HOST_UDP_INPUT);
    input[length] = '\0';
    if (strcmp(input, expected) != 0) {
        fprintf(stderr, "'%s', not '%s'\n", input, expected);
        exit(1);
    }
}

/* Writes a frame of this type and length, as the console does; returns the number of bytes that were taken. */
static size_t frame(char type, size_t length)
{
    static unsigned char bytes[EPG_HOST_UDP_FRAME + 100];
    memset(bytes, 'x', length);
    bytes[0] = 0;
    bytes[1] = 255;
    bytes[2] = (unsigned char)type;
    bytes[length - 1] = 0;
    return epg_host_udp_session_write(&session, bytes, length);
}

static void confirm(uint32_t next)
{
    const epg_host_udp_header_t header = {.received = next};
    epg_host_udp_session_take(&session, &header, (const unsigned char *)"", 0);
}

static void poll_for(unsigned int ms)
{
    for (unsigned int i = 0; i < ms; i++) {
        now_ns += MS;
        epg_host_udp_session_poll(&session, now_ns);
    }
}

TEST(commands_act_once_in_any_order)
{
    begin();
    command(1, 0, "a");
    command(3, 0, "c");
    command(2, 0, "b");
    command(1, 0, "a");
    command(2, 0, "b");
    command(3, 0, "c");
    command(40, 0, "d"); /* number 7 is now older than the target remembers */
    command(8, 0, "k");
    command(8, 0, "k");
    command(7, 0, "old");
    command(9, 0, "e");
    command(9, 0, "e");
    command(72, 0, "f"); /* a step of 32: number 40 is the oldest that it remembers */
    command(40, 0, "d");
    command(41, 0, "g");
    command(41, 0, "g");
    command(200, 0, "h");
    command(72, 0, "f");
    command(199, 0, "i");
    command(199, 0, "i");
    check_input("acbdkefghi");
}

TEST(commands_below_the_lowest_number_do_not_act)
{
    begin();
    command(5, 5, "disable ");
    command(4, 0, "enable ");
    command(6, 0, "set ");
    command(7, 8, "given up ");
    check_input("disable set ");
    CHECK(epg_host_udp_session_is_old(&session, 4));
    CHECK(!epg_host_udp_session_is_old(&session, 9));
}

TEST(a_command_without_room_is_not_lost)
{
    static char large[EPG_HOST_UDP_INPUT - 1];
    begin();
    memset(large, 'x', sizeof large - 1);
    command(1, 0, large);
    command(2, 0, "abc");
    CHECK(!epg_host_udp_session_is_old(&session, 2));
    check_input(large);
    command(2, 0, "abc");
    check_input("abc");
    command(2, 0, "abc");
    check_input("");
}

TEST(the_program_learns_which_commands_have_arrived)
{
    begin();
    command(2, 0, "b");
    command(5, 0, "e");
    poll_for(1);
    CHECK_EQUAL(sent_count, 1);
    CHECK_EQUAL(sent[0].header.session, 9);
    CHECK_EQUAL(sent[0].header.received, 5);
    CHECK_EQUAL(sent[0].header.more & 7U, 4); /* 4, 3, 2: only 2 */
    poll_for(100);
    CHECK_EQUAL(sent_count, 1);
}

TEST(lines_are_sent_again_until_they_are_confirmed)
{
    begin();
    for (int i = 0; i < 30; i++) {
        CHECK_EQUAL(frame('A', 100), 100);
    }
    poll_for(1);
    CHECK_EQUAL(sent_count, 3);
    CHECK_EQUAL(sent[0].size, EPG_HOST_UDP_HEADER + 1300);
    CHECK_EQUAL(sent[0].header.number, 0);
    CHECK_EQUAL(sent[1].header.number, 13);
    CHECK_EQUAL(sent[2].header.number, 26);
    poll_for(30);
    CHECK_EQUAL(sent_count, 3);
    poll_for(15);
    CHECK_EQUAL(sent_count, 6);
    confirm(14);
    confirm(5);  /* it is late */
    confirm(99); /* there is no such line */
    poll_for(100);
    CHECK(sent_count > 6);
    CHECK_EQUAL(sent[6].header.number, 14);
    confirm(30);
    sent_count = 0;
    poll_for(1000);
    CHECK_EQUAL(sent_count, 0);
    CHECK_EQUAL(session.lines_length, 0);
}

TEST(unconfirmed_lines_hold_back_new_ones)
{
    begin();
    size_t lines = 0;
    while (frame('A', 1000) == 1000) {
        poll_for(1);
        lines++;
    }
    CHECK_EQUAL(lines, EPG_HOST_UDP_LINES / 1000 + 1); /* the last one waits */
    CHECK_EQUAL(frame('D', 100), 0);
    confirm(3);
    CHECK_EQUAL(frame('D', 100), 100);
}

TEST(rows_share_datagrams_and_are_sent_once)
{
    begin();
    for (int i = 0; i < 40; i++) {
        CHECK_EQUAL(frame('D', 100), 100);
        poll_for(1);
    }
    CHECK(sent_count >= 5 && sent_count <= 8);
    CHECK_EQUAL(sent[0].header.flags, EPG_HOST_UDP_RUNNING | EPG_HOST_UDP_ONCE);
    CHECK_EQUAL(sent[0].header.number, 1);
    CHECK_EQUAL(sent[1].header.number, 2);
    poll_for(1000);
    const size_t before = sent_count;
    CHECK_EQUAL(frame('D', 100), 100);
    CHECK_EQUAL(frame('N', 12), 12);
    poll_for(1);
    CHECK_EQUAL(sent_count, before + 1); /* a number does not wait */
    CHECK_EQUAL(sent[before].size, EPG_HOST_UDP_HEADER + 112);
}

TEST(a_full_socket_holds_back_frames_and_loses_none)
{
    begin();
    full = true;
    size_t taken = 0;
    while (frame('D', 100) == 100) {
        taken++;
        poll_for(1);
    }
    CHECK_EQUAL(sent_count, 0);
    full = false;
    poll_for(10);
    CHECK_EQUAL(frame('A', 50), 50);
    poll_for(10);
    size_t bytes = 0;
    for (size_t i = 0; i < sent_count; i++) {
        bytes += sent[i].size - EPG_HOST_UDP_HEADER;
    }
    CHECK_EQUAL(bytes, taken * 100 + 50);
}

TEST(any_bytes_are_harmless)
{
    uint32_t state = 5;
    begin();
    for (int i = 0; i < 300000; i++) {
        unsigned char bytes[64];
        unsigned char input[40];
        for (size_t k = 0; k < sizeof bytes; k++) {
            state = state * 1664525U + 1013904223U;
            bytes[k] = (state >> 28) < 3 ? 0 : (unsigned char)(state >> 24);
        }
        const epg_host_udp_header_t header = {.flags = bytes[0],
                                              .number = bytes[1] & 63U,
                                              .received = session.first_line + (bytes[2] & 7U),
                                              .more = bytes[3] == 1 ? bytes[4] : 0};
        if (bytes[5] < 128) {
            epg_host_udp_session_take(&session, &header, bytes, bytes[6] % sizeof bytes);
        }
        (void)epg_host_udp_session_write(&session, bytes, bytes[7] % sizeof bytes);
        (void)epg_host_udp_session_read(&session, input, sizeof input);
        full = bytes[8] < 20;
        poll_for(1);
        sent_count = 0;
    }
}

RUN()
