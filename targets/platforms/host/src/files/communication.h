/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The communication side of a run: it delivers the events of a setpoint file, and writes publications to a file.
 */
#ifndef EPG_HOST_COMMUNICATION_H
#define EPG_HOST_COMMUNICATION_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "setpoints.h"

typedef struct epg_host_communication {
    const epg_target_t *target;
    const epg_host_events_t *events;
    size_t next_event;
    uint64_t next_publication_ns;
    uint64_t start_ns; /**< epg_port_time_ns() at time 0 */
    uint64_t end_ns;   /**< end of the run since time 0; later events and publications are left out */
    uint64_t stall_ns; /**< sum of the `$stall` events since the user of this value last cleared it */
    FILE *topics;      /**< NULL: publications are not recorded */
    uint64_t flush_ns; /**< time at which publications that were recorded in real time must reach the file */
    double *values;    /**< buffer for the monitoring values, on the heap */
} epg_host_communication_t;

/** Prepares a run, and writes the header line to `topics`.  Returns false, with a message, if memory is short. */
bool epg_host_communication_start(epg_host_communication_t *communication, const epg_target_t *target,
                                  const epg_host_events_t *events, uint64_t end_ns, FILE *topics);

/** Time (since time 0) of the next event or publication; UINT64_MAX if there is none. */
uint64_t epg_host_communication_next(const epg_host_communication_t *communication);

/**
 * Advances simulated time to `time_ns`: delivers the events up to and including this time, and publishes what was due
 * before it.  A publication that is due at `time_ns` itself waits for the control cycle of that time.
 */
void epg_host_communicate_simulated(epg_host_communication_t *communication, uint64_t time_ns);

/** At real time `time_ns`: delivers all events that are due, and publishes at most once. */
void epg_host_communicate_realtime(epg_host_communication_t *communication, uint64_t time_ns);

void epg_host_communication_end(epg_host_communication_t *communication);

#endif
