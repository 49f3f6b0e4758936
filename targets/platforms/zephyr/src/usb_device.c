/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The USB device, by Zephyr's newer device stack (usbd).
 *
 * It has all USB classes of the image in one configuration, and the board's serial number, which distinguishes several
 * boards on one computer.
 */
#include <zephyr/device.h>
#include <zephyr/logging/log.h>
#include <zephyr/usb/usbd.h>

#include "usb.h"

LOG_MODULE_DECLARE(epg, CONFIG_EPG_LOG_LEVEL);

USBD_DEVICE_DEFINE(epg_usb_device, DEVICE_DT_GET(DT_NODELABEL(zephyr_udc0)), CONFIG_EPG_USB_VID, CONFIG_EPG_USB_PID);
USBD_DESC_LANG_DEFINE(epg_usb_language);
USBD_DESC_MANUFACTURER_DEFINE(epg_usb_manufacturer, CONFIG_EPG_USB_MANUFACTURER);
USBD_DESC_PRODUCT_DEFINE(epg_usb_product, CONFIG_EPG_USB_PRODUCT);
USBD_DESC_CONFIG_DEFINE(epg_usb_full_speed_text, "EPG");
USBD_CONFIGURATION_DEFINE(epg_usb_full_speed, 0, CONFIG_EPG_USB_MAX_POWER / 2, &epg_usb_full_speed_text);
#if USBD_SUPPORTS_HIGH_SPEED
USBD_DESC_CONFIG_DEFINE(epg_usb_high_speed_text, "EPG");
USBD_CONFIGURATION_DEFINE(epg_usb_high_speed, 0, CONFIG_EPG_USB_MAX_POWER / 2, &epg_usb_high_speed_text);
#endif
#ifdef CONFIG_HWINFO
USBD_DESC_SERIAL_NUMBER_DEFINE(epg_usb_serial_number);
#endif

/** On boards that measure the voltage of the bus, the device is enabled while there is a voltage. */
static void on_message(struct usbd_context *device, const struct usbd_msg *message)
{
    if (message->type == USBD_MSG_VBUS_READY) {
        (void)usbd_enable(device);
    } else if (message->type == USBD_MSG_VBUS_REMOVED) {
        (void)usbd_disable(device);
    }
}

static int add_texts(struct usbd_context *device)
{
    struct usbd_desc_node *const texts[] = {
        &epg_usb_language,
        &epg_usb_manufacturer,
        &epg_usb_product,
#ifdef CONFIG_HWINFO
        &epg_usb_serial_number,
#endif
    };
    int error = 0;
    for (size_t i = 0; i < ARRAY_SIZE(texts) && error == 0; i++) {
        error = usbd_add_descriptor(device, texts[i]);
    }
    return error;
}

/** Adds a configuration with all classes of the image, for one speed of the bus. */
static int configure(struct usbd_context *device, enum usbd_speed speed, struct usbd_config_node *configuration)
{
    int error = usbd_add_configuration(device, speed, configuration);
    if (error == 0) {
        error = usbd_register_all_classes(device, speed, 1, NULL);
    }
    if (error == 0) {
        /* The class of devices with association descriptors: these join the two interfaces of a serial port. */
        error = usbd_device_set_code_triple(device, speed, USB_BCC_MISCELLANEOUS, 0x02, 0x01);
    }
    return error;
}

static int start(struct usbd_context *device)
{
    int error = add_texts(device);
#if USBD_SUPPORTS_HIGH_SPEED
    if (error == 0 && usbd_caps_speed(device) == USBD_SPEED_HS) {
        error = configure(device, USBD_SPEED_HS, &epg_usb_high_speed);
    }
#endif
    if (error == 0) {
        error = configure(device, USBD_SPEED_FS, &epg_usb_full_speed);
    }
    if (error == 0) {
        error = usbd_msg_register_cb(device, on_message);
    }
    if (error == 0) {
        error = usbd_init(device);
    }
    if (error == 0 && !usbd_can_detect_vbus(device)) {
        error = usbd_enable(device);
    }
    return error;
}

bool epg_zephyr_usb_device_start(void)
{
    static bool started;
    if (!started) {
        const int error = start(&epg_usb_device);
        if (error != 0) {
            LOG_ERR("the USB device cannot be started (%d)", error);
        }
        started = error == 0; /* it stays on the bus when the target stops */
    }
    return started;
}
