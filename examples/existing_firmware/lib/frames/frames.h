/**
 * @file
 * Frames on a byte link: 0x7E, length, payload, CRC-16/CCITT-FALSE of length and payload (high byte first).
 */
#ifndef FRAMES_H
#define FRAMES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FRAMES_PAYLOAD_MAX 32u
#define FRAMES_SIZE_MAX (FRAMES_PAYLOAD_MAX + 4u)

/** A frame that is being received; all zero at the start. */
typedef struct frames_receiver {
    uint8_t bytes[FRAMES_SIZE_MAX];
    size_t count;
} frames_receiver_t;

/** Writes a frame with `length` (at most FRAMES_PAYLOAD_MAX) bytes of payload; returns its size, 0 if it is too long. */
size_t frames_encode(uint8_t frame[FRAMES_SIZE_MAX], const uint8_t *payload, size_t length);

/** Takes one received byte; true when it completes a frame whose CRC is right. */
bool frames_receive(frames_receiver_t *self, uint8_t byte);

/** The payload of the frame that was just completed, and its length. */
const uint8_t *frames_payload(const frames_receiver_t *self, size_t *length);

#endif
