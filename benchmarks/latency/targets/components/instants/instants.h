/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * When a value arrived, when the control cycle that used it began, and when it was written.
 *
 * There is one; at the program's end its records go to the file that the environment's LATENCY_FILE names, a line each:
 * value, arrival, cycles begun before it, begin of the cycle, cycles begun, write.  Times are ns of the monotonic clock.
 */
#ifndef INSTANTS_H
#define INSTANTS_H

void instants_start(void);

/** Communication side: the control side has been given a value. */
void instants_arrival(void);

/** Control side: a cycle begins. */
void instants_cycle(void);

/** Control side: `value` goes to the actuator; kept if it is another one than before. */
void instants_write(double value);

#endif
