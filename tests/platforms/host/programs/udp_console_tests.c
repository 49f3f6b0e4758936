/**
 * @file
 * The console by UDP: the order of commands and stops of several clients, and the key.
 */
#include "check.h"
#include "console_bench.h"
#include "fake_application.h"
#include "fake_port.h"
#include "udp_client.h"

/** Returns true if the target is enabled after all that waits has acted. */
static bool ends_enabled(void)
{
    bench_run(30);
    return fake_status().enabled;
}

/* Stops ---------------------------------------------------------------------------------------------------------- */

TEST(a_stop_of_another_client_wins_against_what_arrived_before_it)
{
    static const char *const lines[] = {"enable", "jog motor 0.1 500", "a/set=4"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        target_open(false);
        client_t user = client_join();
        client_t other = client_join();
        client_say(&user, "version");
        bench_run(10);
        client_say(&user, lines[i]);
        client_say(&other, "disable");
        CHECK(!ends_enabled());
        CHECK_EQUAL(bench.count, 0); /* the encoder */
        CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 0.0);
        CHECK(client_hears(&user, " refused: stopped by other"));
        CHECK(client_hears(&other, "ok disable\r\n"));
        client_say(&user, "enable");
        CHECK(ends_enabled());
        target_close();
    }
}

TEST(a_stop_of_another_client_wins_though_a_line_waits_for_an_answer)
{
    target_open(false);
    client_t user = client_join();
    client_t other = client_join();
    bench.frozen = true;
    client_say(&user, "set p2=1"); /* its answer needs a cycle */
    bench_run(5);
    client_say(&user, "enable");
    bench_run(5);
    client_say(&other, "disable");
    client_say(&user, "set p3=1"); /* the console reads it while the line before it waits */
    bench_run(5);
    bench.frozen = false;
    CHECK(!ends_enabled());
    CHECK(client_hears(&user, "error enable refused: stopped by other"));
}

TEST(what_arrives_after_a_stop_acts)
{
    target_open(false);
    client_t user = client_join();
    client_t other = client_join();
    client_say(&user, "enable");
    client_say(&other, "disable");
    client_say(&user, "enable");
    CHECK(ends_enabled());
    client_say(&other, "disable");
    client_say(&user, "enable");
    bench_run(6); /* it acts in the first or second cycle after the disabled ones */
    CHECK(fake_status().enabled);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_OTHER);
}

TEST(stops_of_the_user_are_in_order_with_its_lines)
{
    target_open(false);
    client_t user = client_join();
    client_say(&user, "enable");
    client_say(&user, "disable");
    CHECK(!ends_enabled());
    client_say(&user, "disable");
    client_say(&user, "enable");
    CHECK(ends_enabled());
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_LINE);
    client_say(&user, "disable\nenable\ndisable");
    CHECK(!ends_enabled());
    client_say(&user, "enable\n disable it\n\tenable");
    CHECK(ends_enabled());
}

TEST(stops_of_a_program_are_in_order_with_its_commands)
{
    target_open(false);
    client_t user = client_join();
    client_t other = client_join();
    client_begin(&user);
    client_enable(&user);
    client_send_program(&other, EPG_HOST_UDP_DISABLE, 0, NULL, 0);
    CHECK(!ends_enabled());
    CHECK_EQUAL(client_flags(&other), EPG_HOST_UDP_DISABLED);
    client_enable(&user);
    client_command(&user, "disable");
    CHECK(!ends_enabled());
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_FRAME);
    client_enable(&user);
    CHECK(ends_enabled());
    client_command(&user, "disable");
    bench_run(2);
    client_enable(&user);
    CHECK(ends_enabled());
    client_command(&user, "jog motor 0.1 500");
    client_command(&other, "disable");
    CHECK(!ends_enabled());
    CHECK_EQUAL(bench.count, 0);
}

TEST(a_line_that_spans_datagrams_is_a_stop)
{
    target_open(false);
    client_t user = client_join();
    client_begin(&user);
    client_enable(&user);
    CHECK(ends_enabled());
    client_send_program(&user, 0, 0, "help\nhelp\n dis", 14);
    bench_run(1);
    client_send_program(&user, 0, 0, "able it\n", 8);
    bench_run(2);
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_LINE);
    client_enable(&user);
    CHECK(ends_enabled());
    client_send_program(&user, 0, 0, "\0\ndisable\n", 10); /* in a frame that does not become whole */
    bench_run(25);
    CHECK(!fake_status().enabled);
}

