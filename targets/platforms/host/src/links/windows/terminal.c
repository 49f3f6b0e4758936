/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Streams to the user at the computer: standard input and output.
 *
 * Windows cannot tell if a read or a write of a pipe would wait.  So a thread reads and another one writes, each with a
 * ring of bytes that it shares with the communication side.  Windows has no pseudo-terminals.
 */
#include "links/terminal.h"

#include <stdatomic.h>
#include <stdio.h>

#include <windows.h>

#include "links/windows/events.h"
#include "port/clock.h"

enum {
    RING = 16384,                /* bytes; a power of 2 */
    CHUNK = 1024,                /* bytes of one call of the system */
    GRACE_NS = 200 * 1000 * 1000 /* from the end of input to the end of the run */
};

/** Bytes from one thread to another.  Both counts only rise. */
typedef struct ring {
    unsigned char bytes[RING];
    atomic_size_t written;
    atomic_size_t taken;
} ring_t;

static ring_t input;
static ring_t output;
static atomic_bool input_ended;
static atomic_bool output_lost;
static HANDLE input_event;  /* bytes have arrived, or input has ended */
static HANDLE output_event; /* bytes wait for the writer */

static size_t waiting(ring_t *ring)
{
    return atomic_load(&ring->written) - atomic_load(&ring->taken);
}

static size_t put(ring_t *ring, const unsigned char *data, size_t size)
{
    const size_t begin = atomic_load(&ring->written);
    const size_t room = RING - waiting(ring);
    const size_t count = size < room ? size : room;
    for (size_t i = 0; i < count; i++) {
        ring->bytes[(begin + i) % RING] = data[i];
    }
    atomic_store(&ring->written, begin + count);
    return count;
}

static size_t take(ring_t *ring, unsigned char *data, size_t size)
{
    const size_t begin = atomic_load(&ring->taken);
    const size_t there = waiting(ring);
    const size_t count = size < there ? size : there;
    for (size_t i = 0; i < count; i++) {
        data[i] = ring->bytes[(begin + i) % RING];
    }
    atomic_store(&ring->taken, begin + count);
    return count;
}

static DWORD WINAPI reader_main(void *argument)
{
    unsigned char chunk[CHUNK];
    DWORD count;
    HANDLE file = GetStdHandle(STD_INPUT_HANDLE);
    (void)argument;
    while (ReadFile(file, chunk, sizeof chunk, &count, NULL) && count > 0) {
        for (size_t done = 0; done < count;) {
            const size_t fitted = put(&input, chunk + done, count - done);
            done += fitted;
            SetEvent(input_event);
            if (fitted == 0) {
                Sleep(1);
            }
        }
    }
    atomic_store(&input_ended, true);
    SetEvent(input_event);
    return 0;
}

static DWORD WINAPI writer_main(void *argument)
{
    unsigned char chunk[CHUNK];
    HANDLE file = GetStdHandle(STD_OUTPUT_HANDLE);
    (void)argument;
    while (!atomic_load(&output_lost)) {
        const size_t count = take(&output, chunk, sizeof chunk);
        DWORD written;
        if (count == 0) {
            WaitForSingleObject(output_event, INFINITE);
        } else if (!WriteFile(file, chunk, (DWORD)count, &written, NULL)) {
            atomic_store(&output_lost, true);
        }
    }
    return 0;
}

static bool connected(void *context)
{
    (void)context;
    return !atomic_load(&output_lost);
}

static size_t read_bytes(void *context, void *data, size_t size)
{
    epg_host_terminal_t *terminal = context;
    const bool ended = atomic_load(&input_ended); /* before the bytes: those that arrived before the end are read */
    const size_t count = take(&input, data, size);
    if (count == 0 && ended && terminal->end_ns == 0) {
        terminal->end_ns = epg_host_monotonic_ns();
    }
    return count;
}

static size_t write_bytes(void *context, const void *data, size_t size)
{
    const size_t count = connected(context) ? put(&output, data, size) : 0;
    SetEvent(output_event);
    return count;
}

static size_t writable(void *context)
{
    return connected(context) ? RING - waiting(&output) : 0;
}

void epg_host_terminal_standard(epg_host_terminal_t *terminal)
{
    *terminal = (epg_host_terminal_t){
        .stream = {.connected = connected,
                   .read = read_bytes,
                   .write = write_bytes,
                   .writable = writable,
                   .context = terminal},
        .input = -1,
        .output = -1,
    };
    input_event = CreateEventW(NULL, FALSE, FALSE, NULL);
    output_event = CreateEventW(NULL, FALSE, FALSE, NULL);
    /* A thread that waits for input ends with the program. */
    HANDLE threads[] = {CreateThread(NULL, 0, reader_main, NULL, 0, NULL),
                        CreateThread(NULL, 0, writer_main, NULL, 0, NULL)};
    for (size_t i = 0; i < sizeof threads / sizeof threads[0]; i++) {
        if (threads[i] != NULL) {
            CloseHandle(threads[i]);
        }
    }
}

bool epg_host_terminal_open(epg_host_terminal_t *terminal, const char *path)
{
    (void)terminal;
    fprintf(stderr, "%s: error: Windows has no pseudo-terminals\nhint: --console-udp 127.0.0.1:7000\n", path);
    return false;
}

bool epg_host_terminal_listens(const epg_host_terminal_t *terminal)
{
    return terminal->end_ns == 0;
}

bool epg_host_terminal_ended(const epg_host_terminal_t *terminal, uint64_t now_ns)
{
    return terminal->end_ns != 0 && now_ns > terminal->end_ns + GRACE_NS;
}

/** Gives the writer a little time for the last answers. */
void epg_host_terminal_close(epg_host_terminal_t *terminal)
{
    const uint64_t end_ns = epg_host_monotonic_ns() + GRACE_NS;
    (void)terminal;
    while (waiting(&output) > 0 && !atomic_load(&output_lost) && epg_host_monotonic_ns() < end_ns) {
        Sleep(1);
    }
}

void *epg_host_terminal_event(void)
{
    return input_event;
}
