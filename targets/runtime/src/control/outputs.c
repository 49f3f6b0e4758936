/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The way to a safe state for a component whose output refused a write.
 */
#include "epg/outputs.h"

#include "epg/fault.h"

/** Largest number of steps to a safe state: each output is taken over at most twice, or refuses once. */
#define STEPS (3U * EPG_OUTPUTS_MAX)

/** The known levels of a component's outputs, one bit for each. */
typedef struct levels {
    unsigned int low;
    unsigned int high;
} levels_t;

void epg_outputs_start(epg_outputs_t *outputs, const epg_output_group_t *groups, size_t group_count)
{
    *outputs = (epg_outputs_t){.groups = groups, .group_count = group_count};
    for (size_t i = 0; i < EPG_OUTPUTS_ROWS; i++) {
        outputs->levels[i] = EPG_LEVEL_LOW;
    }
    for (size_t i = 0; i < group_count; i++) {
        for (size_t row = groups[i].first; row < (size_t)groups[i].first + groups[i].count; row++) {
            outputs->group_of[row] = (uint8_t)i;
        }
    }
}

static unsigned int count_bits(unsigned int bits)
{
    unsigned int count = 0;
    for (; bits != 0U; bits &= bits - 1U) {
        count++;
    }
    return count;
}

static levels_t levels_of(const epg_outputs_t *outputs, const epg_output_group_t *group)
{
    levels_t levels = {0};
    for (unsigned int i = 0; i < group->count; i++) {
        const uint8_t level = outputs->levels[group->first + i];
        levels.low |= (level == EPG_LEVEL_LOW ? 1U : 0U) << i;
        levels.high |= (level == EPG_LEVEL_HIGH ? 1U : 0U) << i;
    }
    return levels;
}

/** Returns the outputs whose levels differ from those of a state. */
static unsigned int different(const epg_safe_state_t *state, levels_t levels)
{
    return (state->low & ~levels.low) | (state->high & ~levels.high);
}

/** Returns the state that changes the fewest outputs and does not need one of `lost`; NULL if there is none. */
static const epg_safe_state_t *nearest(const epg_output_group_t *group, unsigned int lost, levels_t levels)
{
    const epg_safe_state_t *found = NULL;
    for (uint8_t i = 0; i < group->state_count; i++) {
        const epg_safe_state_t *state = &group->states[i];
        if ((((unsigned int)state->low | state->high) & lost) != 0U) {
            continue;
        }
        if (found == NULL || count_bits(different(state, levels)) < count_bits(different(found, levels))) {
            found = state;
        }
    }
    return found;
}

/** `refused` is the bit of the output that refused a write.  Returns false if no safe state can be reached. */
static bool make_safe(const epg_output_group_t *group, unsigned int refused, levels_t levels, epg_take_over_t take_over)
{
    unsigned int unknown = refused; /* outputs of unknown level that are not taken over yet */
    unsigned int lost = 0;          /* outputs that cannot be taken over */
    for (unsigned int step = 0; step < STEPS; step++) {
        const epg_safe_state_t *state = nearest(group, lost, levels);
        if (state == NULL) {
            return false;
        }
        const unsigned int uncertain = ((unsigned int)state->low | state->high) & unknown;
        const unsigned int pending = uncertain != 0U ? uncertain : different(state, levels);
        if (pending == 0U) {
            return true;
        }
        const unsigned int bit = pending & (~pending + 1U); /* the lowest bit of `pending` */
        const bool high = (state->high & bit) != 0U;
        unknown &= ~bit;
        if (!take_over(group->first + count_bits(bit - 1U), high)) {
            lost |= bit;
            continue;
        }
        levels.low = high ? levels.low & ~bit : levels.low | bit;
        levels.high = high ? levels.high | bit : levels.high & ~bit;
    }
    return false;
}

void epg_outputs_refused(epg_outputs_t *outputs, size_t row, epg_take_over_t take_over)
{
    if (row >= EPG_OUTPUTS_ROWS || outputs->group_count == 0U) { /* the output belongs to an unknown component */
        outputs->component = EPG_NO_COMPONENT;
        outputs->refused = true;
        outputs->unsafe = true;
        return;
    }
    const uint8_t number = outputs->group_of[row];
    const epg_output_group_t *group = &outputs->groups[number];
    if (!outputs->refused) {
        outputs->component = group->component;
        outputs->refused = true;
    }
    outputs->given_up[number] = true;
    if (!make_safe(group, 1U << (row - group->first), levels_of(outputs, group), take_over)) {
        outputs->unsafe = true;
    }
}
