/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Records the times at which a value arrived, the control cycle that used it began, and the value was written.
 *
 * A program can have one such recorder, with at most 100000 records.  At its end the records are written to the file
 * that the environment variable LATENCY_FILE names.  Each line is a record: value, time of arrival, number of cycles
 * that had begun then, begin of the cycle of the write, number of cycles that had begun then, time of the write.
 * Times are in ns of the monotonic clock.
 */
#ifndef INSTANTS_H
#define INSTANTS_H

/** Before the first cycle: deletes all records. */
void instants_start(void);

/** Communication side, right after it has given a value to the control side. */
void instants_arrival(void);

/** Control side, at the begin of a cycle. */
void instants_cycle(void);

/** Control side, in place of a write to an actuator: adds a record if `value` differs from the last one. */
void instants_write(double value);

#endif
