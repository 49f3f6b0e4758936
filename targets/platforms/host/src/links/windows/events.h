/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What the wait for bytes needs of a terminal.
 */
#ifndef EPG_HOST_EVENTS_H
#define EPG_HOST_EVENTS_H

/** The handle of the event that bytes have arrived at standard input, or that it has ended. */
void *epg_host_terminal_event(void);

#endif
