/* Self-test of the station: frames survive the link, and damaged ones do not. */
#include "frames.h"

#include <string.h>

static bool passes(const uint8_t *frame, size_t size, const uint8_t *payload, size_t length)
{
    frames_receiver_t receiver = {0};
    bool complete = false;
    for (size_t i = 0; i < size; i++) {
        complete = frames_receive(&receiver, frame[i]);
    }
    size_t received = 0;
    const uint8_t *bytes = frames_payload(&receiver, &received);
    return complete && received == length && memcmp(bytes, payload, length) == 0;
}

int main(void)
{
    const uint8_t payload[] = {0x7E, 1, 2, 3, 0xFF};
    uint8_t frame[FRAMES_SIZE_MAX];
    size_t size = frames_encode(frame, payload, sizeof payload);
    if (size != sizeof payload + 4 || !passes(frame, size, payload, sizeof payload)) {
        return 1;
    }
    for (size_t bit = 0; bit < 8 * size; bit++) {
        uint8_t damaged[FRAMES_SIZE_MAX];
        memcpy(damaged, frame, size);
        damaged[bit / 8] = (uint8_t)(damaged[bit / 8] ^ (1u << (bit % 8)));
        if (passes(damaged, size, payload, sizeof payload)) {
            return 2;
        }
    }
    return 0;
}
