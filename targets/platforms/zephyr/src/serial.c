/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The serial number of the board: the chip's device id.  The USB device has the same serial number.
 */
#include <zephyr/drivers/hwinfo.h>
#include <zephyr/sys/util.h>

#include "epg/port.h"

/** Bytes of the device id that are used: as many as Zephyr's USB serial number shows. */
#define ID_SIZE 16U

const char *epg_port_serial(void)
{
    static char text[2 * ID_SIZE + 1] = "";
    if (text[0] != '\0') {
        return text;
    }
#ifdef CONFIG_HWINFO
    uint8_t id[ID_SIZE];
    const ssize_t size = hwinfo_get_device_id(id, sizeof id);
    if (size > 0) {
        static const char digits[] = "0123456789ABCDEF";
        for (size_t i = 0; i < (size_t)size; i++) {
            text[2U * i] = digits[id[i] >> 4];
            text[2U * i + 1U] = digits[id[i] & 0xFU];
        }
        text[2U * (size_t)size] = '\0';
        return text;
    }
#endif
    return CONFIG_EPG_SERIAL_NUMBER;
}
