/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The communication side of the host: setpoints come from a file, publications go to one.
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
    uint64_t end_ns;   /**< nothing happens from here on; since time 0 */
    uint64_t stall_ns; /**< of the `$stall` events since this was last cleared */
    FILE *topics;      /**< NULL: publications are not recorded */
    double *values;    /**< room for the monitoring values; on the heap */
} epg_host_communication_t;

/** False, with a message, if memory is short.  `topics` gets its header line. */
bool epg_host_communication_start(epg_host_communication_t *communication, const epg_target_t *target,
                                  const epg_host_events_t *events, uint64_t end_ns, FILE *topics);

/** Time (since time 0) of the next event or publication; UINT64_MAX when none is left. */
uint64_t epg_host_communication_next(const epg_host_communication_t *communication);

/**
 * Simulated time has come to `time_ns`: delivers the events up to and including this moment, and publishes what was
 * due before it.  A publication due at `time_ns` itself waits for the control cycle of that moment.
 */
void epg_host_communicate_simulated(epg_host_communication_t *communication, uint64_t time_ns);

/** Real time is `time_ns`: delivers all events that are due, and publishes once if that is due. */
void epg_host_communicate_realtime(epg_host_communication_t *communication, uint64_t time_ns);

void epg_host_communication_end(epg_host_communication_t *communication);

#endif
