/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A program without an operating system: turns in the main loop, which can sleep until the next interrupt.
 */
#include <stdbool.h>

#include "board.h"
#include "line.h"
#include "program.h"

static volatile bool received;

void line_received(void)
{
    received = true;
}

int main(void)
{
    program_start();
    for (;;) {
        received = false;
        program_turn();
        board_mask();
        if (program_sleeps && !received) {
            board_sleep();
        }
        board_unmask();
    }
}
