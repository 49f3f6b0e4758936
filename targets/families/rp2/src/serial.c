/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The serial number of the board: the unique id of its flash chip (RP2040), or of the microcontroller (RP2350).  The
 * USB device has the same serial number.
 */
#include "epg/port.h"
#include "parts.h"

const char *epg_port_serial(void)
{
    /* Does not access flash: the SDK has read the id before main(). */
    static char text[2 * PICO_UNIQUE_BOARD_ID_SIZE_BYTES + 1];
    if (text[0] == '\0') {
        pico_get_unique_board_id_string(text, sizeof text);
    }
    return text;
}
