/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A serial port on USB and nothing else: each received byte is sent back.
 */
#include "handwritten.h"
#include "pico/stdlib.h"

void communicate(void)
{
    control_alive();
    const int byte = getchar_timeout_us(0);
    if (byte >= 0) {
        putchar_raw(byte);
    }
}
