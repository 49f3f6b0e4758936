/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The unit of time of macOS's kernel, which depends on the processor.
 */
#ifndef EPG_HOST_TICKS_H
#define EPG_HOST_TICKS_H

#include <stdint.h>

/** Monotonic time, or a duration, in ticks of mach_absolute_time(); rounded down. */
uint64_t epg_host_ticks(uint64_t ns);

#endif
