/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What tells one program from another.
 */
#ifndef EPG_HOST_SERIAL_H
#define EPG_HOST_SERIAL_H

/** From now on epg_port_serial() is `text`, which stays valid; without a call it is "host". */
void epg_host_serial_set(const char *text);

#endif
