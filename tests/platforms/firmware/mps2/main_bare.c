/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A program without an operating system: turns in the main loop.
 *
 * QEMU counts instructions as the board's time.  A board that sleeps would run much faster than real time.
 */
#include "line.h"
#include "program.h"

void line_received(void)
{
}

int main(void)
{
    program_start();
    for (;;) {
        program_turn();
    }
}
