/**
 * @file
 * Stops at the console: a stop wins against every command that arrived before it, and is found in any input.
 */
#include "check.h"
#include "console_bench.h"
#include "epg/stop.h"
#include "fake_application.h"
#include "fake_port.h"
#include "frames.h"

/** Sends a command as a program does. */
static void say_framed(const char *line)
{
    unsigned char message[LONGEST] = {'C', 1};
    unsigned char frame[LONGEST + 16];
    memcpy(message + 2, line, strlen(line));
    (void)bench_send(frame, encode(message, 2 + strlen(line), frame));
}

/** Requests to enable on a lease, after the stop with this number. */
static void enable_leased(uint64_t number)
{
    char line[64];
    (void)snprintf(line, sizeof line, "enable leased after=%08x-%u", (unsigned int)(number >> 32U),
                   (unsigned int)number);
    say_framed(line);
}

static uint64_t stop_number(void)
{
    return fake_status().stop_number;
}

/** Runs on, and checks that no cycle writes an output of the model and no actuator moves. */
static void check_stays_safe(void)
{
    const unsigned int writes = fake.writes;
    const int64_t count = bench.count;
    bench_run(300);
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake.writes, writes);
    CHECK_EQUAL(fake.actuator, 0.0);
    CHECK(bench.count == count);
}

/* The order of commands ---------------------------------------------------------------------------------------- */

TEST(an_enable_before_a_stop_in_one_reading_does_not_act)
{
    static const char *const texts[] = {"enable\ndisable\n", "enable\nversion\nset_b=1\ndisable\n",
                                        "enable\nenable\ndisable\n", "disable\nenable\ndisable\n"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        bench_start(false);
        const char *answer = bench_say(texts[i]);
        CHECK_EQUAL(fake.writes, 0);
        check_stays_safe();
        CHECK(has_line(answer, "error enable refused: stopped by line\r\n"));
        CHECK(has_line(answer, "ok disable\r\n"));
    }
}

TEST(an_enable_after_a_stop_in_one_reading_acts_after_a_disabled_cycle)
{
    bench_start(true);
    const unsigned int inits = fake.inits;
    const unsigned int safes = fake.safes;
    const char *answer = bench_say("set_b=1\ndisable\nenable\n");
    CHECK(has_line(answer, "ok disable\r\n"));
    CHECK(has_line(answer, "ok enable\r\n"));
    CHECK(fake_status().enabled);
    CHECK(fake.safes > safes);
    CHECK_EQUAL(fake.inits, inits + 1);
}

/** Lets `text` wait behind a command until something else has stopped the target, and returns the answers. */
static const char *say_before_a_stop(const char *text)
{
    char line[128] = "set PID\\kp=3\n";
    bench_start(false);
    bench.frozen = true; /* the command waits for a cycle */
    const size_t begin = bench.out_length;
    (void)bench_say(strcat(line, text));
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    bench.frozen = false;
    bench_run(20);
    check_stays_safe();
    return bench.out + begin;
}

TEST(an_enable_that_waits_when_another_source_stops_is_refused)
{
    static const char *const texts[] = {"enable\n", "version\nenable\n"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        const char *answer = say_before_a_stop(texts[i]);
        CHECK(has_line(answer, "ok set\r\n"));
        CHECK(has_line(answer, "error enable refused: stopped by firmware\r\n"));
    }
    CHECK(has_line(bench_say("enable\n"), "state enabled=1"));
    CHECK(fake_status().enabled);
}

TEST(a_movement_by_hand_that_waits_when_another_source_stops_is_refused)
{
    const char *answer = say_before_a_stop("jog motor 0.1 100\n");
    CHECK(has_line(answer, "error jog refused: stopped by firmware\r\n"));
    CHECK_EQUAL(bench.count, 0);
    (void)bench_say("jog motor 0.1 100\n");
    CHECK(fake.actuator > 0.0);
}

TEST(a_setpoint_that_waits_when_another_source_stops_is_refused)
{
    const char *answer = say_before_a_stop("set_b=5\n");
    CHECK(has_line(answer, "error setpoint refused: stopped by firmware\r\n"));
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 1), 0.0);
}

TEST(a_movement_by_hand_before_a_stop_in_one_reading_does_not_move)
{
    bench_start(false);
    const char *answer = bench_say("jog motor 0.1 100\ndisable\n");
    CHECK_EQUAL(bench.count, 0);
    check_stays_safe();
    CHECK(has_line(answer, "error jog refused: stopped by line\r\n"));
}

TEST(a_stop_acts_while_the_commands_before_it_wait)
{
    bench_start(true);
    bench.frozen = true;
    (void)bench_say("set PID\\kp=3\nversion\nenable\ndisable\n");
    fake_cycle();
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_LINE);
    const uint64_t number = stop_number();
    bench.frozen = false;
    bench_run(20);
    check_stays_safe();
    CHECK_EQUAL(stop_number(), number); /* it is one stop, also when its line is carried out */
}

