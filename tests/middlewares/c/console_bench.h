/**
 * @file
 * A console on a test bench.  Its target is the fake application; the test is the other end of its stream.
 */
#ifndef CONSOLE_BENCH_H
#define CONSOLE_BENCH_H

#include <stdbool.h>
#include <stddef.h>

#include "console.h"
#include "epg/node.h"
#include "epg/parameters.h"
#include "epg/store.h"

enum { BENCH_OUTPUT = 1024, BENCH_CAPTURE = 300, BENCH_PARAMETERS = 12 };

typedef struct bench {
    epg_target_t target;
    epg_console_options_t options;
    epg_parameters_t parameters;
    epg_store_t store;
    epg_capture_t capture;
    epg_jog_t jog;

    bool connected;
    size_t room;      /**< bytes that the stream takes until the test sets a new number */
    const char *in;   /**< bytes that the console has not read yet */
    size_t in_length; /**< number of these bytes */
    char out[65536];  /**< bytes that the console has written, ended by a zero */
    size_t out_length;
    double model[BENCH_PARAMETERS]; /**< the model's parameters */
    int64_t count;                  /**< count of the encoder */
    bool frozen;                    /**< no control cycles run */
} bench_t;

extern bench_t bench;

/** Makes a console that was just connected and has sent its greeting; the target is disabled unless `enabled`. */
void bench_start(bool enabled);

/** One poll, after half a millisecond of control and communication. */
void bench_poll(void);

/** Polls for `milliseconds`, once every half a millisecond. */
void bench_run(unsigned int milliseconds);

/** Sends `text`, polls until all of it is read and ten milliseconds more; returns the output since then. */
const char *bench_say(const char *text);

/** bench_say() for bytes. */
const char *bench_send(const void *bytes, size_t size);

/** True if `text` has a line that begins with `begin`. */
bool has_line(const char *text, const char *begin);

#endif
