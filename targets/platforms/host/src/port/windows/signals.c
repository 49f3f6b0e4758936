/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Signals of Windows.
 */
#include "port/signals.h"

#include <signal.h>

void epg_host_signals_catch(void (*handler)(int number))
{
    signal(SIGINT, handler);
    signal(SIGTERM, handler);
    signal(SIGBREAK, handler); /* of the page of `epg connect`, and at the end of the console's window */
}
