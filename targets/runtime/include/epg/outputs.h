/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Outputs whose driver may refuse a write: how the component is made safe nevertheless.
 *
 * The level of a pin is unknown after a refused write.  Each component kind lists its safe states: levels of some of
 * its outputs at which the component drives nothing, *whatever its other outputs do*.  For example, an H-bridge with
 * two inputs is safe if both are low or both are high.  No level of one input alone is safe: if the driver continued to
 * write the other input, the bridge could drive the motor, even backwards.
 *
 * Therefore the component's driver writes none of its outputs any more after the first refusal.  This module selects a
 * safe state and takes its outputs over from their peripherals, as plain pins with a fixed level.  If there is no safe
 * state whose outputs can be taken over, only a reset of the processor helps: the port then stops feeding the watchdog.
 *
 * For ports.  Not thread-safe: all calls must come from the control side.
 */
#ifndef EPG_OUTPUTS_H
#define EPG_OUTPUTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Largest number of outputs of one component. */
#define EPG_OUTPUTS_MAX 8U

/**
 * A safe state: the outputs that must be low, and the outputs that must be high, one bit for each.  The component's
 * first output is bit 0.
 */
typedef struct epg_safe_state {
    uint8_t low;
    uint8_t high;
} epg_safe_state_t;

/** The outputs of one component: rows `first` to `first + count - 1` in the port's table of outputs. */
typedef struct epg_output_group {
    uint16_t component;
    uint8_t first;
    uint8_t count; /**< at most EPG_OUTPUTS_MAX */
    uint8_t state_count;
    const epg_safe_state_t *states; /**< the preferred one is the first */
} epg_output_group_t;

/** The level of an output that was written last. */
typedef enum epg_level {
    EPG_LEVEL_SWITCHING, /**< a PWM output that is neither always low nor always high */
    EPG_LEVEL_LOW,
    EPG_LEVEL_HIGH
} epg_level_t;

/** Largest number of rows in the port's table of outputs, and of groups. */
#define EPG_OUTPUTS_ROWS 64U

typedef struct epg_outputs {
    const epg_output_group_t *groups;
    size_t group_count;
    uint8_t group_of[EPG_OUTPUTS_ROWS]; /**< for each row, its group */
    uint8_t levels[EPG_OUTPUTS_ROWS];   /**< for each row, its epg_level_t */
    bool given_up[EPG_OUTPUTS_ROWS];    /**< for each group: its driver must not write any more */
    bool refused;                       /**< at least one output has refused a write: the fault EPG_FAULT_OUTPUT */
    uint16_t component;                 /**< component of the first output that refused */
    bool unsafe;                        /**< a component is not in a safe state: only a reset helps */
} epg_outputs_t;

/**
 * Makes the output in `row` of the port's table a plain pin with a fixed level, at once, whatever its peripheral does.
 * Returns false if that is refused, too; the level of the pin is unknown then.
 */
typedef bool (*epg_take_over_t)(size_t row, bool high);

/** Starts with all outputs low, and without refused writes.  `groups` must stay valid. */
void epg_outputs_start(epg_outputs_t *outputs, const epg_output_group_t *groups, size_t group_count);

/** Returns false if the component was given up: its outputs must stay as they are until a reset. */
static inline bool epg_outputs_may_write(const epg_outputs_t *outputs, size_t row)
{
    return row >= EPG_OUTPUTS_ROWS || !outputs->given_up[outputs->group_of[row]];
}

/** Records that an output was written. */
static inline void epg_outputs_written(epg_outputs_t *outputs, size_t row, epg_level_t level)
{
    if (row < EPG_OUTPUTS_ROWS) {
        outputs->levels[row] = (uint8_t)level;
    }
}

/**
 * Reacts to an output that has refused a write: gives its component up, and takes outputs over until the component is
 * in one of its safe states.
 *
 * Of the possible states it selects the one that changes the fewest outputs, so that as little as possible happens on
 * the way.  It begins with the output that has refused, so that no other output changes if there is no way.
 */
void epg_outputs_refused(epg_outputs_t *outputs, size_t row, epg_take_over_t take_over);

#ifdef __cplusplus
}
#endif

#endif
