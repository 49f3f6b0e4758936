/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The clock of the network: time stamps of messages, in nanoseconds since 1970.
 *
 * A board counts the time since its start.  The time since 1970 comes from an agent, or from the computer's own clock.
 * This module holds the rules for it, which are the same for all middlewares:
 *
 * - Until the clock is set, a stamp is 0.  It is never the time since the board's start.
 * - The time is asked for eight times, one after another.  The answer with the shortest round trip counts.  Both ways
 *   are taken to be equally long, so the error is at most half of this round trip, which is the uncertainty.
 * - Stamps do not run backwards.  A difference of up to 0.5 s is corrected within 8.6 s, while stamps run at most 6 %
 *   slower or faster.  A larger difference is a step: somebody has set the other clock.  It is corrected at once, and
 *   counted.
 *
 * A middleware whose answers take time does this:
 *
 *     epg_clock_connected(&node->clock, now_ns);           // once for each connection
 *     if (epg_clock_poll(&node->clock, now_ns, busy)) {    // in each poll
 *         ...                                              // send a request for the time
 *     }
 *     epg_clock_answer(&node->clock, epoch_ns, now_ns, round_trip_ns); // for each answer
 *
 * A middleware that can read the other clock at once calls epg_clock_answer() EPG_CLOCK_ANSWERS times.
 *
 * All functions belong to the communication side.
 */
#ifndef EPG_WALL_CLOCK_H
#define EPG_WALL_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

/** Number of answers of which the best one counts. */
enum { EPG_CLOCK_ANSWERS = 8 };

/** The relation of the two clocks since an instant. */
typedef struct epg_clock_piece {
    uint64_t since_ns;  /**< board time */
    int64_t offset_ns;  /**< board time + this = nanoseconds since 1970, after the correction */
    int64_t surplus_ns; /**< part of the difference that is not corrected yet at `since_ns` */
} epg_clock_piece_t;

typedef struct epg_clock {
    bool set;                  /**< stamps are not 0 */
    bool simulated;            /**< stamps are board time, which is simulated */
    uint8_t asked;             /**< requests of the present round; 0: there is a pause */
    uint8_t answered;          /**< answers of the present round */
    uint32_t uncertainty_ns;   /**< largest error of the newest setting */
    uint32_t steps;            /**< number of differences above 0.5 s */
    int64_t step_ns;           /**< the newest one; negative: the other clock was set back */
    epg_clock_piece_t present; /**< the newest setting */
    epg_clock_piece_t before;  /**< the one before it: for cycles that have waited in a history */
    uint64_t round_ns;         /**< begin of the present round of requests, or of the last one */
    uint64_t due_ns;           /**< next request, or end of the round */
    uint64_t best_ns;          /**< shortest round trip of the present round */
    int64_t best_offset_ns;    /**< the offset by that answer */
} epg_clock_t;

/** Clears all state: the clock is not set.  In simulated time, stamps are board time, and answers are ignored. */
void epg_clock_start(epg_clock_t *clock, bool simulated);

/** Must be called when a connection begins.  A clock that was set stays set; a round of requests begins at once. */
void epg_clock_connected(epg_clock_t *clock, uint64_t now_ns);

/**
 * Must be called in each poll while requests can be sent.  Returns true if the middleware must send one now.  `busy`
 * means that this poll has done other work: a request then waits, for at most 5 ms, so that no poll takes long.
 *
 * A round has EPG_CLOCK_ANSWERS requests, 20 ms apart until the clock is set, and later 100 ms.  If answers are missing
 * 1 s after the begin of a round, or later 3 s, the best of the others counts.  A round begins 10 s after the last one
 * that had an answer.
 */
bool epg_clock_poll(epg_clock_t *clock, uint64_t now_ns, bool busy);

/**
 * Must be called for each answer: at board time `now_ns` it was `epoch_ns` nanoseconds since 1970.  `round_trip_ns` is
 * the time from request to answer.  Ignores an answer that took more than 2 s, or is not between 1970 and 2038.
 */
void epg_clock_answer(epg_clock_t *clock, uint64_t epoch_ns, uint64_t now_ns, uint64_t round_trip_ns);

/** Returns the stamp of board time `time_ns` in nanoseconds since 1970; 0: the clock is not set. */
uint64_t epg_clock_stamp_ns(const epg_clock_t *clock, uint64_t time_ns);

#endif
