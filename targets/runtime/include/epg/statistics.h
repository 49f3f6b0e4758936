/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Statistics of the control loop, which every target counts.
 *
 * A hardware timer gives a tick once per control period.  A tick starts a control cycle.  Three things can go wrong,
 * and each is counted: the cycle begins late (`lateness_max`), it ends after the next tick (`overruns`), or a tick
 * passes without a cycle (`missed`).
 */
#ifndef EPG_STATISTICS_H
#define EPG_STATISTICS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The stacks that are measured: those of the control side and of the communication side. */
enum { EPG_STACK_CONTROL, EPG_STACK_COMMUNICATION, EPG_STACKS };

/** Use of a stack, in bytes.  Both numbers are 0 on a platform that does not measure stacks. */
typedef struct epg_stack {
    uint32_t used; /**< the most that was ever in use */
    uint32_t size;
} epg_stack_t;

/** Times are in nanoseconds.  32-bit times saturate at 4.29 s.  Counters wrap at 2^32. */
typedef struct epg_statistics {
    uint32_t cycles;            /**< control cycles run */
    uint32_t overruns;          /**< cycles that ended after the next tick, or that began after missed ticks */
    uint32_t missed;            /**< ticks without a cycle */
    uint32_t lateness_max;      /**< longest time from a tick to the start of its cycle */
    uint32_t computation_min;   /**< duration of the shortest cycle, without its wait for the output delay */
    uint32_t computation_max;   /**< duration of the longest cycle, the same */
    uint64_t computation_total; /**< sum of the durations of all cycles; the mean is this divided by `cycles` */
    uint32_t outputs_late;      /**< cycles that wrote their outputs after the output delay */
    uint32_t clamped;           /**< values limited by a conversion, `max_duty`, an actuator's or a member's range */
    uint32_t setpoints_dropped; /**< setpoints that were refused because they were NaN or infinite */
    uint32_t setpoint_timeouts; /**< how often a setpoint became older than its timeout */
    uint32_t faults;            /**< how often a fault was latched */
    uint32_t reconnects;        /**< how often communication was lost and came back */
    uint32_t silence_max;       /**< most control cycles between two reports that the communication side is alive */
    epg_stack_t stacks[EPG_STACKS];
} epg_statistics_t;

/** The value for a member of 32 bits that saturates. */
static inline uint32_t epg_statistics_saturated(uint64_t value)
{
    return value < UINT32_MAX ? (uint32_t)value : UINT32_MAX;
}

#ifdef __cplusplus
}
#endif

#endif