TEST(every_form_of_a_stop_acts_for_every_sender)
{
    static const char *const texts[] = {"disable",    "disable\n",           "\t disable now\r",
                                        "x\ndisable", "\x80\xff\ndisable\n", "get\ndisable\nget\n"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0] + 3; i++) {
        for (int keyed = 0; keyed < 2; keyed++) {
            target_open(keyed != 0);
            client_t user = client_join();
            client_t other = client_join();
            if (keyed != 0) {
                client_take_key(&user, CLIENT_KEY);
            }
            client_begin(&user);
            client_enable(&user);
            CHECK(ends_enabled());
            if (i < sizeof texts / sizeof texts[0]) {
                client_send(&other, texts[i], strlen(texts[i]));
            } else if (i == sizeof texts / sizeof texts[0]) {
                client_command(&other, "disable");
            } else if (i == sizeof texts / sizeof texts[0] + 1) {
                client_send_program(&other, EPG_HOST_UDP_BEGIN, 0, "\0disable\n", 9);
            } else {
                client_take_key(&other, "ffffffffffffffffffffffffffffffff");
                client_send_program(&other, EPG_HOST_UDP_DISABLE, 0, NULL, 0);
            }
            bench_run(2);
            CHECK(!fake_status().enabled);
            CHECK_EQUAL(fake_status().stop_source, EPG_STOP_OTHER);
            CHECK(client_receive(&other) > 0);
            target_close();
        }
    }
}

TEST(everyone_who_stops_is_answered_at_once)
{
    enum { CLIENTS = 200 };
    static client_t others[CLIENTS];
    target_open(false);
    client_t user = client_join();
    client_begin(&user);
    for (size_t i = 0; i < CLIENTS; i++) {
        others[i] = client_join();
        if (i % 2 == 0) {
            client_say(&others[i], "disable");
        } else {
            client_send_program(&others[i], EPG_HOST_UDP_DISABLE, 0, NULL, 0);
        }
    }
    bench_poll();
    for (size_t i = 0; i < CLIENTS; i++) {
        if (i % 2 == 0) {
            CHECK(client_hears(&others[i], "ok disable\r\n"));
        } else {
            CHECK_EQUAL(client_flags(&others[i]), EPG_HOST_UDP_DISABLED);
        }
    }
}

TEST(a_stop_acts_though_the_users_bytes_have_no_room)
{
    target_open(false);
    client_t user = client_join();
    client_t other = client_join();
    client_say(&user, "enable");
    CHECK(ends_enabled());
    for (int i = 0; i < 250; i++) { /* of more than one batch, so that a later stop is in a later poll */
        client_say(&user, "a/set=4 set_b=5 a/set=4 set_b=5 a/set=4 set_b=5");
    }
    client_say(&user, "disable");
    bench_run(2);
    CHECK(!fake_status().enabled);
    bench_run(500);
    client_say(&user, "enable");
    CHECK(ends_enabled());
    CHECK_EQUAL(fake_status().stop_source, EPG_STOP_LINE);
    client_say(&other, "disable");
    CHECK(!ends_enabled());
}

/** Lets one client flood the target, and another one stop it every 5 ms.  Returns the cycles from the first stop on. */
static unsigned int cycles_until_stopped(client_t *flooder, client_t *other, const void *data, size_t size)
{
    enum { BEFORE = 20, MOST = 1000 };
    const int flood = size < 300 ? 200 : 60; /* as many as a socket of Linux holds without a setting */
    for (unsigned int cycle = 0; cycle < BEFORE + MOST; cycle++) {
        for (int i = 0; i < flood; i++) {
            if (cycle >= BEFORE && cycle % 5 == 0 && i == flood - 10) { /* if the socket was full, it would be lost */
                client_say(other, "disable");
            }
            client_send(flooder, data, size);
        }
        bench_run(1);
        CHECK(cycle >= BEFORE || fake_status().enabled);
        if (cycle >= BEFORE && !fake_status().enabled) {
            return cycle - BEFORE;
        }
    }
    return MOST;
}

