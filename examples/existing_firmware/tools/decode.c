/* Prints the station's frames from standard input, one line each. */
#include <stdio.h>

#include "frames.h"

static unsigned long number(const uint8_t *bytes)
{
    return (unsigned long)bytes[0] << 24 | (unsigned long)bytes[1] << 16 | (unsigned long)bytes[2] << 8 | bytes[3];
}

int main(void)
{
    frames_receiver_t receiver = {0};
    unsigned long count = 0;
    for (int byte = getchar(); byte != EOF; byte = getchar()) {
        size_t length = 0;
        if (frames_receive(&receiver, (uint8_t)byte)) {
            const uint8_t *payload = frames_payload(&receiver, &length);
            if (length == 9) {
                printf("%s after %lu cycles, %lu overruns\n", payload[0] != 0 ? "enabled" : "disabled",
                       number(&payload[1]), number(&payload[5]));
                count++;
            }
        }
    }
    return count > 0 ? 0 : 1;
}
