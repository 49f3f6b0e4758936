/**
 * @file
 * Movements by hand whose commands carry a number that the target has sent.
 */
#include "check.h"
#include "console_bench.h"
#include "fake_application.h"
#include "fake_port.h"
#include "program_bench.h"

/* Sends "jog motor 0.1 250 number=<number>". */
static void move(unsigned char tag, uint32_t number)
{
    char line[64];
    (void)snprintf(line, sizeof line, "jog motor 0.1 250 number=%u", (unsigned int)number);
    command(tag, line);
}

/* The newest number that has arrived; `before`: there was no newer one. */
static uint32_t newest_number(uint32_t before)
{
    size_t at = seen;
    for (message_t number = next('N'); number.length == 5; number = next('N')) {
        before = number_in(&number.bytes[1]);
        at = seen;
    }
    seen = at; /* the answers behind it are still to be read */
    return before;
}

/* Asks for a number, and returns it. */
static uint32_t ask_number(unsigned char tag)
{
    move(tag, 0);
    bench_run(2);
    return newest_number(0);
}

TEST(a_movement_without_a_number_has_its_length_and_is_not_renewed)
{
    begin(false);
    command(1, "jog motor 0.1 100");
    bench_run(80);
    CHECK_EQUAL(fake.actuator, 0.1);
    command(2, "jog motor 0.1 100");
    bench_run(2);
    check_next(2, "error jog an actuator is moving");
    move(3, 0);
    bench_run(2);
    check_next(3, "ok jog");
    move(4, newest_number(0));
    bench_run(2);
    check_next(4, "error jog an actuator is moving");
    bench_run(20);
    CHECK_EQUAL(fake.actuator, 0.0);
}

TEST(a_movement_lasts_while_its_commands_have_new_numbers)
{
    begin(false);
    uint32_t number = ask_number(1);
    CHECK(number != 0);
    CHECK_EQUAL(fake.actuator, 0.0);
    CHECK_EQUAL(bench.count, 0);
    move(2, number);
    for (unsigned char tag = 3; tag < 50; tag++) {
        bench_run(60);
        CHECK_EQUAL(fake.actuator, 0.1);
        const uint32_t newer = newest_number(number);
        CHECK(newer != number);
        number = newer;
        move(tag, number);
        bench_run(2);
        check_next(tag, "ok jog");
    }
    command(50, "jog motor 0.2 250 number=1");
    bench_run(2);
    check_next(50, "error jog the number is too old");
    CHECK_EQUAL(fake.actuator, 0.1);
    bench_run(240);
    CHECK_EQUAL(fake.actuator, 0.1);
    bench_run(10);
    CHECK_EQUAL(fake.actuator, 0.0); /* 250 ms after the last command */
    next('A');                       /* moved encoder ... */
    check_next(2, "ok jog");
}

TEST(a_movement_ends_300_ms_after_its_number_was_sent)
{
    begin(false);
    const uint64_t sent_ns = fake_port.now_ns;
    const uint32_t number = ask_number(1);
    bench_run(150);
    for (unsigned char tag = 2; fake_port.now_ns - sent_ns < 290000000U; tag++) {
        move(tag, number);
        bench_run(5);
        CHECK_EQUAL(fake.actuator, 0.1);
    }
    bench_run((unsigned int)((sent_ns + 302000000U - fake_port.now_ns) / 1000000U));
    CHECK_EQUAL(fake.actuator, 0.0);
    while (next('A').length > 0) {
    }
    move(200, number);
    bench_run(2);
    check_next(200, "error jog the number is too old");
    bench_run(60);
    CHECK_EQUAL(fake.actuator, 0.0);
    move(201, newest_number(0)); /* the target has gone on to send numbers */
    bench_run(2);
    CHECK_EQUAL(fake.actuator, 0.1);
}

/* Each command takes 150 ms to the target; the program ends after it has sent the last of them. */
TEST(commands_that_were_sent_before_the_program_ended_do_not_drive_for_longer)
{
    enum { WAY = 150, PERIOD = 50 };
    begin(false);
    uint32_t under_way[WAY / PERIOD] = {0};
    uint64_t ended_ns = 0;
    for (unsigned int i = 0; i < 40; i++) {
        under_way[i % (WAY / PERIOD)] = newest_number(under_way[(i + WAY / PERIOD - 1) % (WAY / PERIOD)]);
        ended_ns = fake_port.now_ns;
        bench_run(PERIOD);
        move((unsigned char)(1 + i), under_way[(i + 1) % (WAY / PERIOD)]);
        CHECK_EQUAL(fake.actuator, i > 8 ? 0.1 : fake.actuator);
    }
    for (unsigned int i = 40; i < 42; i++) {
        bench_run(PERIOD);
        move((unsigned char)(1 + i), under_way[(i + 1) % (WAY / PERIOD)]);
    }
    CHECK_EQUAL(fake.actuator, 0.1);
    bench_run((unsigned int)((ended_ns + 302000000U - fake_port.now_ns) / 1000000U));
    CHECK_EQUAL(fake.actuator, 0.0);
}

TEST(a_movement_does_not_prolong_another_one)
{
    begin(false);
    const uint32_t first = ask_number(1);
    move(2, first);
    bench_run(150);
    for (unsigned int i = 0; i < 10; i++) {
        char line[64];
        (void)snprintf(line, sizeof line, "jog motor -0.1 250 number=%u", (unsigned int)newest_number(first));
        command(3, line);
        bench_run(8);
    }
    CHECK_EQUAL(fake.actuator, 0.1);
    bench_run(20);
    CHECK_EQUAL(fake.actuator, 0.0);
}

TEST(numbers_that_were_not_sent_move_nothing)
{
    begin(false);
    const uint32_t number = ask_number(1);
    for (unsigned int ahead = 1; ahead < 40; ahead++) {
        move(2, number + ahead);
        move(2, number - ahead);
        move(2, 0);
    }
    bench_run(5);
    CHECK_EQUAL(bench.count, 0);
}

TEST(a_number_in_a_line_of_text_moves_nothing)
{
    begin(false);
    (void)ask_number(1);
    bench_run(2100); /* the program is gone */
    CHECK(strcmp(bench_say("jog motor 0.1 250 number=1\n"), "error jog a number is for programs that use frames\r\n") ==
          0);
    CHECK(strcmp(bench_say("jog motor 0.1 250 1\n"), "error jog use jog <actuator> <duty> <ms>\r\n") == 0);
    CHECK_EQUAL(bench.count, 0);
}

TEST(a_stop_ends_a_movement_with_a_number)
{
    begin(false);
    move(2, ask_number(1));
    bench_run(20);
    CHECK_EQUAL(fake.actuator, 0.1);
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycle();
    CHECK_EQUAL(fake.actuator, 0.0);
    bench_run(2);
    while (next('A').length > 0) {
    }
    CHECK(!fake_status().enabled);
}

TEST(numbers_of_a_movement_end_with_it)
{
    begin(false);
    move(2, ask_number(1));
    bench_run(310);
    (void)newest_number(0);
    bench_run(1000);
    CHECK_EQUAL(newest_number(0), 0);
}

RUN()
