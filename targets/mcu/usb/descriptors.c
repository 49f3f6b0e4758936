/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Descriptors of the USB device: tables that the host reads after the device is plugged in, and by which it finds
 * drivers.
 *
 * The device has one or two serial ports (CDC ACM), and after them the interface of the family, if it has one.
 *
 * Names and numbers come from the target configuration (`communication: {usb: ...}`) or from the family.  The serial
 * number is by default the board's unique id, which distinguishes several boards on one computer.
 */
#include <assert.h>

#include "epg/usb.h"

#ifndef EPG_USB_VERSION
#define EPG_USB_VERSION 0x0200
#endif

/* Endpoints of the first serial port.  Those of the second port have numbers that are larger by 2. */
#define ENDPOINT_NOTIFICATION 0x81
#define ENDPOINT_OUT 0x02
#define ENDPOINT_IN 0x82
#define ENDPOINTS_OF_PORT 2
#define MAX_POWER_MA 250

enum {
    TEXT_LANGUAGE,
    TEXT_MANUFACTURER,
    TEXT_PRODUCT,
    TEXT_SERIAL,
    TEXT_CDC,
#ifdef EPG_USB_FAMILY_INTERFACE
    TEXT_FAMILY,
#endif
#if EPG_USB_PORTS == 2
    TEXT_SECOND_CDC,
#endif
    TEXTS
};

/** Characters of the longest text. */
#define TEXT_LENGTH 31

static_assert(sizeof EPG_USB_MANUFACTURER <= TEXT_LENGTH + 1, "EPG_USB_MANUFACTURER is too long");
static_assert(sizeof EPG_USB_PRODUCT <= TEXT_LENGTH + 1, "EPG_USB_PRODUCT is too long");
#ifdef EPG_USB_SERIAL
static_assert(sizeof EPG_USB_SERIAL <= TEXT_LENGTH + 1, "EPG_USB_SERIAL is too long");
#endif

static const tusb_desc_device_t device = {
    .bLength = sizeof device,
    .bDescriptorType = TUSB_DESC_DEVICE,
    .bcdUSB = EPG_USB_VERSION,
    .bDeviceClass = TUSB_CLASS_MISC,
    .bDeviceSubClass = MISC_SUBCLASS_COMMON,
    .bDeviceProtocol = MISC_PROTOCOL_IAD,
    .bMaxPacketSize0 = CFG_TUD_ENDPOINT0_SIZE,
    .idVendor = EPG_USB_VENDOR_ID,
    .idProduct = EPG_USB_PRODUCT_ID,
    .bcdDevice = 0x0100,
    .iManufacturer = TEXT_MANUFACTURER,
    .iProduct = TEXT_PRODUCT,
    .iSerialNumber = TEXT_SERIAL,
    .bNumConfigurations = 1,
};

#ifdef EPG_USB_FAMILY_INTERFACE
#define INTERFACE_LENGTH 9
#else
#define INTERFACE_LENGTH 0
#endif
#define CONFIGURATION_LENGTH (TUD_CONFIG_DESC_LEN + EPG_USB_PORTS * TUD_CDC_DESC_LEN + INTERFACE_LENGTH)

static const uint8_t configuration[] = {
    TUD_CONFIG_DESCRIPTOR(1, EPG_USB_INTERFACES, 0, CONFIGURATION_LENGTH, 0, MAX_POWER_MA),
    TUD_CDC_DESCRIPTOR(EPG_USB_CDC, TEXT_CDC, ENDPOINT_NOTIFICATION, 8, ENDPOINT_OUT, ENDPOINT_IN, 64),
#if EPG_USB_PORTS == 2
    TUD_CDC_DESCRIPTOR(EPG_USB_SECOND_CDC, TEXT_SECOND_CDC, ENDPOINT_NOTIFICATION + ENDPOINTS_OF_PORT, 8,
                       ENDPOINT_OUT + ENDPOINTS_OF_PORT, ENDPOINT_IN + ENDPOINTS_OF_PORT, 64),
#endif
#ifdef EPG_USB_FAMILY_INTERFACE
    INTERFACE_LENGTH,
    TUSB_DESC_INTERFACE,
    EPG_USB_FAMILY,
    0,
    0,
    EPG_USB_FAMILY_INTERFACE,
    TEXT_FAMILY,
#endif
};

static_assert(sizeof configuration == CONFIGURATION_LENGTH, "the length that the descriptor states");

const uint8_t *tud_descriptor_device_cb(void)
{
    return (const uint8_t *)&device;
}

const uint8_t *tud_descriptor_configuration_cb(uint8_t index)
{
    (void)index;
    return configuration;
}

static const char *text_of(uint8_t index)
{
    const char *title = NULL;
    switch (index) {
    case TEXT_MANUFACTURER:
        return EPG_USB_MANUFACTURER;
    case TEXT_PRODUCT:
        return EPG_USB_PRODUCT;
    case TEXT_SERIAL:
#ifdef EPG_USB_SERIAL
        return EPG_USB_SERIAL;
#else
        return epg_usb_family_serial();
#endif
#ifdef EPG_USB_FAMILY_INTERFACE
    case TEXT_FAMILY:
        return EPG_USB_FAMILY_TITLE;
#endif
    case TEXT_CDC:
        title = epg_usb_titles[0];
        break;
    default:
        title = epg_usb_titles[EPG_USB_PORTS - 1];
        break;
    }
    return title != NULL ? title : "EPG";
}

const uint16_t *tud_descriptor_string_cb(uint8_t index, uint16_t language)
{
    (void)language;
    static uint16_t descriptor[1 + TEXT_LENGTH];
    size_t length = 0;
    if (index == TEXT_LANGUAGE) {
        descriptor[1] = 0x0409; /* English */
        length = 1;
    } else if (index < TEXTS) {
        for (const char *text = text_of(index); text[length] != '\0' && length < TEXT_LENGTH; length++) {
            descriptor[1 + length] = (uint8_t)text[length];
        }
    } else {
        return NULL;
    }
    descriptor[0] = (uint16_t)(TUSB_DESC_STRING << 8 | (2 * length + 2));
    return descriptor;
}
