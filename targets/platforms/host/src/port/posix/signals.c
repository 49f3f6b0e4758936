/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Signals of POSIX.
 */
#define _POSIX_C_SOURCE 200809L

#include "port/signals.h"

#include <signal.h>
#include <stddef.h>

void epg_host_signals_catch(void (*handler)(int number))
{
    signal(SIGINT, handler);
    signal(SIGTERM, handler);
    /* The system and the shell each send a SIGHUP, so the handler must stay.  `nohup` has it ignored. */
    struct sigaction hangup;
    if (sigaction(SIGHUP, NULL, &hangup) == 0 && hangup.sa_handler != SIG_IGN) {
        hangup.sa_handler = handler;
        hangup.sa_flags = 0;
        (void)sigaction(SIGHUP, &hangup, NULL);
    }
}
