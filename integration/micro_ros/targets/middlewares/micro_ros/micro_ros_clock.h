/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Questions for the agent's time, by libmicroros.
 *
 * libmicroros does not tell which question an answer belongs to.  The answer repeats the instant of its question, so
 * the time is right to half of the round trip, but the round trip itself is not known.  Therefore:
 *
 * - Only one question is open at a time.  An answer for which libmicroros does not wait any more counts when it comes,
 *   with the round trip of its question.
 * - A question without an answer for 1 s is given up.  The next answer does not count, because it may be the late one.
 *
 * So a round trip can be wrong only if an answer comes more than 1 s after its question, in the same connection or soon
 * after its end.
 */
#ifndef EPG_MICRO_ROS_CLOCK_H
#define EPG_MICRO_ROS_CLOCK_H

#include "epg/wall_clock.h"

/** All members 0: no question was asked. */
typedef struct epg_micro_ros_question {
    bool open;         /**< it was asked at `asked_ns`, and has no answer yet */
    bool doubtful;     /**< its answer can be that of the question before it, which was given up */
    uint64_t asked_ns; /**< in board time */
} epg_micro_ros_question_t;

/**
 * Must be called in each poll while there is a session, after the frames that have arrived were taken.  Asks for the
 * time when epg/wall_clock.h says so, and then waits for the answer, for at most 50 ms.
 */
void epg_micro_ros_clock_poll(epg_micro_ros_question_t *question, epg_clock_t *clock, uint64_t now_ns, bool busy);

#endif
