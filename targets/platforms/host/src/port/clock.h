/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The host's two clocks: the monotonic clock, and the simulated clock, which replaces it in simulated time.
 */
#ifndef EPG_HOST_CLOCK_H
#define EPG_HOST_CLOCK_H

#include <stdint.h>

/** Monotonic time in nanoseconds, whatever epg_port_time_ns() returns.  Callable from every thread. */
uint64_t epg_host_monotonic_ns(void);

/** Sleeps until monotonic time `time_ns`.  A signal can end the sleep early, and on some systems also the clock can. */
void epg_host_sleep_until(uint64_t time_ns);

/** A random number.  Returns 0 if the system has none. */
uint32_t epg_host_random(void);

/** From now on epg_port_time_ns() returns `time_ns`.  Must not be used in a program with several threads. */
void epg_host_clock_simulate(uint64_t time_ns);

/** From now on epg_port_time_ns() returns the monotonic time, as it does at the start of the program. */
void epg_host_clock_real(void);

#endif
