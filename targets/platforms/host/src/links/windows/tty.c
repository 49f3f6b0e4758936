/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A serial port of Windows, which is opened for overlapped transfers: else a call could wait.
 */
#include "links/tty.h"

#include <stdio.h>

#include <windows.h>

enum {
    QUEUE = 16384,     /* bytes of the driver, in each direction */
    LONGEST_NAME = 80, /* with the end of the text */
    GRACE_MS = 100,    /* for the last bytes */
    XON = 0x11,
    XOFF = 0x13
};

static OVERLAPPED reading;
static OVERLAPPED writing;
static DWORD under_way; /* bytes of a write that has not ended */

/** Handles have 32 bits, also in programs with 64. */
static HANDLE handle_of(int file)
{
    return (HANDLE)(intptr_t)file;
}

static bool configure(HANDLE port, uint32_t baud_rate)
{
    DCB state = {
        .DCBlength = sizeof state,
        .BaudRate = baud_rate,
        .fBinary = TRUE,
        .fDtrControl = DTR_CONTROL_ENABLE, /* a USB device takes DTR for an open port */
        .fRtsControl = RTS_CONTROL_ENABLE,
        .ByteSize = 8,
        .Parity = NOPARITY,
        .StopBits = ONESTOPBIT,
        .XonChar = XON, /* Windows refuses two equal ones */
        .XoffChar = XOFF,
    };
    COMMTIMEOUTS times = {.ReadIntervalTimeout = MAXDWORD}; /* a read takes what is there; a write has no limit */
    (void)SetupComm(port, QUEUE, QUEUE);
    return SetCommState(port, &state) && SetCommTimeouts(port, &times) && PurgeComm(port, PURGE_RXCLEAR);
}

int epg_host_tty_open(const char *device, uint32_t baud_rate)
{
    char path[LONGEST_NAME];
    (void)snprintf(path, sizeof path, device[0] == '\\' ? "%s" : "\\\\.\\%s", device); /* COM10 needs the prefix */
    HANDLE port = CreateFileA(path, GENERIC_READ | GENERIC_WRITE, 0, NULL, OPEN_EXISTING, FILE_FLAG_OVERLAPPED, NULL);
    if (port == INVALID_HANDLE_VALUE) {
        return -1;
    }
    if (!configure(port, baud_rate)) {
        CloseHandle(port);
        return -1;
    }
    if (reading.hEvent == NULL) {
        reading.hEvent = CreateEventW(NULL, TRUE, FALSE, NULL);
        writing.hEvent = CreateEventW(NULL, TRUE, FALSE, NULL);
    }
    return (int)(intptr_t)port;
}

bool epg_host_tty_is_there(int file)
{
    COMSTAT state;
    return ClearCommError(handle_of(file), NULL, &state);
}

long epg_host_tty_read(int file, void *data, size_t size)
{
    COMSTAT state;
    DWORD count = 0;
    if (!ClearCommError(handle_of(file), NULL, &state)) {
        return -1;
    }
    const DWORD most = state.cbInQue < size ? state.cbInQue : (DWORD)size;
    if (most == 0) {
        return 0;
    }
    if (!ReadFile(handle_of(file), data, most, NULL, &reading) && GetLastError() != ERROR_IO_PENDING) {
        return -1;
    }
    return GetOverlappedResult(handle_of(file), &reading, &count, TRUE) ? (long)count : -1;
}

long epg_host_tty_write(int file, const void *data, size_t size)
{
    DWORD count = 0;
    if (under_way == 0) {
        under_way = (DWORD)size;
        if (!WriteFile(handle_of(file), data, under_way, NULL, &writing) && GetLastError() != ERROR_IO_PENDING) {
            under_way = 0;
            return -1;
        }
    }
    if (!GetOverlappedResult(handle_of(file), &writing, &count, FALSE)) {
        return GetLastError() == ERROR_IO_INCOMPLETE ? 0 : -1;
    }
    under_way = 0;
    return (long)count;
}

/** The last bytes get a little time.  Then the driver must not use their place any more. */
void epg_host_tty_close(int file)
{
    DWORD count;
    if (under_way > 0 && WaitForSingleObject(writing.hEvent, GRACE_MS) == WAIT_TIMEOUT) {
        (void)CancelIoEx(handle_of(file), &writing);
        (void)GetOverlappedResult(handle_of(file), &writing, &count, TRUE);
    }
    under_way = 0;
    CloseHandle(handle_of(file));
}
