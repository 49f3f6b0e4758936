/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Microsoft OS 2.0 descriptors, by which Windows finds the driver of picotool's interface (WinUSB).
 */
#include "reset.h"

/** Number of the vendor request by which Windows reads the descriptors. */
#define MICROSOFT_REQUEST 1

/* Microsoft OS 2.0 Descriptors Specification, tables 10 to 15. */
#define MICROSOFT_LENGTH 166
#define SUBSET_LENGTH (MICROSOFT_LENGTH - 10)
#define CHARACTER(character) (character), 0

static const uint8_t binary_objects[] = {
    TUD_BOS_DESCRIPTOR(TUD_BOS_DESC_LEN + TUD_BOS_MICROSOFT_OS_DESC_LEN, 1),
    TUD_BOS_MS_OS_20_DESCRIPTOR(MICROSOFT_LENGTH, MICROSOFT_REQUEST),
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
    if (request->bRequest != MICROSOFT_REQUEST || request->wIndex != 7) {
        return false;
    }
    return tud_control_xfer(port, request, (void *)(uintptr_t)microsoft, sizeof microsoft);
}
