/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A serial port, or a terminal that takes its place.  Only one can be open.  Its number is -1 if there is none.
 *
 * No function waits.
 */
#ifndef EPG_HOST_TTY_H
#define EPG_HOST_TTY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Opens a port for plain bytes.  Returns -1 if it is not there, or does not have this baud rate. */
int epg_host_tty_open(const char *device, uint32_t baud_rate);

/** Returns false if the port was unplugged. */
bool epg_host_tty_is_there(int file);

/** Reads bytes that have arrived.  Returns their number, or -1 if the port is gone. */
long epg_host_tty_read(int file, void *data, size_t size);

/**
 * Writes bytes.  Returns the number of those at the start of `data` that are written, or -1 if the port is gone.  The
 * others must stay in their place until a later call, which begins with them, has returned their number.
 */
long epg_host_tty_write(int file, const void *data, size_t size);

void epg_host_tty_close(int file);

#endif
