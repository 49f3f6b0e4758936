/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The console by UDP: a stream between a middleware and one program or person at a time.
 *
 * A target has one user at a time: the address that spoke first, until it says goodbye or is silent.  Others are told
 * its address.  The command `disable` acts for every sender: it needs neither the target nor a key.
 *
 * On an address that other computers can reach, a user must be a program with the console's key.
 * docs/live-protocol.md defines the datagrams.
 *
 * Only one thread may use it.  No function waits.
 */
#ifndef EPG_HOST_UDP_CONSOLE_H
#define EPG_HOST_UDP_CONSOLE_H

#include "program/options.h"

#include "epg/stream.h"
#include "epg/target.h"

typedef struct epg_host_udp_console epg_host_udp_console_t;

/**
 * Listens on the address of `options`, [ADDRESS:]PORT, for users of `target`, and prints the address that it listens
 * on.  Without ADDRESS, only programs of this computer can reach it.  Port 0 lets the system choose a port.  If the
 * address needs a key and `options` do not name one, it makes a key and prints it.  Returns NULL, with a message, if
 * this fails.  Only one object can be open.
 */
epg_host_udp_console_t *epg_host_udp_console_open(const epg_host_options_t *options, const epg_target_t *target);

const epg_stream_t *epg_host_udp_console_stream(const epg_host_udp_console_t *console);

/** The descriptor to wait for, by poll(). */
int epg_host_udp_console_file(const epg_host_udp_console_t *console);

/** Tells the user that the target has ended. */
void epg_host_udp_console_close(epg_host_udp_console_t *console);

#endif
