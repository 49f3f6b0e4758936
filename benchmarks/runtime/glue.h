/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions that the driver calls: the generated target and the one written by hand both have them.
 */
#ifndef GLUE_H
#define GLUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/status.h"

enum { GLUE_SETPOINTS = 2, GLUE_MONITORED = 2 };

/* Control side: the same as epg_control_start() and epg_control_cycle(). */
void glue_start(void);
void glue_cycle(uint64_t tick_ns, uint32_t missed);

/* Communication side: the same as epg_control_receive(), _monitor(), _status() and _request(). */
bool glue_receive(size_t index, double value, uint64_t received_ns, bool publish);
bool glue_monitor(double values[GLUE_MONITORED]);
bool glue_status(epg_status_t *status);
void glue_request(bool enable);

#endif
