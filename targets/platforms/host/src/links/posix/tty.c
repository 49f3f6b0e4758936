/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A serial port of POSIX, or a pseudo-terminal that another program has made.
 */
#define _DEFAULT_SOURCE /* for baud rates above those of POSIX */

#include "links/tty.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "speed.h"

/** Makes the terminal transfer plain bytes, at this baud rate. */
static bool make_raw(int file, uint32_t baud_rate)
{
    struct termios settings;
    if (tcgetattr(file, &settings) != 0) {
        return false;
    }
    cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cflag &= ~(tcflag_t)CRTSCTS;
    return epg_host_speed_set(file, &settings, baud_rate) && tcflush(file, TCIFLUSH) == 0;
}

int epg_host_tty_open(const char *device, uint32_t baud_rate)
{
    const int file = open(device, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (file >= 0 && !make_raw(file, baud_rate)) {
        close(file);
        return -1;
    }
    return file;
}

bool epg_host_tty_is_there(int file)
{
    struct pollfd entry = {.fd = file, .events = POLLHUP}; /* macOS looks at what is asked for */
    return poll(&entry, 1, 0) <= 0 || (entry.revents & (POLLHUP | POLLERR | POLLNVAL)) == 0;
}

/** The result of a read or write, which is 0 if the terminal is not ready. */
static long done(ssize_t count)
{
    return count < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : count;
}

long epg_host_tty_read(int file, void *data, size_t size)
{
    const ssize_t count = read(file, data, size);
    return count == 0 ? -1 : done(count);
}

long epg_host_tty_write(int file, const void *data, size_t size)
{
    return done(write(file, data, size));
}

void epg_host_tty_close(int file)
{
    close(file);
}
