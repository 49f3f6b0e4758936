/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Streams to the user at the computer: standard input and output, or a pseudo-terminal.
 */
#define _GNU_SOURCE /* for pseudo-terminals and cfmakeraw() */

#include "links/terminal.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "port/clock.h"

enum {
    CHUNK = PIPE_BUF < 1024 ? PIPE_BUF : 1024, /* bytes of one write(): a pipe that is ready takes PIPE_BUF (pipe(7)) */
    GRACE_NS = 200 * 1000 * 1000               /* from the end of input to the end of the run */
};

/**
 * The events of `events` that are ready at `file`.  poll() adds POLLHUP and POLLERR.  macOS has no poll() for /dev/null
 * and other devices that never wait.
 */
static short ready(int file, short events)
{
    struct pollfd entry = {.fd = file, .events = events};
    const int count = poll(&entry, 1, 0);
    return count <= 0 ? 0 : (entry.revents & POLLNVAL) != 0 ? events : entry.revents;
}

/**
 * Makes the terminal transfer plain bytes, as USB does: no echo, no editing of lines, no signals.  It is opened and
 * closed once; from then on a poll of our end reports that no program has the other end open (POLLHUP).
 */
static bool make_raw(const char *name)
{
    struct termios settings;
    const int file = open(name, O_RDWR | O_NOCTTY);
    if (file < 0) {
        return false;
    }
    const bool good = tcgetattr(file, &settings) == 0;
    cfmakeraw(&settings);
    const bool set = good && tcsetattr(file, TCSANOW, &settings) == 0;
    close(file);
    return set;
}

static bool connected(void *context)
{
    epg_host_terminal_t *terminal = context;
    if (!terminal->own) {
        return !terminal->lost;
    }
    const bool before = terminal->opened;
    terminal->opened = (ready(terminal->input, POLLIN) & POLLHUP) == 0; /* a program has the other end open */
    if (terminal->opened && !before) {
        (void)make_raw(ptsname(terminal->input)); /* macOS forgets it when the other end is closed */
    }
    return terminal->opened;
}

static size_t read_bytes(void *context, void *data, size_t size)
{
    epg_host_terminal_t *terminal = context;
    if (terminal->end_ns != 0 || (ready(terminal->input, POLLIN) & (POLLIN | POLLHUP)) == 0) {
        return 0;
    }
    const ssize_t count = read(terminal->input, data, size);
    if (count <= 0 && !terminal->own && !(count < 0 && (errno == EINTR || errno == EAGAIN))) {
        terminal->end_ns = epg_host_monotonic_ns();
    }
    return count > 0 ? (size_t)count : 0;
}

/** Writes up to `size` bytes, and returns the number written.  0 if there is no room, or if the reader has gone. */
static size_t write_some(epg_host_terminal_t *terminal, const char *data, size_t size)
{
    if (terminal->lost || (ready(terminal->output, POLLOUT) & POLLOUT) == 0) {
        return 0;
    }
    const ssize_t count = write(terminal->output, data, size < CHUNK ? size : CHUNK);
    if (count < 0 && errno != EAGAIN && errno != EINTR && !terminal->own) {
        terminal->lost = true;
    }
    return count > 0 ? (size_t)count : 0;
}

/** Writes to standard output, without the carriage returns that the console sends: POSIX ends a line with a newline. */
static size_t write_lines(void *context, const void *data, size_t size)
{
    epg_host_terminal_t *terminal = context;
    const char *bytes = data;
    size_t done = 0;
    while (done < size) {
        const char *end = memchr(bytes + done, '\r', size - done);
        const size_t length = end == NULL ? size - done : (size_t)(end - bytes) - done;
        const size_t count = length == 0 ? 0 : write_some(terminal, bytes + done, length);
        done += count;
        if (count < length) {
            break;
        }
        done += end != NULL ? 1U : 0U;
    }
    return done;
}

static size_t write_bytes(void *context, const void *data, size_t size)
{
    return write_some(context, data, size);
}

static size_t writable(void *context)
{
    const epg_host_terminal_t *terminal = context;
    return !terminal->lost && (ready(terminal->output, POLLOUT) & POLLOUT) != 0 ? CHUNK : 0;
}

void epg_host_terminal_standard(epg_host_terminal_t *terminal)
{
    *terminal = (epg_host_terminal_t){
        .stream = {.connected = connected,
                   .read = read_bytes,
                   .write = write_lines,
                   .writable = writable,
                   .context = terminal},
        .input = STDIN_FILENO,
        .output = STDOUT_FILENO,
    };
    signal(SIGPIPE, SIG_IGN); /* the program must go on, to make its outputs safe, when the reader has gone */
}

/** Makes `path` a symbolic link to the terminal `name`.  Replaces a link that an earlier run has left. */
static bool make_link(const char *name, const char *path)
{
    struct stat status;
    if (lstat(path, &status) == 0 && S_ISLNK(status.st_mode)) {
        unlink(path);
    }
    return symlink(name, path) == 0;
}

bool epg_host_terminal_open(epg_host_terminal_t *terminal, const char *path)
{
    const int file = posix_openpt(O_RDWR | O_NOCTTY);
    *terminal = (epg_host_terminal_t){
        .stream = {.connected = connected,
                   .read = read_bytes,
                   .write = write_bytes,
                   .writable = writable,
                   .context = terminal},
        .input = file,
        .output = file,
        .own = true,
    };
    const char *name = file >= 0 && grantpt(file) == 0 && unlockpt(file) == 0 ? ptsname(file) : NULL;
    if (name == NULL || fcntl(file, F_SETFL, O_NONBLOCK) != 0 || !make_raw(name) || !make_link(name, path)) {
        fprintf(stderr, "%s: error: cannot make a terminal with this name: %s\n", path, strerror(errno));
        if (file >= 0) {
            close(file);
        }
        return false;
    }
    terminal->path = path;
    return true;
}

bool epg_host_terminal_listens(const epg_host_terminal_t *terminal)
{
    return terminal->end_ns == 0 && terminal->stream.connected(terminal->stream.context);
}

bool epg_host_terminal_ended(const epg_host_terminal_t *terminal, uint64_t now_ns)
{
    return terminal->end_ns != 0 && now_ns > terminal->end_ns + GRACE_NS;
}

void epg_host_terminal_close(epg_host_terminal_t *terminal)
{
    if (terminal->own) {
        close(terminal->input);
    }
    if (terminal->path != NULL) {
        unlink(terminal->path);
    }
}
