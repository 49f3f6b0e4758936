/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Stopping a target, and enabling it again.
 *
 * A stop must win against every enable that was requested before it, in whatever queue that enable still waits.  Stops
 * come from contexts that do not know each other: a line of text, a datagram, a topic, threads and interrupts of the
 * user's program, faults.  A newest-value word cannot carry them, because a later enable would replace a stop that the
 * control side has not seen.  A shared counter loses stops, because two contexts can write the same sum.  Locks and
 * read-modify-write instructions do not exist on a Cortex-M0+ with two cores.
 *
 * So a stop is a latch.  It stores constants only; any number of contexts can store the same constant at once:
 *
 * 1. epg_stop() clears all requests to enable, closes the gates, and then sets `pending`.  Only the control side clears
 *    `pending`.
 * 2. The control cycle looks for a request first and at `pending` last.  If `pending` is set, this cycle and the next
 *    one are disabled.  The next one begins after each stop that was stored while the first one cleared the word.
 * 3. A request that was made after the stop waits in its word until these cycles are over.
 *
 * A *gate* is for a context that finds requests in a queue, such as the bytes of a serial port.  It opens its gate
 * before it reads the queue, and a stop closes it.  What the next poll reads has arrived after the gate was opened.  If
 * the gate is closed then, a stop came after some of these requests, so none of them may move the target.
 *
 *     bool clean = epg_gate_poll(control, EPG_GATE_CONSOLE);     // before the bytes are read
 *     ...
 *     if (clean) { epg_gate_enable(control, EPG_GATE_CONSOLE, EPG_ENABLE_ANY); }
 *
 * Each stop and each latched fault has a number.  An enable can name the newest one that its sender knew
 * (epg_enable_after()); it does not act after another one.
 *
 * tests/runtime/stop.pml is the same algorithm for a model checker.
 */
#ifndef EPG_STOP_H
#define EPG_STOP_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "epg/status.h"

#ifdef __cplusplus
extern "C" {
#endif

struct epg_control;

/** The contexts that request enabling.  Each has a word of its own, which only it sets. */
typedef enum epg_gate {
    EPG_GATE_CONSOLE,
    EPG_GATE_SERVICE, /**< services of the node */
    EPG_GATE_TOPIC,   /**< messages of the topic that enables the target */
    EPG_GATE_EDGE,    /**< a message `true` after a `false` of that topic; opened by the `false` (epg/node.h) */
    EPG_GATES,
    EPG_GATE_PROGRAM = EPG_GATES, /**< the user's program, from any context.  It has no queue: always open */
    EPG_GATE_PROGRAM_AFTER,       /**< the same, with a number */
    EPG_REQUESTS
} epg_gate_t;

/** Bits of a request to enable.  0: no request.  The bits above are the number that it names, or its own count. */
enum {
    EPG_ENABLE_ANY = 1,    /**< a request; without EPG_ENABLE_AFTER, it may follow any stop */
    EPG_ENABLE_LEASED = 2, /**< the target stays enabled only until the lease ends (epg_control_extend()) */
    EPG_ENABLE_AFTER = 4,  /**< it acts only if the newest stop has the number that it names */
    EPG_ENABLE_SHIFT = 3
};

/** Control cycles from a request until its result is known. */
enum {
    EPG_REQUEST_SEEN = 2, /**< a cycle that was under way may end without it; the cycle after that has seen it */
    EPG_REQUEST_OVER = 4  /**< a request to enable has acted or never will: after a stop, it waits for two more */
};

/** The words of the latch.  All zero is a valid state: nothing is requested, and no queue was read yet. */
typedef struct epg_latch {
    atomic_uint pending;                /**< 1: a stop waits for a cycle.  Only the control side clears it */
    atomic_uint requests[EPG_REQUESTS]; /**< set by the context of the gate, cleared by every stop */
    atomic_uint made[EPG_REQUESTS];     /**< requests so far that name no stop, counted by the context of the gate */
    atomic_uchar closed[EPG_GATES];     /**< set by every stop of another context, cleared by the gate's */
    atomic_uchar moves;                 /**< 1: an actuator may be moved by hand.  Every stop clears it */
    atomic_uchar stopped_by[EPG_STOP_SOURCES]; /**< tells the control side the sources of `pending` */
    unsigned int acted[EPG_REQUESTS];          /**< control side: the newest request of each gate that has acted */
    uint8_t guard;                             /**< control side: cycles that must still be disabled */
} epg_latch_t;

/**
 * Stops the target: a control cycle that begins after this call is disabled as a whole.  Requests to enable that were
 * made before do not act.  May be called from every context, also before the target is started.
 */
void epg_stop(struct epg_control *control, epg_stop_source_t source);

/**
 * Must be called by the context of a gate before it reads its queue.  Returns true if nothing else has stopped the
 * target since the last call; only then may what is read now move the target.  Opens the gate for the next call.
 */
bool epg_gate_poll(struct epg_control *control, epg_gate_t gate);

/** Returns true if nothing else has stopped the target since the gate was opened. */
bool epg_gate_is_open(const struct epg_control *control, epg_gate_t gate);

/** Opens a gate that epg_gate_poll() does not open.  The gate's own context calls it. */
void epg_gate_open(struct epg_control *control, epg_gate_t gate);

/** Closes a gate.  The gate's own context calls it. */
void epg_gate_close(struct epg_control *control, epg_gate_t gate);

/**
 * Requests to enable the target: EPG_ENABLE_ANY or epg_enable_after(), with EPG_ENABLE_LEASED or without.  The request
 * acts in the next cycle, or as soon as the cycles of a stop before it are over.  If a stop or a fault comes first, or
 * the gate is closed, it does not act.  Enabling initialises the model and clears a latched fault.
 */
void epg_gate_enable(struct epg_control *control, epg_gate_t gate, unsigned int request);

/** Returns a request that acts only if `number` is the number of the newest stop (epg_status_t). */
static inline unsigned int epg_enable_after(uint64_t number)
{
    /* The upper half is different after each start of the program. */
    return (unsigned int)EPG_ENABLE_ANY | (unsigned int)EPG_ENABLE_AFTER |
           (unsigned int)(number ^ number >> 32U) << EPG_ENABLE_SHIFT;
}

/**
 * Must be called by the console before it hands over a movement by hand.  Returns false if the movement may not begin:
 * a stop came first.
 */
bool epg_gate_move(struct epg_control *control);

/** Ends a movement by hand.  This is not a stop: requests to enable stay. */
void epg_gate_end_move(struct epg_control *control);

/* Control side ----------------------------------------------------------------------------------------------- */

/**
 * Must be called once at the beginning of each cycle, unless the target is enabled and no stop is `pending`.  Returns true
 * if the target must be disabled in this cycle.  If not, `*request` is a request to enable that may act now; 0: none.
 */
bool epg_stop_take(struct epg_control *control, unsigned int *request);

/** Lets no request act that was made before. */
void epg_stop_cancel(struct epg_control *control);

/** Counts a stop by the control side itself, such as a fault, which acts at once. */
void epg_stop_count(struct epg_control *control, epg_stop_source_t source);

#ifdef __cplusplus
}
#endif

#endif
