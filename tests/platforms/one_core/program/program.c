/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Sums of floating-point numbers, in as many registers of the FPU as there are.
 */
#include "program.h"

volatile uint32_t sums, wrong_sums;

/** Sixteen numbers that depend on each other; the compiler keeps most of them in registers. */
static float sum(void)
{
    float x[16];
    for (int i = 0; i < 16; i++) {
        x[i] = 0.1F * (float)(i + 1);
    }
    for (int round = 0; round < 200; round++) {
#pragma GCC unroll 16
        for (int i = 0; i < 16; i++) {
            x[i] = 0.75F * x[i] + 0.2F * x[(i + 5) % 16] + 0.01F;
        }
    }
    float total = 0.0F;
    for (int i = 0; i < 16; i++) {
        total += x[i];
    }
    return total;
}

void sums_compute(void)
{
    static float first;
    const float now = sum();
    if (sums == 0U) {
        first = now;
    }
    sums++;
    if (now != first) {
        wrong_sums++;
    }
}
