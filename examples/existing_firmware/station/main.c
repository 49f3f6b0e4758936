/* The station: starts the turntable's controller and reports five times a second, for two seconds, on the link.
 * The motor stays off without the argument --enable. */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "frames.h"
#include "turntable.h"

static void put(uint8_t *bytes, uint32_t number)
{
    for (int i = 0; i < 4; i++) {
        bytes[i] = (uint8_t)(number >> (24 - 8 * i));
    }
}

int main(int argc, char **argv)
{
    if (!turntable_start()) {
        fputs("station: the turntable's controller cannot be started\n", stderr);
        return 1;
    }
    if (argc > 1 && strcmp(argv[1], "--enable") == 0) {
        turntable_enable(true);
    }
    for (int i = 0; i < 10; i++) {
        const struct timespec pause = {.tv_nsec = 200000000};
        nanosleep(&pause, NULL);
        epg_status_t status;
        if (turntable_status(&status)) {
            uint8_t payload[9] = {status.enabled};
            uint8_t frame[FRAMES_SIZE_MAX];
            put(&payload[1], (uint32_t)status.statistics.cycles);
            put(&payload[5], (uint32_t)status.statistics.overruns);
            fwrite(frame, 1, frames_encode(frame, payload, sizeof payload), stdout);
            fflush(stdout);
        }
    }
    turntable_stop();
    return 0;
}
