/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The serial number of the board: the unique id of the chip, 96 bits (RM0433, 61.1).  On Zephyr the chip has the same
 * serial number.
 */
#include "epg/port.h"
#include "parts.h"

#define WORDS 3U
#define DIGITS 8U

const char *epg_port_serial(void)
{
    static const char digits[] = "0123456789ABCDEF";
    static char text[WORDS * DIGITS + 1U];
    const volatile uint32_t *id = (const volatile uint32_t *)UID_BASE;
    if (text[0] == '\0') {
        for (uint32_t i = 0; i < WORDS * DIGITS; i++) {
            const uint32_t word = id[WORDS - 1U - i / DIGITS]; /* the most significant word first */
            text[i] = digits[word >> (28U - 4U * (i % DIGITS)) & 0xFU];
        }
    }
    return text;
}
