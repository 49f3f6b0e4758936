/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Baud rates of macOS.
 */
#ifndef EPG_HOST_SPEED_H
#define EPG_HOST_SPEED_H

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/ioctl.h>
#include <termios.h>

/** Gives an open terminal these settings, at this baud rate, by IOSSIOSPEED of IOKit.  A pseudo-terminal has no rate. */
static inline bool epg_host_speed_set(int file, struct termios *settings, uint32_t baud_rate)
{
    speed_t speed = baud_rate;
    return tcsetattr(file, TCSANOW, settings) == 0 &&
           (ioctl(file, _IOW('T', 2, speed_t), &speed) == 0 || errno == ENOTTY);
}

#endif
