/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The USB interface by which `picotool reboot -f` and the VS Code extension for Pico reboot a board that runs firmware.
 *
 * The outputs are made safe before the reboot.  The reboot does not count as a fault.
 */
#include "reset.h"
#include "../src/parts.h"
#include "usb_sdk.h"

/** Time in which the answer to the request is sent, before the reboot. */
#define DELAY_MS 100

static uint8_t interface_number;

static void init(void)
{
}

static bool deinit(void)
{
    return true;
}

static void reset(uint8_t port)
{
    (void)port;
    interface_number = 0;
}

static uint16_t open_interface(uint8_t port, const tusb_desc_interface_t *descriptor, uint16_t length)
{
    (void)port;
    if (descriptor->bInterfaceClass != TUSB_CLASS_VENDOR_SPECIFIC ||
        descriptor->bInterfaceSubClass != RESET_INTERFACE_SUBCLASS ||
        descriptor->bInterfaceProtocol != RESET_INTERFACE_PROTOCOL || length < sizeof *descriptor) {
        return 0;
    }
    interface_number = descriptor->bInterfaceNumber;
    return sizeof *descriptor;
}

static bool control_request(uint8_t port, uint8_t stage, const tusb_control_request_t *request)
{
    if (stage != CONTROL_STAGE_SETUP) {
        return true;
    }
    if (request->wIndex != interface_number) {
        return false;
    }
    if (request->bRequest == RESET_REQUEST_BOOTSEL) {
        /* wValue: bits 0 to 6: interfaces to disable; bit 8: a pin shows activity; bit 9: that pin is active low;
         * from bit 9: its number */
        const uint16_t value = request->wValue;
        const int pin = (value & 0x100U) != 0U ? value >> 9U : -1;
        epg_pico_outputs_off();
        rom_reset_usb_boot_extra(pin, value & 0x7FU, (value & 0x200U) != 0U);
    }
    if (request->bRequest == RESET_REQUEST_FLASH) {
        epg_pico_outputs_off();
        watchdog_reboot(0, 0, DELAY_MS);
        return tud_control_status(port, request);
    }
    return false;
}

static bool transferred(uint8_t port, uint8_t endpoint, xfer_result_t result, uint32_t bytes)
{
    (void)port;
    (void)endpoint;
    (void)result;
    (void)bytes;
    return true;
}

static const usbd_class_driver_t reset_driver = {
    .name = "reset",
    .init = init,
    .deinit = deinit,
    .reset = reset,
    .open = open_interface,
    .control_xfer_cb = control_request,
    .xfer_cb = transferred,
    .sof = NULL,
};

const usbd_class_driver_t *usbd_app_driver_get_cb(uint8_t *count)
{
    *count = 1;
    return &reset_driver;
}
