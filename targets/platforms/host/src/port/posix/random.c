/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Random numbers of POSIX.
 */
#define _DEFAULT_SOURCE /* getentropy() */

#include <sys/random.h>
#include <unistd.h>

#include "port/clock.h"

uint32_t epg_host_random(void)
{
    uint32_t number;
    return getentropy(&number, sizeof number) == 0 ? number : 0U;
}
