/**
 * @file
 * A console on a bench: the fake application as its target, and a stream whose ends a test holds.
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
    size_t room;      /**< bytes that the stream takes until the test sets it again */
    const char *in;   /**< what the stream still has to give */
    size_t in_length; /**< bytes of it */
    char out[65536];  /**< what it has taken, ended by a zero */
    size_t out_length;
    double model[BENCH_PARAMETERS]; /**< parameters as the model has them */
    int64_t count;                  /**< of the encoder */
    bool frozen;                    /**< no control cycles run */
} bench_t;

extern bench_t bench;

/** A console that has just been connected to and has greeted; the target is disabled at first unless `enabled`. */
void bench_start(bool enabled);

/** One poll after half a millisecond of control and communication. */
void bench_poll(void);

/** `milliseconds` of polls, one per half a millisecond. */
void bench_run(unsigned int milliseconds);

/** Sends `text`, polls until all of it is taken and ten milliseconds more; returns what came out since. */
const char *bench_say(const char *text);

/** As bench_say() with bytes. */
const char *bench_send(const void *bytes, size_t size);

/** True if `text` has a line that begins with `begin`. */
bool has_line(const char *text, const char *begin);

#endif
