/**
 * @file
 * The console for programs, message by message.  The test encodes and decodes frames by itself.
 */
#include "check.h"
#include "console_bench.h"
#include "fake_application.h"
#include "fake_port.h"
#include "program_bench.h"

TEST(a_command_in_a_frame_has_its_answer_in_frames_with_its_tag)
{
    begin(true);
    command(7, "get PID\\kp PID\\tauD");
    bench_run(10);
    check_next(7, "parameter PID\\kp=2.6");
    check_next(7, "parameter PID\\tauD=0.05 unit=s");
    check_next(7, "ok get");
    command(8, "set PID\\kp=3");
    bench_run(10);
    check_next(8, "ok set");
    command(9, "nonsense");
    bench_run(10);
    check_next(9, "error line there is no command 'nonsense'");
}

TEST(a_line_that_answers_no_command_has_tag_0)
{
    begin(true);
    command(200, "disable");
    bench_run(10);
    check_next(0, "state enabled=0 fault=none stop=01234567-1 by=program");
    check_next(200, "ok disable");
}

TEST(damaged_frames_do_nothing)
{
    begin(true);
    for (size_t at = 0; at < 14; at++) {
        for (int bit = 0; bit < 8; bit++) {
            unsigned char frame[64];
            const size_t size = encode("C\5disable", 9, frame);
            CHECK(size == 16);
            frame[1 + at] ^= (unsigned char)(1 << bit);
            bench_send(frame, size);
            CHECK(fake_status().enabled);
            bench_run(150); /* the console closes a frame that does not end */
        }
        send("K", 1);
    }
    command(6, "disable");
    bench_run(10);
    CHECK(!fake_status().enabled);
}

TEST(lines_of_text_work_between_frames)
{
    begin(true);
    CHECK_EQUAL(bench_say("set_b=4\n")[0], 0); /* the answer is a frame: the program is there */
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 1), 4.0);
    bench_run(2100); /* the program is gone */
    CHECK(strcmp(bench_say("set_b=5\n"), "ok setpoint\r\n") == 0);
}

/* Streams -------------------------------------------------------------------------------------------------------- */

static void stream(unsigned char tag, uint32_t every, size_t count, const unsigned char *signals)
{
    unsigned char message[LONGEST] = {'S', tag};
    for (unsigned int i = 0; i < 4; i++) {
        message[2 + i] = (unsigned char)(every >> 8U * i);
    }
    for (size_t i = 0; i < count; i++) {
        message[6 + 2 * i] = signals[i];
    }
    send(message, 6 + 2 * count);
}

