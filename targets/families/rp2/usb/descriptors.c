/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Descriptors of the USB device: tables that the host reads after the device is plugged in, and by which it finds
 * drivers.
 *
 * The device has one or two serial ports (CDC ACM), and an interface by which picotool reboots the board.
 *
 * Names and numbers come from definitions of the executable or from the target configuration (`communication: {usb:
 * ...}`, in epg_pico_target.h).  By default the numbers are those of the Pico SDK's own serial port, by which picotool
 * and udev rules recognise a board that runs firmware.  The serial number is by default the board's unique id, which
 * distinguishes several boards on one computer.
 *
 * Windows finds the driver of picotool's interface (WinUSB) through Microsoft OS 2.0 descriptors.
 */
#include "usb.h"

#if defined(EPG_PICO_USB_VENDOR_ID) != defined(EPG_PICO_USB_PRODUCT_ID)
#error "define both EPG_PICO_USB_VENDOR_ID and EPG_PICO_USB_PRODUCT_ID: a product id is valid only with its vendor id"
#endif
#ifndef EPG_PICO_USB_VENDOR_ID
#define EPG_PICO_USB_VENDOR_ID 0x2E8A /* Raspberry Pi */
#if PICO_RP2040
#define EPG_PICO_USB_PRODUCT_ID 0x000A /* Pico SDK CDC UART */
#else
#define EPG_PICO_USB_PRODUCT_ID 0x0009
#endif
#endif
#ifndef EPG_PICO_USB_MANUFACTURER
#define EPG_PICO_USB_MANUFACTURER "Raspberry Pi"
#endif
#ifndef EPG_PICO_USB_PRODUCT
#define EPG_PICO_USB_PRODUCT "Pico"
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
    TEXT_RESET,
    TEXT_SECOND_CDC,
    TEXTS = TEXT_RESET + EPG_PICO_USB_PORTS
};

/** Characters of the longest text. */
#define TEXT_LENGTH 31

static_assert(2 * PICO_UNIQUE_BOARD_ID_SIZE_BYTES <= TEXT_LENGTH, "the serial number fits");
static_assert(sizeof EPG_PICO_USB_MANUFACTURER <= TEXT_LENGTH + 1, "EPG_PICO_USB_MANUFACTURER is too long");
static_assert(sizeof EPG_PICO_USB_PRODUCT <= TEXT_LENGTH + 1, "EPG_PICO_USB_PRODUCT is too long");
#ifdef EPG_PICO_USB_SERIAL
static_assert(sizeof EPG_PICO_USB_SERIAL <= TEXT_LENGTH + 1, "EPG_PICO_USB_SERIAL is too long");
#endif

static const tusb_desc_device_t device = {
    .bLength = sizeof device,
    .bDescriptorType = TUSB_DESC_DEVICE,
    .bcdUSB = 0x0210, /* USB 2.1, the first version with a BOS descriptor */
    .bDeviceClass = TUSB_CLASS_MISC,
    .bDeviceSubClass = MISC_SUBCLASS_COMMON,
    .bDeviceProtocol = MISC_PROTOCOL_IAD,
    .bMaxPacketSize0 = CFG_TUD_ENDPOINT0_SIZE,
    .idVendor = EPG_PICO_USB_VENDOR_ID,
    .idProduct = EPG_PICO_USB_PRODUCT_ID,
    .bcdDevice = 0x0100,
    .iManufacturer = TEXT_MANUFACTURER,
    .iProduct = TEXT_PRODUCT,
    .iSerialNumber = TEXT_SERIAL,
    .bNumConfigurations = 1,
};

#define INTERFACE_LENGTH 9
#define CONFIGURATION_LENGTH (TUD_CONFIG_DESC_LEN + EPG_PICO_USB_PORTS * TUD_CDC_DESC_LEN + INTERFACE_LENGTH)

static const uint8_t configuration[] = {
    TUD_CONFIG_DESCRIPTOR(1, EPG_USB_INTERFACES, 0, CONFIGURATION_LENGTH, 0, MAX_POWER_MA),
    TUD_CDC_DESCRIPTOR(EPG_USB_CDC, TEXT_CDC, ENDPOINT_NOTIFICATION, 8, ENDPOINT_OUT, ENDPOINT_IN, 64),
#if EPG_PICO_USB_PORTS == 2
    TUD_CDC_DESCRIPTOR(EPG_USB_SECOND_CDC, TEXT_SECOND_CDC, ENDPOINT_NOTIFICATION + ENDPOINTS_OF_PORT, 8,
                       ENDPOINT_OUT + ENDPOINTS_OF_PORT, ENDPOINT_IN + ENDPOINTS_OF_PORT, 64),
#endif
    /* The reset interface has no endpoints. */
    INTERFACE_LENGTH,
    TUSB_DESC_INTERFACE,
    EPG_USB_RESET,
    0,
    0,
    TUSB_CLASS_VENDOR_SPECIFIC,
    RESET_INTERFACE_SUBCLASS,
    RESET_INTERFACE_PROTOCOL,
    TEXT_RESET,
};

static_assert(sizeof configuration == CONFIGURATION_LENGTH, "the length that the descriptor states");

/* Microsoft OS 2.0 Descriptors Specification, tables 10 to 15. */
#define MICROSOFT_LENGTH 166
#define SUBSET_LENGTH (MICROSOFT_LENGTH - 10)
#define CHARACTER(character) (character), 0