TEST(a_flood_does_not_keep_a_stop_from_acting)
{
    unsigned char bytes[1400] = {0};
    for (int kind = 0; kind < 5; kind++) {
        target_open(false);
        client_t user = client_join();
        client_t flooder = client_join();
        client_t other = client_join();
        client_say(&user, "enable");
        CHECK(ends_enabled());
        client_t *from = kind < 2 ? &user : &flooder;
        const epg_host_udp_header_t header = {.flags = EPG_HOST_UDP_BEGIN, .session = 99};
        if (kind == 2) {
            epg_host_udp_write_header(bytes, &header);
        }
        const bool text = kind == 0 || kind == 3;
        const unsigned int cycles = text ? cycles_until_stopped(from, &other, "enable\n", 7)
                                         : cycles_until_stopped(from, &other, bytes, kind == 4 ? 0 : sizeof bytes);
        CHECK(cycles <= 50);
        target_close();
    }
}

TEST(a_client_that_leaves_does_not_act_for_the_next_one)
{
    target_open(false);
    client_t user = client_join();
    client_t next = client_join();
    client_begin(&user);
    client_enable(&user);
    client_send_program(&user, EPG_HOST_UDP_END, 0, NULL, 0);
    client_send_program(&next, EPG_HOST_UDP_BEGIN, 0, NULL, 0); /* in the same poll */
    CHECK(!ends_enabled());
    CHECK_EQUAL(client_flags(&next), EPG_HOST_UDP_RUNNING);
    client_send_program(&user, EPG_HOST_UDP_BEGIN, 0, NULL, 0);
    bench_run(5);
    CHECK_EQUAL(client_flags(&user), EPG_HOST_UDP_OVER);
    client_enable(&next);
    CHECK(ends_enabled());
}

/* Keys ----------------------------------------------------------------------------------------------------------- */

static client_t join_with_key(void)
{
    client_t client = client_join();
    client_take_key(&client, CLIENT_KEY);
    return client;
}

TEST(without_the_key_only_disable_acts)
{
    target_open(true);
    client_t person = client_join();
    client_t plain = client_join();
    client_t wrong = client_join();
    client_t user = join_with_key();
    client_say(&person, "enable");
    client_say(&person, "a/set=4");
    client_send_program(&plain, EPG_HOST_UDP_BEGIN, 0, NULL, 0);
    client_enable(&plain);
    client_take_key(&wrong, "00112233445566778899aabbccddeefe");
    client_send_program(&wrong, EPG_HOST_UDP_BEGIN, 0, NULL, 0);
    client_enable(&wrong);
    CHECK(!ends_enabled());
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 0.0);
    CHECK(client_hears(&person, "error line this console needs a key: only disable acts\r\n"));
    CHECK_EQUAL(client_flags(&plain), EPG_HOST_UDP_LOCKED);
    CHECK_EQUAL(client_receive(&plain), 0);
    CHECK_EQUAL(client_flags(&wrong), EPG_HOST_UDP_LOCKED);
    CHECK_EQUAL(client_receive(&wrong), 0);
    client_begin(&user);
    client_enable(&user);
    CHECK(ends_enabled());
    client_say(&person, "disable");
    CHECK(!ends_enabled());
    CHECK(client_hears(&person, "ok disable\r\n"));
}

TEST(the_answer_to_a_stop_proves_the_key)
{
    target_open(true);
    client_t user = join_with_key();
    client_begin(&user);
    client_enable(&user);
    CHECK(ends_enabled());
    client_t other = join_with_key(); /* it knows no number of the target */
    client_send_program(&other, EPG_HOST_UDP_DISABLE, 0, NULL, 0);
    bench_poll();
    CHECK_EQUAL(client_flags(&other), EPG_HOST_UDP_DISABLED);
    CHECK(epg_host_udp_is_sealed(other.got, other.got_size));
    CHECK(!ends_enabled());
}

TEST(a_second_user_is_told_so)
{
    target_open(true);
    client_t user = join_with_key();
    client_t other = join_with_key();
    client_begin(&user);
    client_send_program(&other, EPG_HOST_UDP_BEGIN, 0, NULL, 0);
    bench_run(1);
    CHECK_EQUAL(client_flags(&other), EPG_HOST_UDP_AGAIN);
    unsigned char key[EPG_HOST_UDP_KEY];
    CHECK(epg_host_udp_key_read(CLIENT_KEY, key));
    epg_host_udp_seal_derive(&other.seal, key, epg_host_udp_seal_of_program(other.got),
                             epg_host_udp_seal_of_target(other.got));
    client_send_program(&other, EPG_HOST_UDP_BEGIN, 0, NULL, 0);
    bench_run(1);
    CHECK_EQUAL(client_flags(&other), EPG_HOST_UDP_TAKEN);
    client_enable(&other);
    CHECK(!ends_enabled());
    client_enable(&user);
    CHECK(ends_enabled());
}

