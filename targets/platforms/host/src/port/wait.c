/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The wait of a middleware for bytes.  The communication side has its own thread, so it can sleep for a short time.
 */
#include "epg/port_wait.h"

#include <time.h>

#if defined(_WIN32)
#include <windows.h>
#endif

void epg_port_wait_for_bytes(void)
{
#if defined(_WIN32)
    Sleep(1);
#else
    static const struct timespec NAP = {.tv_nsec = 100000};
    (void)nanosleep(&NAP, NULL);
#endif
}
