/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The events of Windows that end a run.
 *
 * signal() is not used: after one event, the C library restores the default, and at the end of the window its handler
 * returns at once, which ends the program.
 */
#include "port/signals.h"

#include <signal.h>

#include <windows.h>

enum { LONGEST_END_MS = 30 * 1000 }; /* Windows ends the program after 5 s to 20 s */

static void (*interrupt)(int number);

/**
 * Called in a thread of Windows, which ends the program after the return, but for Ctrl-C and Ctrl-Break.  The page of
 * `epg connect` sends Ctrl-Break.
 */
static BOOL WINAPI on_event(DWORD event)
{
    interrupt(event == CTRL_C_EVENT ? SIGINT : SIGBREAK);
    if (event != CTRL_C_EVENT && event != CTRL_BREAK_EVENT) {
        Sleep(LONGEST_END_MS); /* in the meantime, the run ends, and with it the program */
    }
    return TRUE;
}

void epg_host_signals_catch(void (*handler)(int number))
{
    interrupt = handler;
    (void)SetConsoleCtrlHandler(on_event, TRUE);
}
