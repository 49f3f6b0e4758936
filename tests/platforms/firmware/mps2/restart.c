/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Sends the outputs of a model that never resets its state: after the start of the program, and after enabling again.
 */
#include <stdint.h>

#include "line.h"
#include "program.h"
#include "worn_firmware.h"
#include "worn_model.h"

extern worn_model_outputs_t worn_outputs;

enum { RUNS = 3, CYCLES = 50 };

static uint64_t now_ns;

uint64_t worn_time_ns(void)
{
    return now_ns;
}

uint32_t worn_boot_id(void)
{
    return 1;
}

static void cycle(void)
{
    worn_cycle();
    now_ns += 1000000U;
}

void program_start(void)
{
    line_start(0);
    (void)worn_start();
    for (int run = 0; run < RUNS; run++) {
        for (int i = 0; i < CYCLES; i++) {
            cycle();
            line_write_all(0, &worn_outputs, sizeof worn_outputs);
        }
        worn_enable(false);
        cycle();
        cycle();
        worn_enable(true);
    }
}

void program_turn(void)
{
}