TEST(a_stop_in_a_later_packet_does_not_wait_for_the_lines_before_it)
{
    bench_start(true);
    bench.frozen = true;
    (void)bench_say("set PID\\kp=3\nversion\nversion\nenable\n"); /* the first one waits for a cycle */
    const uint64_t begin = fake_port.now_ns;
    (void)bench_say("disable\n");
    CHECK(fake_port.now_ns - begin < 20U * FAKE_PERIOD_NS); /* it is read at once, not when the command gives up */
    fake_cycle();
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_LINE);
    (void)bench_say("enable\n"); /* it arrives after the stop, so it acts */
    bench.frozen = false;
    bench_run(20);
    CHECK(fake_status().enabled);
}

/* A stop in any input ------------------------------------------------------------------------------------------ */

TEST(a_line_that_was_corrected_is_a_stop)
{
    bench_start(true);
    CHECK(has_line(bench_say("ver\b\b\bdisable\n"), "state enabled=0"));
    check_stays_safe();
    bench_start(true);
    (void)bench_say("\x03 disablee\x7f\n");
    check_stays_safe();
}

TEST(a_stop_behind_noise_is_a_stop)
{
    static const struct {
        const char *bytes;
        size_t length;
    } texts[] = {{"\0\ndisable\n", 10},    {"\0disable\ndisable\n", 17}, {"x\0\r\ndisable\r\n", 13},
                 {"\0\0\ndisable\n", 11},  {"\0\1\ndisable\n", 11},      {"\0\377\ndisable\n", 11},
                 {"\0C\1\ndisable\n", 12}, {"ver\0sion\ndisable\n", 17}, {"\200\0\200\ndisable\n", 12},
                 {"\0\n\0\ndisable\n", 12}};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        bench_start(true);
        (void)bench_send(texts[i].bytes, texts[i].length);
        bench_run(25); /* an open frame that goes on for 20 ms without a byte will not become whole */
        CHECK(!fake_status().enabled);
        check_stays_safe();
        bench_run(100);
        CHECK(has_line(bench_say("version\n"), "ok version"));
    }
}

TEST(every_cut_of_a_stop_is_a_stop)
{
    static const char line[] = "disable now\n";
    for (size_t cut = 0; cut < sizeof line; cut++) {
        bench_start(true);
        (void)bench_send(line, cut);
        CHECK(fake_status().enabled == (cut < sizeof line - 1));
        (void)bench_send(line + cut, sizeof line - 1 - cut);
        CHECK(!fake_status().enabled);
    }
}

/* Programs ------------------------------------------------------------------------------------------------------- */

TEST(a_target_on_a_lease_is_stopped_by_a_line_and_by_a_frame)
{
    for (int framed = 0; framed < 2; framed++) {
        bench_start(false);
        enable_leased(stop_number());
        CHECK(fake_status().enabled && fake_status().leased);
        if (framed != 0) {
            say_framed("disable");
        } else {
            (void)bench_say("disable\n");
        }
        check_stays_safe();
        CHECK(fake_status().fault == EPG_FAULT_NONE);
        CHECK_EQUAL(fake_status().stop_source, framed != 0 ? EPG_STOP_FRAME : EPG_STOP_LINE);
    }
}

TEST(a_program_that_does_not_know_the_newest_stop_is_refused)
{
    bench_start(true);
    const uint64_t old = stop_number();
    fake.stop = true;
    bench_run(5);
    fake.stop = false;
    CHECK(fake_status().fault == EPG_FAULT_MODEL_STOPPED);
    enable_leased(old);
    check_stays_safe();
    CHECK(fake_status().fault == EPG_FAULT_MODEL_STOPPED);
    enable_leased(old + 1);
    CHECK(fake_status().enabled);
}

TEST(a_program_that_knows_a_stop_of_another_boot_is_refused)
{
    bench_start(false);
    for (unsigned int bit = 32; bit < 64; bit++) {
        enable_leased(stop_number() ^ (uint64_t)1 << bit);
        check_stays_safe();
    }
    enable_leased(stop_number());
    CHECK(fake_status().enabled);
}

TEST(a_program_must_name_a_stop_and_say_if_it_uses_a_lease)
{
    char line[64];
    bench_start(false);
    (void)snprintf(line, sizeof line, "enable after=%08x-%u", (unsigned int)(stop_number() >> 32U),
                   (unsigned int)stop_number());
    static const char *const lines[] = {"enable",
                                        "enable leased",
                                        "enable unattended",
                                        "enable leased after=1",
                                        "enable leased after=01234567-",
                                        "enable leased after=01234567-x"};
    say_framed(line);
    check_stays_safe();
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        say_framed(lines[i]);
        check_stays_safe();
    }
    (void)snprintf(line, sizeof line, "enable unattended after=%08x-%u", (unsigned int)(stop_number() >> 32U),
                   (unsigned int)stop_number());
    say_framed(line);
    CHECK(fake_status().enabled && !fake_status().leased);
    bench_run(1000);
    CHECK(fake_status().enabled);
}

TEST(a_program_that_goes_away_with_a_movement_by_hand_is_not_a_stop)
{
    bench_start(false);
    const uint64_t number = stop_number();
    (void)bench_say("jog motor 0.1 1000\n");
    CHECK(fake.actuator > 0.0);
    bench.connected = false;
    bench_run(5);
    CHECK_EQUAL(fake.actuator, 0.0);
    CHECK_EQUAL(stop_number(), number);
    check_stays_safe();
}

RUN()
