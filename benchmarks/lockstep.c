/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Prints the time in ns in which one process asks another one for a step, and gets its answer, over two pipes.
 */
#define _POSIX_C_SOURCE 200809L

#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static double now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec * 1e9 + (double)now.tv_nsec;
}

int main(int argc, char **argv)
{
    const long steps = argc > 1 ? strtol(argv[1], NULL, 10) : 1;
    int ask[2];
    int answer[2];
    if (pipe(ask) != 0 || pipe(answer) != 0) {
        return 1;
    }
    double time = 0.0;
    const pid_t child = fork();
    if (child == 0) {
        close(ask[1]);
        while (read(ask[0], &time, sizeof time) == sizeof time) {
            if (write(answer[1], &time, sizeof time) != sizeof time) {
                return 1;
            }
        }
        return 0;
    }
    const double begin_ns = now_ns();
    for (long step = 0; step < steps; step++) {
        if (write(ask[1], &time, sizeof time) != sizeof time || read(answer[0], &time, sizeof time) != sizeof time) {
            return 1;
        }
    }
    printf("%.0f\n", (now_ns() - begin_ns) / (double)steps);
    return 0;
}
