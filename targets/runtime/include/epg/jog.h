/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Moving one actuator of a disabled target by hand, for a short time: the first test of a new robot's wiring.
 *
 * During a movement the model is not stepped, and no other actuator is driven.  Afterwards the model is initialised
 * again.  Enabling, a stop, a fault, or the fail-safe input ends the movement within one cycle.  The
 * encoders are read before and after it, so that the user sees which encoder has moved, and how far.
 */
#ifndef EPG_JOG_H
#define EPG_JOG_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/handover.h"

/** An actuator that can be moved.  The function runs on the control side. */
typedef struct epg_jog_actuator {
    const char *name;           /**< name of the component */
    void (*drive)(double duty); /**< drives with `duty`, -1 ... 1; runs in every cycle of a movement */
    double (*applied)(void);    /**< the present duty, -1 ... 1; NULL: unknown */
} epg_jog_actuator_t;

/** An encoder whose movement is reported.  The functions run on the control side. */
typedef struct epg_jog_encoder {
    const char *name;         /**< name of the component */
    int64_t (*count)(void);   /**< number of edges, as sampled last */
    double (*position)(void); /**< position in `unit`, as sampled last */
    const char *unit;
} epg_jog_encoder_t;

/** The reading of an encoder. */
typedef struct epg_jog_reading {
    int64_t count;
    double position;
} epg_jog_reading_t;

/** How a movement ended. */
typedef enum epg_jog_end {
    EPG_JOG_DONE,    /**< after the requested time, or at the end of its lease */
    EPG_JOG_REFUSED, /**< never started: the target is enabled, or its fail-safe input is inactive */
    EPG_JOG_STOPPED  /**< early: by a request, a fault or the fail-safe input */
} epg_jog_end_t;

/** A number of cycles: the movement lasts until the lease ends, which epg_control_extend() must have been told before. */
enum { EPG_JOG_LEASED = 0 };

/** The state of movements.  The generator sets the first block of members. */
typedef struct epg_jog {
    size_t actuator_count;
    const epg_jog_actuator_t *actuators;
    size_t encoder_count;
    const epg_jog_encoder_t *encoders;
    epg_jog_reading_t *first; /**< `encoder_count` readings at the start of the movement */
    epg_jog_reading_t *last;  /**< `encoder_count` readings at its end */
    double *values;           /**< memory of epg_jog_observe(): a value for each actuator, then for each encoder */

    epg_handover_t handover; /**< of the readings and of the members below */
    size_t actuator;
    double duty;
    bool leased;     /**< the movement was requested with EPG_JOG_LEASED */
    uint32_t cycles; /**< requested duration in control cycles; after the end, the real duration */
    epg_jog_end_t end;

    bool running;     /**< control side: a movement is in progress */
    uint32_t elapsed; /**< control side: cycles driven so far */
} epg_jog_t;

/** Ends a movement that was left when the control loop stopped.  Must be called only while neither side is active. */
void epg_jog_clear(epg_jog_t *jog);

/* Control side ----------------------------------------------------------------------------------------------- */

/**
 * Drives the requested actuator, if there is a request.  Called in every cycle after the sensors were sampled.
 * `permitted` is false while the target is enabled, and after a stop or a fault (epg_gate_move()): a movement ends then.
 * `over` is true if the lease has ended: a movement that was requested on the lease ends then.
 * If the result is true, the actuator was driven; the caller must then neither step the model nor write another output.
 */
bool epg_jog_cycle(epg_jog_t *jog, bool permitted, bool over);

/**
 * Copies the present duties of the actuators and the positions of the encoders to `values`, for a stream.  They are
 * those of any cycle, with or without a movement by hand.  Called only while a stream runs.
 */
void epg_jog_observe(const epg_jog_t *jog);

/* Communication side ----------------------------------------------------------------------------------------- */

/** Returns true while no movement is requested or in progress.  Only then can the result of the last one be read. */
bool epg_jog_idle(epg_jog_t *jog);

/**
 * Requests to drive actuator `index` with `duty` (-1 ... 1) for `cycles` control cycles, or on the lease
 * (EPG_JOG_LEASED).  Returns false if there is no such actuator, or while a movement is in progress.  A program that
 * extends the lease moves an actuator as long as a key is pressed, and the actuator stops soon after the program or its
 * connection has failed.
 */
bool epg_jog_start(epg_jog_t *jog, size_t index, double duty, uint32_t cycles);

/** Returns true while actuator `index` is moved with `duty` on the lease: extending the lease prolongs the movement. */
bool epg_jog_is_leased(epg_jog_t *jog, size_t index, double duty);

#endif
