/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Moving one actuator of a disabled target for a short time: first light on a new robot.
 *
 * While it lasts the model rests and nothing else is driven; afterwards the model is initialised again.  Any request
 * to enable or disable, any fault, and the fail-safe input end it within one cycle.
 */
#ifndef EPG_JOG_H
#define EPG_JOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/handover.h"

/** An actuator that can be moved.  Functions of both run on the control side. */
typedef struct epg_jog_actuator {
    const char *name;           /**< of the component */
    void (*drive)(double duty); /**< as the model would; every cycle while it lasts */
} epg_jog_actuator_t;

/** A sensor whose movement is reported. */
typedef struct epg_jog_encoder {
    const char *name;         /**< of the component */
    int64_t (*count)(void);   /**< edges so far, as sampled last */
    double (*position)(void); /**< what they mean, in `unit` */
    const char *unit;
} epg_jog_encoder_t;

/** Where an encoder was. */
typedef struct epg_jog_reading {
    int64_t count;
    double position;
} epg_jog_reading_t;

typedef enum epg_jog_end {
    EPG_JOG_DONE,
    EPG_JOG_REFUSED, /**< the target is enabled, or its fail-safe input inactive */
    EPG_JOG_STOPPED  /**< a request, a fault or the fail-safe input ended it */
} epg_jog_end_t;

/** The generator sets the first block of members. */
typedef struct epg_jog {
    size_t actuator_count;
    const epg_jog_actuator_t *actuators;
    size_t encoder_count;
    const epg_jog_encoder_t *encoders;
    epg_jog_reading_t *first; /**< `encoder_count`: readings at the beginning and at the end */
    epg_jog_reading_t *last;

    epg_handover_t handover; /**< of the readings and of what follows, but for `stop` */
    size_t actuator;
    double duty;
    uint32_t cycles; /**< that it lasts; at the end: that it lasted */
    epg_jog_end_t end;

    bool stop;        /**< the control side's: nothing may be driven in this cycle */
    bool running;     /**< the control side's */
    uint32_t elapsed; /**< the control side's: cycles driven so far */
} epg_jog_t;

/** Ends a movement that a stop of the control loop has left.  While neither side is active. */
void epg_jog_clear(epg_jog_t *jog);

/* Control side ----------------------------------------------------------------------------------------------- */

/**
 * After sensors have been sampled: drives the actuator, if one is to be.  `enabled`: the target is.  Returns true if
 * it drove, and then no model may step and no other output be written.
 */
bool epg_jog_cycle(epg_jog_t *jog, bool enabled);

/* Communication side ----------------------------------------------------------------------------------------- */

/** True while nothing is being moved; after epg_jog_start() that is when the result can be read. */
bool epg_jog_idle(epg_jog_t *jog);

/** Asks to drive actuator `index` with `duty` for `cycles` control cycles; false while one is moving. */
bool epg_jog_start(epg_jog_t *jog, size_t index, double duty, uint32_t cycles);

#endif
