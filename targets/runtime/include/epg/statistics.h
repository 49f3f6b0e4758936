/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What every target counts.
 */
#ifndef EPG_STATISTICS_H
#define EPG_STATISTICS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Stacks that are watched: of the two cores, threads or tasks. */
enum { EPG_STACK_CONTROL, EPG_STACK_COMMUNICATION, EPG_STACKS };

/** Bytes of a stack; both are 0 where the platform does not know them. */
typedef struct epg_stack {
    uint32_t used; /**< at most so far */
    uint32_t size;
} epg_stack_t;

/** Times are in nanoseconds; 32-bit times saturate at 4.29 s.  Counters wrap at 2^32. */
typedef struct epg_statistics {
    uint32_t cycles;            /**< control cycles run */
    uint32_t overruns;          /**< cycles that ended after the next one was due, or before which ticks were missed */
    uint32_t missed;            /**< ticks at which no cycle ran */
    uint32_t lateness_max;      /**< largest delay from tick to start of a cycle */
    uint32_t computation_min;   /**< shortest cycle */
    uint32_t computation_max;   /**< longest cycle */
    uint64_t computation_total; /**< sum over all cycles: divide by `cycles` for the mean */
    uint32_t outputs_late;      /**< cycles whose outputs were not ready at the output delay, and came later */
    uint32_t clamped;           /**< values limited by a conversion, `max_duty` or the range of an actuator */
    uint32_t setpoints_dropped; /**< setpoints refused because they were not finite */
    uint32_t setpoint_timeouts; /**< times a setpoint became too old */
    uint32_t faults;            /**< times a fault was latched */
    uint32_t reconnects;        /**< times communication was lost and came back */
    uint32_t silence_max;       /**< most control cycles in a row in which the communication side showed no life */
    epg_stack_t stacks[EPG_STACKS];
} epg_statistics_t;

#ifdef __cplusplus
}
#endif

#endif