enum { RECORDED = 8 };
static unsigned char recorded[RECORDED][CLIENT_LONGEST];
static size_t recorded_sizes[RECORDED];

static void record(size_t index, const client_t *client)
{
    memcpy(recorded[index], client->sent, client->sent_size);
    recorded_sizes[index] = client->sent_size;
}

TEST(recorded_datagrams_do_nothing_after_a_restart)
{
    target_open(true);
    client_t user = join_with_key();
    client_send_program(&user, EPG_HOST_UDP_BEGIN, 0, NULL, 0);
    record(0, &user);
    bench_run(1);
    CHECK_EQUAL(client_flags(&user), EPG_HOST_UDP_AGAIN);
    client_begin(&user);
    record(1, &user);
    client_enable(&user); /* the numbers of stops are the same after the restart, because time is simulated */
    record(2, &user);
    client_command(&user, "a/set=4");
    record(3, &user);
    CHECK(ends_enabled());
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 4.0);
    target_close();

    target_open(true);
    client_t thief = client_join();
    for (int round = 0; round < 3; round++) {
        for (size_t i = 0; i < 4; i++) {
            client_send(&thief, recorded[i], recorded_sizes[i]);
            bench_run(3);
        }
    }
    CHECK(!ends_enabled());
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 0.0);
    client_t next = join_with_key();
    client_begin(&next);
    client_enable(&next);
    CHECK(ends_enabled());
}

TEST(a_datagram_acts_once)
{
    target_open(true);
    client_t user = join_with_key();
    client_begin(&user);
    static const unsigned char lines[3][8] = {"a/set=4\n", "a/set=5\n", "a/set=6\n"};
    for (size_t i = 0; i < 3; i++) { /* without a number, so that only the counter can tell */
        client_send_program(&user, 0, 0, lines[i], sizeof lines[i]);
        record(i, &user);
        bench_run(5);
    }
    for (size_t i = 0; i < 3; i++) {
        client_send(&user, recorded[i], recorded_sizes[i]);
        bench_run(5);
        CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 6.0);
    }
    client_command(&user, "disable");
    record(0, &user);
    bench_run(3);
    client_enable(&user);
    CHECK(ends_enabled());
    client_send(&user, recorded[0], recorded_sizes[0]); /* the network repeats it */
    CHECK(ends_enabled());
}

TEST(datagrams_that_overtake_each_other_all_act)
{
    target_open(true);
    client_t user = join_with_key();
    client_begin(&user);
    const int file = user.file;
    client_t nobody = client_join();
    user.file = nobody.file; /* what is sent now arrives later; its sender does not matter, because it is not proven */
    for (size_t i = 0; i < 3; i++) {
        client_command(&user, i == 0 ? "set p2=1" : i == 1 ? "set p3=2" : "set p4=3");
        record(i, &user);
    }
    user.file = file;
    bench_run(5);
    CHECK_EQUAL(bench.model[2], 0.0);
    for (size_t i = 3; i > 0; i--) {
        client_send(&user, recorded[i - 1], recorded_sizes[i - 1]);
    }
    bench_run(30);
    CHECK_EQUAL(bench.model[2], 1.0);
    CHECK_EQUAL(bench.model[3], 2.0);
    CHECK_EQUAL(bench.model[4], 3.0);
}

TEST(datagrams_that_come_back_do_not_count)
{
    target_open(true);
    client_t user = join_with_key();
    client_begin(&user);
    client_command(&user, "stats");
    for (int i = 0; i < 5000; i++) { /* each datagram of the target comes back, from the right address */
        while (client_receive(&user) > 0) {
            client_send(&user, user.got, user.got_size);
        }
        bench_poll();
    }
    client_t next = join_with_key();
    client_begin(&next); /* the silent user has left the target */
}

