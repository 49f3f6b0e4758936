/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What tells this board from all others: the unique id of its flash chip (RP2040) or of the chip itself (RP2350), which
 * is the serial number of the USB device too.
 */
#include "epg/port.h"
#include "parts.h"

const char *epg_port_serial(void)
{
    /* The SDK reads the id before main() and keeps it in memory. */
    static char text[2 * PICO_UNIQUE_BOARD_ID_SIZE_BYTES + 1];
    if (text[0] == '\0') {
        pico_get_unique_board_id_string(text, sizeof text);
    }
    return text;
}
