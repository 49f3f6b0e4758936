/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Questions for the agent's time, by libmicroros.
 */
#include "micro_ros_clock.h"

#include <rmw_microros/rmw_microros.h>

#include "epg/port.h"

#define MS ((uint64_t)1000000)

static const uint64_t LOST_NS = 1000 * MS; /* as long as a connected agent can be silent */

enum { ANSWER_MS = 50 };

static void take_answer(epg_micro_ros_question_t *question, epg_clock_t *clock)
{
    const uint64_t came_ns = epg_port_time_ns();
    question->open = false;
    if (!question->doubtful) {
        epg_clock_answer(clock, (uint64_t)rmw_uros_epoch_nanos(), came_ns, came_ns - question->asked_ns);
    }
}

void epg_micro_ros_clock_poll(epg_micro_ros_question_t *question, epg_clock_t *clock, uint64_t now_ns, bool busy)
{
    if (question->open && rmw_uros_epoch_synchronized()) { /* an answer was among the frames */
        take_answer(question, clock);
    }
    const bool waits = question->open && now_ns < question->asked_ns + LOST_NS;
    if (waits || !epg_clock_poll(clock, now_ns, busy)) {
        return;
    }
    *question = (epg_micro_ros_question_t){.open = true, .doubtful = question->open, .asked_ns = epg_port_time_ns()};
    if (rmw_uros_sync_session(ANSWER_MS) == RMW_RET_OK) {
        take_answer(question, clock);
    }
}
