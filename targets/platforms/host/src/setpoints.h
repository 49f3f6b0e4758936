/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The setpoint file: what happens to a target from outside, and when.
 *
 * A CSV file with the header line `time,topic,value`, one event per line, in order of time:
 *
 * | topic                  | value                | effect                                                          |
 * |------------------------|----------------------|-----------------------------------------------------------------|
 * | a subscription         | number, nan, inf     | a setpoint arrives                                              |
 * | the enable topic       | 0 or 1               | disable or enable                                               |
 * | `$enable`              | 0 or 1               | the same, whether or not the target has an enable topic         |
 * | `$component:<name>`    | 0 or 1               | what a digital input reads, whatever the plant says             |
 * |                        | open                 | nothing drives its pin: the level of its pull resistor          |
 * |                        | plant                | the plant drives it again                                       |
 * | `$stall`               | seconds              | the next cycle takes that long; simulated time only             |
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
    size_t index; /**< setpoint, or the pin of a digital input */
    double value; /**< setpoint, enable (0 or 1), seconds, or the epg_plant_force_t of a pin */
    bool publish; /**< of a setpoint: the last finite one of this moment */
    unsigned line;
} epg_host_event_t;

/** All events of a file.  `events` is on the heap; zero-initialised memory is an empty list. */
typedef struct epg_host_events {
    epg_host_event_t *events;
    size_t count;
} epg_host_events_t;

/**
 * Reads the file `path` for the target `host`.  `realtime` refuses what only simulated time can do.
 *
 * Returns false after printing `path:line: error: ...` for each wrong line (the first 20) to stderr.
 */
bool epg_host_read_setpoints(const char *path, const epg_host_target_t *host, bool realtime, epg_host_events_t *events);

void epg_host_free_setpoints(epg_host_events_t *events);

#endif
