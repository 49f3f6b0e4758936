/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The number of a start, by Zephyr's entropy device.  RP2040 and RP2350 have none: there it is families/rp2/src/boot_id.c.
 *
 * Without an entropy device the number comes from the time of the call and the serial number of the board, and two starts
 * can have the same number.
 */
#include <zephyr/drivers/entropy.h>
#include <zephyr/kernel.h>

#include "epg/port.h"

/** FNV-1a */
#define PRIME 16777619U

static uint32_t boot_id;

static uint32_t random_word(void)
{
    uint32_t word = 0U;
#ifdef CONFIG_ENTROPY_HAS_DRIVER
    const struct device *source = DEVICE_DT_GET(DT_CHOSEN(zephyr_entropy));
    if (!device_is_ready(source) || entropy_get_entropy(source, (uint8_t *)&word, sizeof word) != 0) {
        word = 0U;
    }
#endif
    return word;
}

static uint32_t mixed(void)
{
    uint32_t hash = k_cycle_get_32();
    for (const char *text = epg_port_serial(); *text != '\0'; text++) {
        hash = (hash ^ (unsigned char)*text) * PRIME;
    }
    return hash;
}

uint32_t epg_port_boot_id(void)
{
    if (boot_id == 0U) {
        boot_id = random_word();
    }
    if (boot_id == 0U) {
        boot_id = mixed() | 1U;
    }
    return boot_id;
}
