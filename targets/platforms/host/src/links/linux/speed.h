/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Baud rates of Linux.
 */
#ifndef EPG_HOST_SPEED_H
#define EPG_HOST_SPEED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <termios.h>

typedef struct speed_of {
    uint32_t baud_rate;
    speed_t speed;
} speed_of_t;

static const speed_of_t speeds[] = {
    {9600, B9600},       {19200, B19200},     {38400, B38400},     {57600, B57600},     {115200, B115200},
    {230400, B230400},   {460800, B460800},   {500000, B500000},   {576000, B576000},   {921600, B921600},
    {1000000, B1000000}, {1500000, B1500000}, {2000000, B2000000}, {3000000, B3000000}, {4000000, B4000000},
};

static inline speed_t speed_of(uint32_t baud_rate)
{
    for (size_t i = 0; i < sizeof speeds / sizeof speeds[0]; i++) {
        if (speeds[i].baud_rate == baud_rate) {
            return speeds[i].speed;
        }
    }
    return B115200;
}

/** Gives an open terminal these settings, at this baud rate. */
static inline bool epg_host_speed_set(int file, struct termios *settings, uint32_t baud_rate)
{
    cfsetispeed(settings, speed_of(baud_rate));
    cfsetospeed(settings, speed_of(baud_rate));
    return tcsetattr(file, TCSANOW, settings) == 0;
}

#endif
