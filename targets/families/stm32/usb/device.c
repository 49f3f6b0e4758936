/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The start of the USB device, and its serial number.
 *
 * The interrupt has the priority of EPG's transports, and never that of the tick.  It only moves packets between the
 * FIFOs of the device and memory; the communication side does everything else.
 */
#include "epg/usb.h"
#include "hardware.h"

static void on_interrupt(void)
{
    tud_int_handler(0);
    epg_mcu_service_wake();
}

bool epg_usb_family_start(void)
{
    if (!epg_stm32_usb_power()) {
        return false;
    }
    epg_one_core_enable(epg_stm32_usb_interrupt, on_interrupt);
    return tusb_init();
}

const char *epg_usb_family_serial(void)
{
    return epg_port_serial();
}
