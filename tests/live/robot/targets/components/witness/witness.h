/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Records when an actuator is driven.
 *
 * The environment variable WITNESS_FILE names the file.  Each line is one event: "drive" and the begin of the first
 * cycle that drives; or "safe", the begin of the last cycle that has driven, and the time at which it became safe.
 * Times are in ns of the monotonic clock.  A program can have one such actuator.
 */
#ifndef WITNESS_H
#define WITNESS_H

/** Before the first cycle: opens the file. */
void witness_start(void);

/** Control side, at the begin of a cycle. */
void witness_cycle(void);

/** Control side, in place of a write to an actuator. */
void witness_drive(double duty);

/** Control side, in each cycle in which the actuator must be safe. */
void witness_safe(void);

#endif
