/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Outputs whose hardware may refuse a write: what still makes the component safe.
 *
 * A refused write leaves a pin at a level that nobody knows.  Each kind lists its safe states: levels of some of its
 * outputs at which the component drives nothing, *whatever its other outputs do*.  An H-bridge with two inputs, for
 * example, is safe if both are low or both are high, and no level of one input alone is safe: a component that goes on
 * to write its other input may drive the motor, and backwards, too.
 *
 * So after the first refusal the component's driver writes none of its outputs any more.  The outputs of one safe state
 * are taken over from their peripherals as plain pins.  If there is no safe state whose outputs can be taken over, only a
 * reset of the processor helps: the port stops feeding the watchdog.
 *
 * For ports.  Not thread-safe: all calls from the control side.
 */
#ifndef EPG_OUTPUTS_H
#define EPG_OUTPUTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Outputs of one component, at most. */
#define EPG_OUTPUTS_MAX 8U

/** Outputs that must be low and outputs that must be high, one bit each; the component's first output is bit 0. */
typedef struct epg_safe_state {
    uint8_t low;
    uint8_t high;
} epg_safe_state_t;

/** The outputs of one component: rows `first` to `first + count - 1` in the port's table of outputs. */
typedef struct epg_output_group {
    uint16_t component;
    uint8_t first;
    uint8_t count; /**< up to EPG_OUTPUTS_MAX */
    uint8_t state_count;
    const epg_safe_state_t *states; /**< the preferred one first */
} epg_output_group_t;

/** Level of an output, as written last. */
typedef enum epg_level {
    EPG_LEVEL_SWITCHING, /**< a PWM output that is neither always low nor always high */
    EPG_LEVEL_LOW,
    EPG_LEVEL_HIGH
} epg_level_t;

/** Rows in the port's table of outputs, and groups, at most. */
#define EPG_OUTPUTS_ROWS 64U

typedef struct epg_outputs {
    const epg_output_group_t *groups;
    size_t group_count;
    uint8_t group_of[EPG_OUTPUTS_ROWS]; /**< by row */
    uint8_t levels[EPG_OUTPUTS_ROWS];   /**< by row: epg_level_t */
    bool given_up[EPG_OUTPUTS_ROWS];    /**< by group: its driver writes nothing any more */
    bool refused;                       /**< at least one output has refused a write: the fault EPG_FAULT_OUTPUT */
    uint16_t component;                 /**< of the first one that did */
    bool unsafe;                        /**< a component is in no safe state: only a reset helps */
} epg_outputs_t;

/**
 * Makes the output in `row` of the port's table a plain pin with a level, at once, whatever its peripheral does.  False:
 * that is refused, too, and the pin's level is not known.
 */
typedef bool (*epg_take_over_t)(size_t row, bool high);

/** All outputs are low, and none has refused a write.  `groups` must stay. */
void epg_outputs_start(epg_outputs_t *outputs, const epg_output_group_t *groups, size_t group_count);

/** False: the component's outputs have been taken over, and stay as they are until a reset. */
static inline bool epg_outputs_may_write(const epg_outputs_t *outputs, size_t row)
{
    return row >= EPG_OUTPUTS_ROWS || !outputs->given_up[outputs->group_of[row]];
}

/** An output has been written. */
static inline void epg_outputs_written(epg_outputs_t *outputs, size_t row, epg_level_t level)
{
    if (row < EPG_OUTPUTS_ROWS) {
        outputs->levels[row] = (uint8_t)level;
    }
}

/**
 * An output has refused a write.  Takes outputs of its component over until that is in one of its safe states, and gives
 * the component up.  Of the states that are possible it takes the one that changes the fewest outputs, so that as little
 * as possible happens on the way, and begins with the output that has refused, so that nothing else changes if there is
 * no way.
 */
void epg_outputs_refused(epg_outputs_t *outputs, size_t row, epg_take_over_t take_over);

#ifdef __cplusplus
}
#endif

#endif
