/**
 * @file
 * A program at the console on the bench: it encodes and decodes frames by itself.  For one test file per program.
 */
#ifndef PROGRAM_BENCH_H
#define PROGRAM_BENCH_H

#include <stdlib.h>

#include "check.h"
#include "console_bench.h"
#include "fake_application.h"
#include "fake_port.h"
#include "frames.h"

typedef struct message {
    unsigned char bytes[LONGEST];
    size_t length; /* 0: there was none */
} message_t;

static epg_telemetry_t telemetry;
static size_t seen; /* output bytes that the test has decoded */

static void send(const void *message, size_t length)
{
    unsigned char frame[LONGEST + 16];
    const size_t size = encode(message, length, frame);
    bench.in = (const char *)frame;
    bench.in_length = size;
    while (bench.in_length > 0) {
        bench_poll();
    }
}

static void command(unsigned char tag, const char *line)
{
    unsigned char message[LONGEST] = {'C', tag};
    memcpy(message + 2, line, strlen(line));
    send(message, 2 + strlen(line));
}

/* The next message of the console that begins with `type`; other messages are skipped. */
static message_t next(char type)
{
    for (;;) {
        message_t message = {.length = 0};
        const unsigned char *out = (const unsigned char *)bench.out;
        while (seen < bench.out_length && out[seen] == 0) {
            seen++;
        }
        size_t end = seen;
        while (end < bench.out_length && out[end] != 0) {
            end++;
        }
        if (end == bench.out_length) {
            return message;
        }
        while (seen < end) {
            const size_t code = out[seen++];
            CHECK(seen + code - 1 <= end);
            memcpy(&message.bytes[message.length], &out[seen], code - 1);
            message.length += code - 1;
            seen += code - 1;
            if (code < 255 && seen < end) {
                message.bytes[message.length++] = 0;
            }
        }
        CHECK(message.length > 4);
        message.length -= 4;
        uint32_t crc = 0;
        for (unsigned int i = 0; i < 4; i++) {
            crc |= (uint32_t)message.bytes[message.length + i] << 8U * i;
        }
        CHECK_EQUAL(crc, crc_of(message.bytes, message.length));
        message.bytes[message.length] = 0;
        if (message.bytes[0] == (unsigned char)type) {
            return message;
        }
    }
}

static uint32_t number_in(const unsigned char *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

/* Checks that the next answer has this tag and text. */
static void check_next(unsigned char tag, const char *text)
{
    const message_t answer = next('A');
    if (answer.length < 2 || answer.bytes[1] != tag || strcmp((const char *)answer.bytes + 2, text) != 0) {
        fprintf(stderr, "%u %s, not %u %s\n", answer.bytes[1], (const char *)answer.bytes + 2, tag, text);
        exit(1);
    }
}

/* A console with streams, connected to a program that has sent its first frame. */
static void begin(bool enabled)
{
    bench_start(enabled);
    telemetry = (epg_telemetry_t){0};
    fake.application.telemetry = &telemetry;
    seen = bench.out_length;
    send("K", 1);
}

#endif
