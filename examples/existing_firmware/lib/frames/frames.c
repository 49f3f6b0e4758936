#include "frames.h"

#include <string.h>

#define START 0x7Eu

static uint16_t crc16(const uint8_t *bytes, size_t count)
{
    uint32_t crc = 0xFFFFu;
    for (size_t i = 0; i < count; i++) {
        crc ^= (uint32_t)bytes[i] << 8;
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc & 0x8000u) != 0u ? (crc << 1) ^ 0x1021u : crc << 1;
        }
    }
    return (uint16_t)(crc & 0xFFFFu);
}

size_t frames_encode(uint8_t frame[FRAMES_SIZE_MAX], const uint8_t *payload, size_t length)
{
    if (length > FRAMES_PAYLOAD_MAX) {
        return 0;
    }
    frame[0] = START;
    frame[1] = (uint8_t)length;
    memcpy(&frame[2], payload, length);
    uint16_t crc = crc16(&frame[1], length + 1);
    frame[length + 2] = (uint8_t)(crc >> 8);
    frame[length + 3] = (uint8_t)(crc & 0xFFu);
    return length + 4;
}

bool frames_receive(frames_receiver_t *self, uint8_t byte)
{
    if (self->count >= 2 && self->count == self->bytes[1] + 4u) {
        self->count = 0; /* the frame before is done with */
    }
    if (self->count == 0 && byte != START) {
        return false;
    }
    self->bytes[self->count++] = byte;
    if (self->count == 2 && byte > FRAMES_PAYLOAD_MAX) {
        self->count = 0;
        return false;
    }
    if (self->count < 2 || self->count < self->bytes[1] + 4u) {
        return false;
    }
    uint16_t crc = crc16(&self->bytes[1], self->bytes[1] + 1u);
    bool right = self->bytes[self->count - 2] == crc >> 8 && self->bytes[self->count - 1] == (crc & 0xFFu);
    if (!right) {
        self->count = 0;
    }
    return right;
}

const uint8_t *frames_payload(const frames_receiver_t *self, size_t *length)
{
    *length = self->bytes[1];
    return &self->bytes[2];
}
