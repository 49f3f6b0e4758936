/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The serial number of the program.
 */
#ifndef EPG_HOST_SERIAL_H
#define EPG_HOST_SERIAL_H

/** Sets the result of epg_port_serial() to `text`, which must stay valid.  Without a call the result is "host". */
void epg_host_serial_set(const char *text);

#endif
