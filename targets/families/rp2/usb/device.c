/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The start of the USB device, and its serial number.
 */
#include "../src/parts.h"
#include "epg/usb.h"
#include "usb_sdk.h"

static void on_interrupt(void)
{
    epg_mcu_service_wake();
}

bool epg_usb_family_start(void)
{
    if (!tusb_init()) {
        return false;
    }
    /* Lowest order: runs after TinyUSB's own handler, which puts the event into its queue. */
    irq_add_shared_handler(USBCTRL_IRQ, on_interrupt, PICO_SHARED_IRQ_HANDLER_LOWEST_ORDER_PRIORITY);
    return true;
}

const char *epg_usb_family_serial(void)
{
    static char serial[2 * PICO_UNIQUE_BOARD_ID_SIZE_BYTES + 1];
    pico_get_unique_board_id_string(serial, sizeof serial);
    return serial;
}