TEST(forged_answers_do_not_keep_a_lease)
{
    char line[80];
    target_open(true);
    client_t user = join_with_key();
    client_begin(&user);
    const uint64_t number = fake_status().stop_number;
    (void)snprintf(line, sizeof line, "enable leased after=%08x-%u", (unsigned int)(number >> 32U),
                   (unsigned int)number);
    client_command(&user, line);
    bench_run(30);
    CHECK(fake_status().enabled);
    client_t forger = user; /* it has the address and sees each datagram, but does not have the key */
    forger.seal.key[0] ^= 1U;
    for (int i = 0; i < 800; i++) {
        unsigned char body[64];
        while (client_receive(&user) > 0) {
            const size_t head = EPG_HOST_UDP_SEAL + EPG_HOST_UDP_HEADER;
            const size_t size = user.got_size - head < sizeof body ? user.got_size - head : sizeof body;
            memcpy(body, user.got + head, size);
            body[2 < size ? 2 : 0] = 'R'; /* the number of the target goes back, in a frame of the right form */
            client_send_program(&forger, 0, 0, body, size);
        }
        bench_poll();
    }
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake_status().fault, EPG_FAULT_OPERATOR);
}

/* Any bytes ------------------------------------------------------------------------------------------------------ */

static uint32_t chance(void)
{
    static uint32_t state = 2463534242U; /* xorshift: G. Marsaglia, "Xorshift RNGs", 2003 */
    state ^= state << 13U;
    state ^= state >> 17U;
    state ^= state << 5U;
    return state;
}

/** Damages a datagram.  Returns its new size. */
static size_t mutate(unsigned char *data, size_t size)
{
    const uint32_t kind = chance() % 8;
    if (kind == 0) {
        return chance() % (size + 1); /* the end is missing */
    }
    if (kind == 1) {
        const size_t more = chance() % 64;
        for (size_t i = 0; i < more; i++) {
            data[size + i] = (unsigned char)chance();
        }
        return size + more;
    }
    for (uint32_t i = 0; i < kind; i++) {
        data[chance() % size] ^= (unsigned char)(1U << chance() % 8);
    }
    return size;
}

static unsigned int mutations(void)
{
    const char *text = getenv("EPG_MUTATIONS");
    return text != NULL ? (unsigned int)strtoul(text, NULL, 10) : 20000;
}

TEST(mutated_datagrams_move_nothing)
{
    target_open(true);
    client_t user = join_with_key();
    client_begin(&user);
    client_t nobody = client_join();
    const int file = user.file;
    user.file = nobody.file; /* the right datagrams are never sent from the right address */
    client_enable(&user);
    record(0, &user);
    client_command(&user, "a/set=4");
    record(1, &user);
    client_command(&user, "jog motor 0.1 500");
    record(2, &user);
    client_send_program(&user, EPG_HOST_UDP_BEGIN, 0, NULL, 0);
    record(3, &user);
    client_send_program(&user, EPG_HOST_UDP_END, 0, NULL, 0);
    record(4, &user);
    user.file = file;
    bench_run(5);
    const unsigned int count = mutations();
    for (unsigned int i = 0; i < count; i++) {
        unsigned char data[1024];
        const size_t which = chance() % 5;
        memcpy(data, recorded[which], recorded_sizes[which]);
        const size_t size = mutate(data, recorded_sizes[which]);
        if (size != recorded_sizes[which] || memcmp(data, recorded[which], size) != 0) {
            client_send(chance() % 4 == 0 ? &nobody : &user, data, size);
        }
        if (i % 64 == 63) {
            bench_poll();
            CHECK(!fake_status().enabled);
        }
        if (i % 2048 == 2047) { /* the user is not silent */
            client_send_program(&user, 0, 0, NULL, 0);
            while (client_receive(&nobody) > 0 || client_receive(&user) > 0) {
            }
        }
    }
    bench_run(5);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 0.0);
    CHECK_EQUAL(bench.count, 0);
    client_command(&user, "set p2=1"); /* it has still the target */
    client_enable(&user);
    CHECK(ends_enabled());
    CHECK_EQUAL(bench.model[2], 1.0);
}

TEST(mutated_datagrams_leave_an_open_target_controllable)
{
    target_open(false);
    client_t user = client_join();
    client_begin(&user);
    const unsigned int count = mutations();
    for (unsigned int i = 0; i < count; i++) {
        unsigned char frame[400];
        client_t one = user;
        one.number = i;
        client_command(&one, i % 3 == 0 ? "get" : i % 3 == 1 ? "a/set=4" : "capture duty rows=5");
        memcpy(frame, one.sent, one.sent_size);
        client_send(&user, frame, mutate(frame, one.sent_size));
        if (i % 64 == 63) {
            bench_poll();
            while (client_receive(&user) > 0) {
            }
        }
    }
    bench_run(3000);
    client_t next = client_join();
    client_begin(&next);
    client_enable(&next);
    CHECK(ends_enabled());
}

RUN()
