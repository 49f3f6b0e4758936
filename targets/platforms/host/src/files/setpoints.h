/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The setpoint file: a list of events that come to a target from outside, with their times.
 *
 * It is a CSV file with the header line `time,topic,value`.  Each further line is an event, in the order of time.
 * Times are in seconds since the start of the run:
 *
 * | topic                  | value                | effect                                                          |
 * |------------------------|----------------------|-----------------------------------------------------------------|
 * | a subscription         | number, nan, inf     | a setpoint arrives                                              |
 * | the enable topic       | 0 or 1               | disable or enable                                               |
 * | `$enable`              | 0 or 1               | the same, whether or not the target has an enable topic         |
 * | `$component:<name>`    | 0 or 1               | a digital input reads this value, whatever the plant computes   |
 * |                        | open                 | its pin is open: it reads the level of its pull resistor        |
 * |                        | plant                | the plant drives its pin again                                  |
 * | `$stall`               | seconds              | the next cycle takes this time; in simulated time only          |
 */
#ifndef EPG_HOST_SETPOINTS_H
#define EPG_HOST_SETPOINTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/host.h"

typedef enum epg_host_event_kind {
    EPG_HOST_SETPOINT,
    EPG_HOST_ENABLE,
    EPG_HOST_INPUT,
    EPG_HOST_STALL
} epg_host_event_kind_t;

typedef struct epg_host_event {
    uint64_t time_ns; /**< since the start of the run */
    epg_host_event_kind_t kind;
    size_t index; /**< value index of a setpoint, or pin of a digital input */
    double value; /**< value of a setpoint, 0 or 1 to enable, seconds of a stall, or epg_plant_force_t of a pin */
    bool publish; /**< of a setpoint: true if it is the last finite one at this time */
} epg_host_event_t;

/** All events of a file.  `events` is on the heap.  Zero-initialised memory is an empty list. */
typedef struct epg_host_events {
    epg_host_event_t *events;
    size_t count;
} epg_host_events_t;

/**
 * Reads the file `path` for the target `host`.  If `realtime` is true, events that need simulated time are errors.
 *
 * Returns false if the file is wrong, after a message `path:line: error: ...` to stderr about the first wrong line.
 */
bool epg_host_read_setpoints(const char *path, const epg_host_target_t *host, bool realtime, epg_host_events_t *events);

void epg_host_free_setpoints(epg_host_events_t *events);

#endif