static const uint8_t binary_objects[] = {
    TUD_BOS_DESCRIPTOR(TUD_BOS_DESC_LEN + TUD_BOS_MICROSOFT_OS_DESC_LEN, 1),
    TUD_BOS_MS_OS_20_DESCRIPTOR(MICROSOFT_LENGTH, EPG_USB_MICROSOFT_REQUEST),
};

/* clang-format off */
static const uint8_t microsoft[] = {
    /* set header: length, type, Windows 8.1, total length */
    U16_TO_U8S_LE(10), U16_TO_U8S_LE(MS_OS_20_SET_HEADER_DESCRIPTOR), U32_TO_U8S_LE(0x06030000),
    U16_TO_U8S_LE(MICROSOFT_LENGTH),
    /* function subset header: length, type, first interface, reserved, length of the subset */
    U16_TO_U8S_LE(8), U16_TO_U8S_LE(MS_OS_20_SUBSET_HEADER_FUNCTION), EPG_USB_RESET, 0, U16_TO_U8S_LE(SUBSET_LENGTH),
    /* compatible id: length, type, id, sub-id */
    U16_TO_U8S_LE(20), U16_TO_U8S_LE(MS_OS_20_FEATURE_COMPATBLE_ID), 'W', 'I', 'N', 'U', 'S', 'B', 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0,
    /* registry property: length, type, type of its value (text), length of the name, name */
    U16_TO_U8S_LE(128), U16_TO_U8S_LE(MS_OS_20_FEATURE_REG_PROPERTY), U16_TO_U8S_LE(1), U16_TO_U8S_LE(40),
    CHARACTER('D'), CHARACTER('e'), CHARACTER('v'), CHARACTER('i'), CHARACTER('c'), CHARACTER('e'), CHARACTER('I'),
    CHARACTER('n'), CHARACTER('t'), CHARACTER('e'), CHARACTER('r'), CHARACTER('f'), CHARACTER('a'), CHARACTER('c'),
    CHARACTER('e'), CHARACTER('G'), CHARACTER('U'), CHARACTER('I'), CHARACTER('D'), CHARACTER('\0'),
    /*
     * length and value: the id of the interface's class, by which picotool finds it; the SDK's serial port has the same
     */
    U16_TO_U8S_LE(78),
    CHARACTER('{'), CHARACTER('b'), CHARACTER('c'), CHARACTER('7'), CHARACTER('3'), CHARACTER('9'), CHARACTER('8'),
    CHARACTER('c'), CHARACTER('1'), CHARACTER('-'), CHARACTER('7'), CHARACTER('3'), CHARACTER('c'), CHARACTER('d'),
    CHARACTER('-'), CHARACTER('4'), CHARACTER('c'), CHARACTER('b'), CHARACTER('7'), CHARACTER('-'), CHARACTER('9'),
    CHARACTER('8'), CHARACTER('b'), CHARACTER('8'), CHARACTER('-'), CHARACTER('9'), CHARACTER('1'), CHARACTER('3'),
    CHARACTER('a'), CHARACTER('8'), CHARACTER('f'), CHARACTER('c'), CHARACTER('a'), CHARACTER('7'), CHARACTER('b'),
    CHARACTER('f'), CHARACTER('6'), CHARACTER('}'), CHARACTER('\0'),
};
/* clang-format on */

static_assert(sizeof microsoft == MICROSOFT_LENGTH, "the length that the descriptor states");

const uint8_t *tud_descriptor_device_cb(void)
{
    return (const uint8_t *)&device;
}

const uint8_t *tud_descriptor_configuration_cb(uint8_t index)
{
    (void)index;
    return configuration;
}

const uint8_t *tud_descriptor_bos_cb(void)
{
    return binary_objects;
}

bool tud_vendor_control_xfer_cb(uint8_t port, uint8_t stage, const tusb_control_request_t *request)
{
    if (stage != CONTROL_STAGE_SETUP) {
        return true;
    }
    /* wIndex 7 requests the descriptor set (Microsoft OS 2.0 Descriptors Specification). */
    if (request->bRequest != EPG_USB_MICROSOFT_REQUEST || request->wIndex != 7) {
        return false;
    }
    return tud_control_xfer(port, request, (void *)(uintptr_t)microsoft, sizeof microsoft);
}

static const char *text_of(uint8_t index)
{
#ifndef EPG_PICO_USB_SERIAL
    static char serial[2 * PICO_UNIQUE_BOARD_ID_SIZE_BYTES + 1];
#endif
    const char *title = NULL;
    switch (index) {
    case TEXT_MANUFACTURER:
        return EPG_PICO_USB_MANUFACTURER;
    case TEXT_PRODUCT:
        return EPG_PICO_USB_PRODUCT;
    case TEXT_SERIAL:
#ifdef EPG_PICO_USB_SERIAL
        return EPG_PICO_USB_SERIAL;
#else
        pico_get_unique_board_id_string(serial, sizeof serial);
        return serial;
#endif
    case TEXT_RESET:
        return "Reset";
    case TEXT_CDC:
        title = epg_pico_usb_titles[0];
        break;
    default:
        title = epg_pico_usb_titles[EPG_PICO_USB_PORTS - 1];
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
