/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The number of a start: random bits of the ring oscillator (RP2040 data sheet, 2.17.5).  Zephyr uses this file, too.
 *
 * The frequency of the oscillator is not stable, and a reading samples its phase.  Readings that follow each other depend
 * on each other, so that one bit of the number needs many of them.  The oscillator runs from power-on; if the program has
 * stopped it, the time of the call is all that distinguishes two starts.
 */
#include "epg/port.h"
#include "rosc_sdk.h"

/** Readings in all: on RP2040 they take 0.1 ms, about a thousand periods of the oscillator. */
#define READINGS 2048U

/** FNV-1a */
#define PRIME 16777619U

static uint32_t boot_id;

uint32_t epg_port_boot_id(void)
{
    if (boot_id == 0U) {
        uint32_t hash = (uint32_t)epg_port_time_ns();
        for (uint32_t i = 0; i < READINGS; i++) {
            hash = (hash ^ rosc_hw->randombit) * PRIME;
        }
        boot_id = hash != 0U ? hash : 1U;
    }
    return boot_id;
}