static float value_in(const unsigned char *bytes)
{
    const uint32_t bits = number_in(bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

TEST(a_stream_has_a_row_of_every_cycle)
{
    begin(true);
    fake.sensor = 0.5;
    stream(3, 1, 2, (const unsigned char[]){1, 2});
    bench_run(10);
    check_next(3, "ok stream rows=37");
    bench_run(200);
    uint32_t number = 0;
    uint64_t tick_ns = 0;
    float state = -1.0F;
    for (message_t rows = next('D'); rows.length > 0; rows = next('D')) {
        const uint64_t first_ns = number_in(&rows.bytes[5]) | (uint64_t)number_in(&rows.bytes[9]) << 32;
        CHECK_EQUAL(number_in(&rows.bytes[1]), number);
        CHECK(tick_ns == 0 || first_ns == tick_ns);
        tick_ns = first_ns;
        for (size_t at = 13; at < rows.length; at += 8) {
            CHECK_EQUAL(value_in(&rows.bytes[at]), 0.5F);
            CHECK(state < 0.0F || value_in(&rows.bytes[at + 4]) == state + 1.0F);
            state = value_in(&rows.bytes[at + 4]);
            number++;
            tick_ns += FAKE_PERIOD_NS;
        }
    }
    CHECK(number >= 205);
}

TEST(a_stream_can_have_the_times_of_the_loop)
{
    begin(true);
    fake.step_ns = 2000;
    bench_run(50);
    stream(3, 1, 2, (const unsigned char[]){4, 5});
    bench_run(10);
    fake.step_ns = 5000;
    fake_late_cycle(700, 0);
    bench_run(10);
    unsigned int late = 0;
    float computation = -1.0F;
    for (message_t rows = next('D'); rows.length > 0; rows = next('D')) {
        for (size_t at = 13; at < rows.length; at += 8) {
            const float lateness = value_in(&rows.bytes[at]);
            const float expected = computation < 0.0F ? 0.0F : late > 0 ? 5000.0F : 2000.0F;
            computation = value_in(&rows.bytes[at + 4]); /* of the cycle before */
            CHECK_EQUAL(computation, expected);
            CHECK(lateness == 0.0F || lateness == 700.0F);
            late += lateness > 0.0F ? 1U : 0U;
        }
    }
    CHECK_EQUAL(late, 1);
    CHECK_EQUAL(computation, 5000.0F);
}

TEST(a_stream_can_have_the_duty_and_the_position_of_a_movement_by_hand)
{
    begin(false);
    stream(3, 1, 2, (const unsigned char[]){11, 12});
    bench_run(10);
    command(4, "jog motor 0.1 20");
    bench_run(60);
    unsigned int moving = 0;
    float duty = 0.0F;
    float position = 0.0F;
    for (message_t rows = next('D'); rows.length > 0; rows = next('D')) {
        for (size_t at = 13; at < rows.length; at += 8) {
            duty = value_in(&rows.bytes[at]);
            CHECK(duty == 0.0F || duty == 0.1F);
            moving += duty > 0.0F ? 1U : 0U;
            position -= duty > 0.0F ? 10.0F * 0.25F : 0.0F;
            CHECK_EQUAL(value_in(&rows.bytes[at + 4]), position);
        }
    }
    CHECK_EQUAL(moving, 20);
    CHECK_EQUAL(duty, 0.0F);
    CHECK_EQUAL(position, -50.0F);
}

TEST(rows_without_room_are_dropped_whole_and_leave_a_gap)
{
    begin(true);
    stream(3, 2, 4, (const unsigned char[]){0, 1, 2, 3});
    bench_run(20);
    bench.room = 0;
    bench_run(400);
    bench.room = SIZE_MAX;
    bench_run(100);
    uint32_t number = 0;
    uint32_t missing = 0;
    uint64_t last_ns = 0;
    for (message_t rows = next('D'); rows.length > 0; rows = next('D')) {
        const uint32_t first = number_in(&rows.bytes[1]);
        const uint64_t first_ns = number_in(&rows.bytes[5]) | (uint64_t)number_in(&rows.bytes[9]) << 32;
        CHECK(first >= number);
        CHECK_EQUAL((rows.length - 13) % 16, 0);
        CHECK(last_ns == 0 || first_ns - last_ns == (first - number + 1) * 2ULL * FAKE_PERIOD_NS);
        missing += first - number;
        number = first + (uint32_t)((rows.length - 13) / 16);
        last_ns = first_ns + ((rows.length - 13) / 16 - 1) * 2ULL * FAKE_PERIOD_NS;
    }
    CHECK(missing > 50 && missing < 200);
    CHECK(number >= 255);
}

TEST(a_stream_that_is_impossible_is_refused)
{
    begin(true);
    stream(3, 0, 1, (const unsigned char[]){0});
    stream(4, 1, 0, NULL);
    stream(5, 1, 33, (const unsigned char[33]){0});
    stream(6, 1, 1, (const unsigned char[]){13});
    bench.options.transport_rate = 11520;
    stream(7, 1, 4, (const unsigned char[]){0, 1, 2, 3});
    bench_run(10);
    check_next(3, "error stream a stream has 1 to 32 signals, and a row in at least every cycle");
    check_next(4, "error stream a stream has 1 to 32 signals, and a row in at least every cycle");
    check_next(5, "error stream a stream has 1 to 32 signals, and a row in at least every cycle");
    check_next(6, "error stream there is no signal with this index");
    check_next(7, "error stream needs 17615 bytes per second of 8064 that the transport has for streams");
    stream(8, 3, 4, (const unsigned char[]){0, 1, 2, 3});
    bench_run(10);
    check_next(8, "ok stream rows=25");
    stream(9, 3, 4, (const unsigned char[]){0, 1, 2, 3});
    bench_run(10);
    check_next(9, "error stream a stream runs: end it first");
}

/* Starts a stream of doubles. */
static void exact_stream(unsigned char tag, size_t count, const unsigned char *signals)
{
    unsigned char message[LONGEST] = {'S', tag, 1, 0, 0, 0, 0xFF, 0xFF};
    for (size_t i = 0; i < count; i++) {
        message[8 + 2 * i] = signals[i];
    }
    send(message, 8 + 2 * count);
}

static double double_in(const unsigned char *bytes)
{
    const uint64_t bits = number_in(bytes) | (uint64_t)number_in(bytes + 4) << 32;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

enum { CYCLE, PARAMETER, VALUE, ACTED, UNTOLD, SENSOR, COLUMNS };
static const unsigned char replay_columns[COLUMNS] = {6, 7, 8, 9, 10, 1};
static double table_of_rows[4096][COLUMNS];

/* Reads all rows of doubles that have arrived, and returns their number. */
static size_t read_rows(void)
{
    size_t count = 0;
    for (message_t rows = next('E'); rows.length > 0; rows = next('E')) {
        CHECK_EQUAL(number_in(&rows.bytes[1]), count);
        CHECK_EQUAL((rows.length - 13) % (COLUMNS * sizeof(double)), 0);
        for (size_t at = 13; at < rows.length; at += COLUMNS * sizeof(double)) {
            for (size_t i = 0; i < COLUMNS; i++) {
                table_of_rows[count][i] = double_in(&rows.bytes[at + i * sizeof(double)]);
            }
            count++;
        }
    }
    return count;
}

/* Checks the change that a row tells; parameter -1: none. */
static void check_told(size_t row, int parameter, double value, double acted)
{
    CHECK_EQUAL(table_of_rows[row][PARAMETER], (double)(parameter + 1));
    if (parameter >= 0) {
        CHECK_EQUAL(table_of_rows[row][VALUE], value);
        CHECK_EQUAL(table_of_rows[row][ACTED], acted);
    }
}

TEST(a_stream_of_doubles_has_every_bit_and_the_cycle_since_enabling)
{
    begin(false);
    fake.sensor = 0.1;
    exact_stream(3, COLUMNS, replay_columns);
    bench_run(10);
    check_next(3, "ok stream rows=18");
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    bench_run(50);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    bench_run(5);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    bench_run(20);
    const size_t count = read_rows();
    unsigned int enablings = 0;
    double before = 0.0;
    for (size_t row = 0; row < count; row++) {
        const double cycle = table_of_rows[row][CYCLE];
        CHECK_EQUAL(table_of_rows[row][SENSOR], 0.1);
        CHECK(cycle == 0.0 || cycle == 1.0 || cycle == before + 1.0);
        enablings += cycle == 1.0 ? 1U : 0U;
        check_told(row, -1, 0.0, 0.0);
        before = cycle;
    }
    CHECK_EQUAL(enablings, 2);
    CHECK(count >= 80);
}

TEST(a_stream_tells_each_change_of_a_parameter_with_its_cycle)
{
    begin(false);
    command(1, "set PID\\kp=3"); /* before the stream, and while disabled: it is told after the enabling */
    bench_run(10);
    exact_stream(3, COLUMNS, replay_columns);
    command(4, "set PID\\tauD=0.125");
    bench_run(10);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    bench_run(20);
    command(5, "set PID\\kp=4 PID\\tauD=0.25");
    bench_run(20);
    const size_t count = read_rows();
    size_t first = 0;
    while (table_of_rows[first][CYCLE] == 0.0) {
        check_told(first++, -1, 0.0, 0.0);
    }
    CHECK_EQUAL(table_of_rows[first][UNTOLD], 1.0);
    CHECK_EQUAL(table_of_rows[first][PARAMETER] + table_of_rows[first + 1][PARAMETER], 3.0);
    for (size_t row = first; row < first + 2; row++) {
        check_told(row, (int)table_of_rows[row][PARAMETER] - 1, table_of_rows[row][PARAMETER] < 2.0 ? 3.0 : 0.125, 1.0);
    }
    size_t later = first + 2;
    while (table_of_rows[later][PARAMETER] == 0.0 && later < count) {
        CHECK_EQUAL(table_of_rows[later++][UNTOLD], 0.0);
    }
    CHECK(later + 2 < count);
    const double acted = table_of_rows[later][CYCLE];
    for (size_t row = later; row < later + 2; row++) {
        check_told(row, (int)table_of_rows[row][PARAMETER] - 1, table_of_rows[row][PARAMETER] < 2.0 ? 4.0 : 0.25,
                   acted);
    }
    CHECK_EQUAL(table_of_rows[later + 2][PARAMETER], 0.0);
}

TEST(a_stream_says_that_it_could_not_tell_a_change)
{
    begin(true);
    exact_stream(3, COLUMNS, replay_columns);
    bench_run(10);
    /* Two parameters change in each of two cycles: one of the first two is not yet told when it changes again. */
    CHECK(epg_parameters_change(&bench.parameters, (const epg_parameter_change_t[]){{0, 1.0}, {1, 2.0}}, 2));
    fake_cycle();
    CHECK(epg_parameters_change(&bench.parameters, (const epg_parameter_change_t[]){{0, 3.0}, {1, 4.0}}, 2));
    fake_cycle();
    bench_run(10);
    const size_t count = read_rows();
    unsigned int lost = 0;
    for (size_t row = 0; row < count; row++) {
        lost += table_of_rows[row][PARAMETER] < 0.0 ? 1U : 0U;
    }
    CHECK_EQUAL(lost, 1);
}

TEST(a_stream_of_long_rows_needs_a_large_output)
{
    begin(true);
    unsigned char all[32] = {0};
    bench.options.output_size = 512;
    exact_stream(3, 32, all);
    bench.options.output_size = BENCH_OUTPUT;
    bench_run(10);
    check_next(3, "error stream a row is too long for the target's output of answers");
    exact_stream(4, 0, NULL);
    exact_stream(5, 33, (const unsigned char[33]){0});
    bench_run(10);
    check_next(4, "error stream a stream has 1 to 32 signals, and a row in at least every cycle");
    check_next(5, "error stream a stream has 1 to 32 signals, and a row in at least every cycle");
    exact_stream(6, 32, all);
    bench_run(50);
    check_next(6, "ok stream rows=4");
    message_t rows = next('E');
    CHECK_EQUAL(rows.length, 13 + 32 * 8);
    CHECK(next('E').length > 0);
    send("S\7", 2);
    bench_run(10);
    bench.options.transport_rate = 11520;
    exact_stream(8, COLUMNS, replay_columns);
    bench_run(10);
    next('A');
    check_next(8, "error stream needs 53250 bytes per second of 8064 that the transport has for streams");
}

TEST(a_stream_and_a_recording_share_the_memory)
{
    begin(true);
    command(1, "capture duty rows=150");
    bench_run(10);
    stream(2, 1, 1, (const unsigned char[]){0});
    bench_run(200);
    check_next(1, "ok capture rows=150");
    check_next(2, "error stream a recording has the memory: end it first");
    stream(3, 1, 1, (const unsigned char[]){0});
    command(4, "capture duty rows=150");
    command(5, "capture duty rows=75");
    bench_run(100);
    next('A'); /* the end of the first recording */
    check_next(3, "ok stream rows=50");
    check_next(4, "error capture there is only room for rows=75");
    check_next(5, "ok capture rows=75");
    send("S\6", 2);
    bench_run(10);
    next('A');
    check_next(6, "ok stream");
    command(7, "capture duty rows=150");
    bench_run(10);
    check_next(7, "ok capture rows=150");
}

TEST(a_stream_ends_with_the_connection_and_with_the_silence_of_the_program)
{
    begin(true);
    stream(3, 1, 1, (const unsigned char[]){0});
    bench_run(10);
    CHECK(!epg_telemetry_idle(&telemetry));
    bench.connected = false;
    bench_run(10);
    CHECK(epg_telemetry_idle(&telemetry));
    bench.connected = true;
    bench_run(10);
    send("K", 1);
    stream(3, 1, 1, (const unsigned char[]){0});
    bench_run(1500);
    CHECK(!epg_telemetry_idle(&telemetry));
    bench_run(600);
    CHECK(epg_telemetry_idle(&telemetry));
}

/* Leases --------------------------------------------------------------------------------------------------------- */

/* Commands to enable on a lease, as a program does that knows all stops so far. */
static void enable_leased(unsigned char tag)
{
    char line[64];
    (void)snprintf(line, sizeof line, "enable leased after=%08x-%u", (unsigned int)(fake_status().stop_number >> 32U),
                   (unsigned int)fake_status().stop_number);
    command(tag, line);
}

/* Sends the newest number back. */
static bool respond(void)
{
    bool found = false;
    unsigned char response[5] = {'R'};
    for (message_t number = next('N'); number.length > 0; number = next('N')) {
        CHECK_EQUAL(number.length, 5);
        memcpy(&response[1], &number.bytes[1], 4);
        found = true;
    }
    if (found) {
        send(response, sizeof response);
    }
    return found;
}

TEST(a_target_on_a_lease_stays_enabled_while_its_numbers_come_back)
{
    begin(false);
    enable_leased(1);
    bench_run(10);
    CHECK(fake_status().enabled && fake_status().leased);
    for (int i = 0; i < 100; i++) {
        bench_run(90);
        CHECK(respond());
        CHECK(fake_status().enabled);
    }
    /* The newest number was sent at most 50 ms before the last response. */
    unsigned int ms = 0;
    while (fake_status().enabled) {
        bench_run(1);
        ms++;
        CHECK(ms <= 300);
    }
    CHECK(ms >= 245);
    CHECK_EQUAL(fake_status().fault, EPG_FAULT_OPERATOR);
    CHECK_EQUAL(fake.actuator, 0.0);
}

TEST(a_lease_without_a_response_ends)
{
    begin(false);
    enable_leased(1);
    bench_run(295);
    CHECK(fake_status().enabled);
    bench_run(10);
    CHECK(!fake_status().enabled);
}

TEST(the_control_side_ends_a_lease_by_itself)
{
    begin(false);
    enable_leased(1);
    bench_run(10);
    fake_cycles(290);
    CHECK(fake_status().enabled);
    fake_cycles(10);
    CHECK(!fake_status().enabled);
}

TEST(only_numbers_of_the_last_300_ms_count)
{
    begin(false);
    enable_leased(1);
    bench_run(20);
    const message_t first = next('N');
    CHECK(first.length == 5);
    unsigned char response[5] = {'R'};
    memcpy(&response[1], &first.bytes[1], 4);
    const uint64_t begin_ns = fake_port.now_ns;
    while (fake_status().enabled) { /* the first number again and again */
        send(response, sizeof response);
        bench_run(8);
        CHECK(fake_port.now_ns - begin_ns < 300000000U);
    }
    CHECK(fake_port.now_ns - begin_ns > 260000000U);
    enable_leased(2);
    bench_run(10);
    for (unsigned int ms = 0; fake_status().enabled; ms++) { /* numbers that were never sent */
        response[1]++;
        response[3] = (unsigned char)ms;
        send(response, sizeof response);
        CHECK(ms < 800);
    }
}

TEST(a_number_that_comes_back_late_or_twice_does_not_shorten_the_lease)
{
    begin(false);
    enable_leased(1);
    bench_run(20);
    unsigned char early[5] = {'R'};
    unsigned char late[5] = {'R'};
    memcpy(&early[1], &next('N').bytes[1], 4);
    bench_run(200);
    for (message_t number = next('N'); number.length == 5; number = next('N')) {
        memcpy(&late[1], &number.bytes[1], 4);
    }
    send(late, sizeof late);
    send(late, sizeof late);
    send(early, sizeof early);
    bench_run(200); /* 100 ms longer than the first number permits */
    CHECK(fake_status().enabled);
    bench_run(150);
    CHECK(!fake_status().enabled);
}

TEST(a_lease_does_not_belong_to_the_next_connection)
{
    begin(false);
    enable_leased(1);
    bench_run(60);
    CHECK(respond());
    CHECK(fake_status().enabled);
    bench.connected = false;
    bench_run(5);
    bench.connected = true;
    bench_run(5);
    seen = bench.out_length; /* the greeting is text */
    send("K", 1);
    for (unsigned int ms = 10; fake_status().enabled; ms += 10) {
        CHECK(ms <= 300);
        bench_run(10);
        (void)respond();
    }
}

TEST(numbers_that_were_not_sent_yet_do_not_extend_a_lease)
{
    for (uint32_t ahead = 1; ahead <= 32; ahead++) {
        begin(false);
        enable_leased(1);
        bench_run(10);
        CHECK(fake_status().enabled);
        for (unsigned int ms = 10; fake_status().enabled; ms += 10) {
            CHECK(ms <= 300);
            bench_run(10);
            const message_t number = next('N');
            if (number.length == 5) {
                const uint32_t guess = number_in(&number.bytes[1]) + ahead;
                unsigned char response[5] = {'R'};
                for (unsigned int i = 0; i < 4; i++) {
                    response[1 + i] = (unsigned char)(guess >> 8U * i);
                }
                send(response, sizeof response);
            }
        }
    }
}

TEST(a_lease_ends_neither_an_enabling_by_others_nor_starts_over_it)
{
    begin(true);
    enable_leased(1);
    bench_run(10);
    check_next(1, "error enable the target is enabled already, without a lease");
    bench_run(1000);
    CHECK(fake_status().enabled && !fake_status().leased);
    bench.connected = false;
    bench_run(1000);
    CHECK(fake_status().enabled);
    bench.connected = true;
    bench_run(10);
    CHECK(has_line(bench_say("enable leased\n"), "error enable a lease is for programs that use frames"));
}

TEST(a_change_of_the_connection_drops_no_frame)
{
    static const unsigned char message[] = {'C', 1, 'd', 'i', 's', 'a', 'b', 'l', 'e'};
    for (int opened = 0; opened < 2; opened++) {
        for (size_t cut = 0;; cut++) {
            unsigned char frame[LONGEST];
            const size_t size = encode(message, sizeof message, frame);
            begin(true);
            bench.connected = opened == 0;
            bench_run(5);
            if (cut > size) {
                break;
            }
            (void)bench_send(frame, cut);
            bench.connected = opened != 0;
            (void)bench_send(frame + cut, size - cut);
            CHECK(!fake_status().enabled);
        }
    }
}

/** Frames, parts of frames and random bytes in any order, while the reader connects, disconnects and reads at random. */
TEST(any_bytes_are_harmless)
{
    static const char *const lines[] = {"get",           "watch",        "ports",       "stats",
                                        "enable leased", "capture duty", "disable",     "jog motor 0.1 30",
                                        "set_b=1",       "version",      "capture read"};
    begin(true);
    srand(11);
    for (int i = 0; i < 20000; i++) {
        unsigned char message[300] = {(unsigned char)"CSRKX"[rand() % 5], (unsigned char)rand()};
        size_t length = 2 + (size_t)rand() % 90U;
        for (size_t k = 2; k < length; k++) {
            message[k] = (unsigned char)(rand() % 3 > 0 ? rand() % 4 : rand());
        }
        if (message[0] == 'C') {
            const char *line = lines[(size_t)rand() % (sizeof lines / sizeof lines[0])];
            length = 2 + strlen(line);
            memcpy(message + 2, line, strlen(line));
        }
        if (message[0] == 'S' && rand() % 2 > 0) { /* a stream that exists, of floats or doubles */
            message[2] = 1;
            length += length % 2;
            for (size_t k = 3; k < length; k++) {
                message[k] = (unsigned char)(k < 6 || k % 2 > 0 ? 0 : rand() % 14);
            }
            if (rand() % 2 > 0) {
                message[6] = message[7] = 0xFF;
            }
        }
        unsigned char frame[LONGEST];
        const size_t size = encode(message, length, frame);
        if (rand() % 4 == 0) {
            frame[(size_t)rand() % size] = (unsigned char)rand();
        }
        bench.connected = rand() % 300 > 0;
        bench.room = rand() % 3 > 0 ? SIZE_MAX : (size_t)rand() % 60U;
        bench.in = (const char *)frame;
        bench.in_length = rand() % 9 > 0 ? size : (size_t)rand() % size;
        for (int polls = 0; bench.in_length > 0 && polls < 3000; polls++) {
            bench_poll();
            bench.room = rand() % 3 > 0 ? SIZE_MAX : bench.room;
        }
        if (bench.out_length > sizeof bench.out / 2) {
            bench.out_length = 0;
        }
    }
    bench.connected = true;
    bench.room = SIZE_MAX;
    for (int i = 0; i < 50; i++) {
        bench.out_length = 0;
        bench_run(100);
    }
    CHECK(has_line(bench_say("version\n"), "ok version"));
}

RUN()
