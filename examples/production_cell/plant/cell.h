/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The robot of all six targets: axes with motors, blocks on belts and magnets, light barriers, and checks that no two
 * parts are in one space.
 *
 * Seen from above, in m:
 *
 *     (0, 0.4)  feeder belt ->   (0.5, 0.4)  the feeder pushes blocks down
 *     robot                      (0.5, 0.25) mould, with the door at 0.22 below it
 *     (0, 0) <- extraction belt  (0.5, 0)    the extractor pulls blocks down
 */
#ifndef CELL_H
#define CELL_H

#include <stdbool.h>

typedef struct cell_inputs {
    double duty_feeder_belt;
    double duty_feeder;
    double duty_door;
    double duty_extractor;
    double duty_extraction_belt;
    double duty_robot;
    bool release_extractor;
    bool release_robot;
} cell_inputs_t;

typedef struct cell_outputs {
    double feeder_belt; /**< angles of the axes behind their gears, rad */
    double feeder;
    double door;
    double extractor;
    double extraction_belt;
    double robot;
    bool feeder_belt_start; /**< light barriers */
    bool feeder_belt_end;
    bool channel; /**< a block is between feeder belt and mould */
    bool mould;
    bool extraction_belt_start;
    bool extraction_belt_end;
    bool extractor_over_belt; /**< switches */
    bool extractor_in_mould;
    bool robot_over_belt;
    bool robot_over_source;
    bool extractor_has_block;
    bool robot_has_block;
    double collisions;                     /**< number of cases in which two parts were in one space */
    double first_collision;                /**< the first of them: a number of `cell_fault_t` */
    double faults;                         /**< collisions and lost blocks */
    double lost;                           /**< blocks that were dropped */
    double moulded;                        /**< blocks that have been taken out of the mould */
    double last_moulded;                   /**< time of the newest of them, s */
    double x1, y1, x2, y2, x3, y3, x4, y4; /**< positions of the blocks, m */
} cell_outputs_t;

/** What two parts did in one space. */
typedef enum cell_fault {
    CELL_IS_GOOD,
    CELL_BLOCKS_OVERLAP,
    CELL_FEEDER_BELT_RUNS_WITH_FEEDER,
    CELL_FEEDER_BELT_RUNS_WITH_ROBOT,
    CELL_EXTRACTION_BELT_RUNS_WITH_EXTRACTOR,
    CELL_EXTRACTION_BELT_RUNS_WITH_ROBOT,
    CELL_DOOR_IS_ON_EXTRACTOR,
    CELL_FEEDER_MEETS_EXTRACTOR,
    CELL_FEEDER_PUSHES_AT_OPEN_DOOR,
    CELL_BLOCK_IS_JAMMED,
    CELL_FAULTS,
} cell_fault_t;

void cell_init(cell_inputs_t *inputs, cell_outputs_t *outputs);
void cell_step(cell_inputs_t *inputs, cell_outputs_t *outputs);

#endif
