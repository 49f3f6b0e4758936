/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A serial line: a UART whose interrupt puts received bytes into a ring.
 */
#ifndef LINE_H
#define LINE_H

#include <stdbool.h>
#include <stddef.h>

/** Switches UART `number` on. */
void line_start(unsigned int number);

/** Copies up to `size` received bytes; returns their number. */
size_t line_read(unsigned int number, void *data, size_t size);

/** Sends up to `size` bytes; returns the number that the UART has taken without a wait. */
size_t line_write(unsigned int number, const void *data, size_t size);

/** Sends all bytes. */
void line_write_all(unsigned int number, const void *data, size_t size);

/** A byte has arrived on any line.  In the UART's interrupt; the program defines it. */
void line_received(void);

#endif
