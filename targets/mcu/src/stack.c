/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The use of the stacks: an unused stack is filled with a pattern.  The lowest word without the pattern shows how far
 * the stack has been used.
 */
#include "epg/family.h"

#define PATTERN 0xE96E96E9U

void epg_mcu_stack_paint(uint32_t *bottom, const uint32_t *end)
{
    for (volatile uint32_t *word = bottom; word < end; word++) {
        *word = PATTERN;
    }
}

uint32_t epg_mcu_stack_used(const epg_mcu_stack_t *stack, uint32_t unpainted)
{
    const volatile uint32_t *word = stack->bottom + unpainted / sizeof *word;
    while (word < stack->top && *word == PATTERN) {
        word++;
    }
    return (uint32_t)((uintptr_t)stack->top - (uintptr_t)word);
}

bool epg_mcu_stack_full(const epg_mcu_stack_t *stack)
{
    return *stack->bottom != PATTERN;
}
