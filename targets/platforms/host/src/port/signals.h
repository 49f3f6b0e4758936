/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The signals that end a run, as the system has them.
 */
#ifndef EPG_HOST_SIGNALS_H
#define EPG_HOST_SIGNALS_H

/** Calls `handler` at Ctrl-C, at the request of another program to end, and when the terminal closes. */
void epg_host_signals_catch(void (*handler)(int number));

#endif
