/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The console by UDP: a stream between a middleware and one program or person at a time.
 *
 * A target has one user at a time: the address that spoke first, until it says goodbye or is silent.  Others are told
 * its address.  The command `disable` acts for every sender.  docs/live.md defines the datagrams.
 *
 * It needs Linux, like real time.  Only one thread may use it.  No function waits.
 */
#ifndef EPG_HOST_UDP_CONSOLE_H
#define EPG_HOST_UDP_CONSOLE_H

#include "epg/stream.h"
#include "epg/target.h"

typedef struct epg_host_udp_console epg_host_udp_console_t;

/**
 * Listens on `address`, [ADDRESS:]PORT, for users of `target`, and prints the address that it listens on.  Without
 * ADDRESS, only programs of this computer can reach it.  Port 0 lets the system choose a port.  Returns NULL, with a
 * message, if this fails.  Only one object can be open.
 */
epg_host_udp_console_t *epg_host_udp_console_open(const char *address, const epg_target_t *target);

const epg_stream_t *epg_host_udp_console_stream(const epg_host_udp_console_t *console);

/** The descriptor to wait for, by poll(). */
int epg_host_udp_console_file(const epg_host_udp_console_t *console);

/** Tells the user that the target has ended. */
void epg_host_udp_console_close(epg_host_udp_console_t *console);

#endif
