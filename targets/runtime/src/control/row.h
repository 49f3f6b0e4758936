/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The row of a stream (epg/telemetry.h) that a control cycle gives.
 */
#ifndef EPG_ROW_H
#define EPG_ROW_H

#include <stdint.h>

#include "epg/control.h"

/**
 * Sets the values that are not ports of the model (the loop, the replay, duties and positions), and puts the row of the
 * present cycle into the stream.  Only the control side calls it, after the outputs were written, while a stream runs.
 */
void epg_control_put_row(epg_control_t *control, uint64_t tick_ns);

#endif
