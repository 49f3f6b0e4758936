/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * RP2040 and RP2350: the bytes that a UART has received.
 *
 * The DMA writes them, also while core 0 writes to flash and no interrupt of it can run.  For each byte it writes two:
 * the byte, and the flags of its errors.  It starts again at the begin of the buffer after a power of two of bytes.
 */
#ifndef EPG_FAMILY_UART_H
#define EPG_FAMILY_UART_H

#include <stdint.h>

/* The power of two that is at least `size`, from 64 up to 16384. */
#define EPG_PICO_FROM_4096(size) ((size) <= 4096 ? 4096 : (size) <= 8192 ? 8192 : 16384)
#define EPG_PICO_FROM_1024(size) ((size) <= 1024 ? 1024 : (size) <= 2048 ? 2048 : EPG_PICO_FROM_4096(size))
#define EPG_PICO_FROM_256(size) ((size) <= 256 ? 256 : (size) <= 512 ? 512 : EPG_PICO_FROM_1024(size))
#define EPG_PICO_POWER_OF_TWO(size) ((size) <= 64 ? 64 : (size) <= 128 ? 128 : EPG_PICO_FROM_256(size))

#define EPG_PORT_UART_BUFFER(name, size)                                                                               \
    static uint16_t name[EPG_PICO_POWER_OF_TWO(size)] __attribute__((aligned(2 * EPG_PICO_POWER_OF_TWO(size))))

#endif
