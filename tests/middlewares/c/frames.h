/**
 * @file
 * The frames of a program that uses the console, encoded independently of the console's own code.
 */
#ifndef FRAMES_H
#define FRAMES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { LONGEST = 512 };

/** CRC-32 of IEEE 802.3, bit by bit. */
static inline uint32_t crc_of(const unsigned char *bytes, size_t length)
{
    uint32_t crc = 0xFFFFFFFFU;
    for (size_t i = 0; i < length; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc & 1U) != 0 ? crc >> 1 ^ 0xEDB88320U : crc >> 1;
        }
    }
    return ~crc;
}

/** Writes the frame of a message to `frame`, which has room for LONGEST + 16 bytes.  Returns its length. */
static inline size_t encode(const void *message, size_t length, unsigned char *frame)
{
    unsigned char data[LONGEST];
    memcpy(data, message, length);
    const uint32_t crc = crc_of(data, length);
    for (unsigned int i = 0; i < 4; i++) {
        data[length++] = (unsigned char)(crc >> 8U * i);
    }
    size_t at = 0;
    frame[at++] = 0;
    for (size_t begin = 0; begin <= length;) {
        size_t run = 0;
        while (begin + run < length && data[begin + run] != 0 && run < 254) {
            run++;
        }
        frame[at++] = (unsigned char)(run + 1);
        memcpy(&frame[at], &data[begin], run);
        at += run;
        begin += run < 254 ? run + 1 : run;
    }
    frame[at++] = 0;
    return at;
}

#endif
