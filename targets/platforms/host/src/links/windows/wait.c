/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The wait for bytes of the middlewares.
 */
#include "sockets.h"

#include "links/services.h"
#include "links/windows/events.h"
#include "port/windows/timer.h"

enum { MOST_HANDLES = 4, SOCKETS = 2 };

/** The event that a datagram has arrived at a socket.  The system clears it at the end of a wait. */
static HANDLE event_of(int file)
{
    static struct {
        int file;
        HANDLE event;
    } known[SOCKETS];
    size_t i = 0;
    while (i + 1 < SOCKETS && known[i].event != NULL && known[i].file != file) {
        i++;
    }
    if (known[i].event == NULL || known[i].file != file) {
        if (known[i].event == NULL) {
            known[i].event = CreateEventW(NULL, FALSE, FALSE, NULL);
        }
        known[i].file = file;
        (void)WSAEventSelect((SOCKET)file, known[i].event, FD_READ);
    }
    return known[i].event;
}

void epg_host_services_wait(const epg_host_services_t *services, uint64_t time_ns)
{
    HANDLE handles[MOST_HANDLES];
    DWORD count = 0;
    if (services->link != NULL && services->link->file >= 0 && services->link->device == NULL) {
        handles[count++] = event_of(services->link->file); /* the wait for a serial port is a millisecond */
    }
    if (services->udp != NULL) {
        handles[count++] = event_of(epg_host_udp_console_file(services->udp));
    }
    if (services->terminal != NULL && epg_host_terminal_listens(services->terminal)) {
        handles[count++] = epg_host_terminal_event();
    }
    HANDLE timer = epg_host_timer(time_ns);
    if (timer != NULL) {
        handles[count++] = timer;
    }
    if (count == 0 || WaitForMultipleObjects(count, handles, FALSE, timer != NULL ? INFINITE : 1) == WAIT_FAILED) {
        Sleep(1);
    }
}
