/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The simulated production cell.
 */
#include "cell.h"

#include <math.h>
#include <string.h>

enum { BLOCKS = 4 };

static const double step = 0.001; /* s */

/* The drive of each axis: motor and gear of RELbot. */
static const double supply = 12.0;             /* V */
static const double motor_constant = 0.0246;   /* N m/A, V s/rad */
static const double resistance = 2.14;         /* ohm */
static const double rotor_inertia = 3.5e-6;    /* kg m2 */
static const double rotor_friction = 3.333e-6; /* N m s/rad */
static const double gear = 361.0 / 5625.0;     /* load / motor */

static const double size = 0.04;            /* m: edge of a block */
static const double belt_length = 0.5;      /* m between the centres of the first and the last place */
static const double width = 0.4;            /* m between the belts */
static const double mould_depth = 0.15;     /* m from the centre of the feeder belt to the place in the mould */
static const double clearance = 0.02;       /* m between the retracted pusher and a block */
static const double mould_entry = 0.1;      /* m: the pusher is in the mould from here on */
static const double door_reach = 0.195;     /* m: the extractor is below the door from here on */
static const double extractor_reach = 0.25; /* m: its place in the mould */
static const double radius = 0.2;           /* m of the robot's arm */
static const double magnet_reach = 0.006;   /* m */
static const double drop_reach = 0.012;     /* m from a place, at which a block can be put down */
static const double over_belt = 0.05;       /* m: an arm is above a belt */
static const double moving = 0.01;          /* m/s: slower is the rest of a stop */

typedef struct drive {
    double radius;   /* m of the pulley: way / angle behind the gear */
    double mass;     /* kg that it moves */
    double friction; /* N */
    double lowest;   /* m: end stops */
    double highest;
    double position; /* m */
    double speed;    /* m/s */
} drive_t;

enum { FEEDER_BELT, FEEDER, DOOR, EXTRACTOR, EXTRACTION_BELT, ROBOT, DRIVES };

typedef enum place {
    ON_FEEDER_BELT, /* `way` from its start */
    IN_CHANNEL,     /* `way` from the feeder belt towards the door */
    ON_EXTRACTION_BELT,
    AT_EXTRACTOR,
    AT_ROBOT,
    LOST,
} place_t;

typedef struct block {
    place_t place;
    double way; /* m */
    double x;
    double y;
} block_t;

static const drive_t drives_at_start[DRIVES] = {
    [FEEDER_BELT] = {.radius = 0.01, .mass = 1.0, .friction = 12.0, .lowest = -1e9, .highest = 1e9},
    [FEEDER] = {.radius = 0.01, .mass = 0.5, .friction = 12.0, .lowest = 0.0, .highest = 0.175, .position = 0.02},
    [DOOR] = {.radius = 0.008, .mass = 0.4, .friction = 16.0, .lowest = 0.0, .highest = 0.085, .position = 0.06},
    [EXTRACTOR] = {.radius = 0.01, .mass = 0.8, .friction = 12.0, .lowest = 0.0, .highest = 0.255, .position = 0.08},
    [EXTRACTION_BELT] = {.radius = 0.01, .mass = 1.0, .friction = 12.0, .lowest = -1e9, .highest = 1e9},
    [ROBOT] = {.radius = 0.02, .mass = 1.2, .friction = 5.0, .lowest = 0.0, .highest = 0.635, .position = 0.3},
};
static const block_t blocks_at_start[BLOCKS] = {
    {.place = ON_FEEDER_BELT, .way = 0.35},
    {.place = ON_FEEDER_BELT, .way = 0.15},
    {.place = ON_EXTRACTION_BELT, .way = 0.1},
    {.place = ON_EXTRACTION_BELT, .way = 0.3},
};

static drive_t drives[DRIVES];
static block_t blocks[BLOCKS];
static bool faults[CELL_FAULTS]; /* of the present step */
static bool faults_before[CELL_FAULTS];
static double now; /* s */

static double robot_way(void)
{
    return radius * 3.14159265358979323846; /* of the gripper, from belt to belt */
}

/* Axes ------------------------------------------------------------------------------------------------------------- */

static void move(drive_t *drive, double duty)
{
    const double ratio = gear * drive->radius; /* m of the load / rad of the motor */
    const double motor_speed = drive->speed / ratio;
    const double current = duty == 0.0 ? 0.0 : (supply * duty - motor_constant * motor_speed) / resistance; /* coasts */
    const double torque = motor_constant * current - rotor_friction * motor_speed;
    const double mass = rotor_inertia / (ratio * ratio) + drive->mass;
    const double free = drive->speed + torque / ratio / mass * step;
    const double slowed = drive->friction / mass * step;
    drive->speed = fabs(free) <= slowed ? 0.0 : free - copysign(slowed, free);
    drive->position += drive->speed * step;
    if (drive->position < drive->lowest || drive->position > drive->highest) {
        drive->position = drive->position < drive->lowest ? drive->lowest : drive->highest;
        drive->speed = 0.0;
    }
}

/* Blocks ----------------------------------------------------------------------------------------------------------- */

static double pusher(void)
{
    return drives[FEEDER].position - clearance; /* of the centre of a block that it touches */
}

static void locate(block_t *block)
{
    const double angle = drives[ROBOT].position / radius;
    switch (block->place) {
    case ON_FEEDER_BELT:
        block->x = block->way;
        block->y = width;
        break;
    case IN_CHANNEL:
        block->x = belt_length;
        block->y = width - block->way;
        break;
    case ON_EXTRACTION_BELT:
        block->x = belt_length - block->way;
        block->y = 0.0;
        break;
    case AT_EXTRACTOR:
        block->x = belt_length;
        block->y = drives[EXTRACTOR].position;
        break;
    case AT_ROBOT:
        block->x = -radius * sin(angle);
        block->y = radius + radius * cos(angle);
        break;
    case LOST:
    default:
        break;
    }
}

static void carry(block_t *block, double way_feeder_belt, double way_extraction_belt)
{
    if (block->place == ON_FEEDER_BELT) {
        block->way = fmin(block->way + way_feeder_belt, belt_length); /* there is a fence at the end */
    }
    if (block->place == ON_EXTRACTION_BELT) {
        block->way = fmin(block->way + way_extraction_belt, belt_length);
    }
    const double pushed = pusher();
    if (block->place == ON_FEEDER_BELT && pushed > 0.0 && block->way > belt_length - size) {
        faults[CELL_BLOCK_IS_JAMMED] |= block->way < belt_length - 0.003;
        block->place = IN_CHANNEL;
        block->way = pushed;
    }
    if (block->place == IN_CHANNEL) {
        block->way = fmax(block->way, pushed);
    }
}

static bool is_near(double x, double y, double place_x, double place_y)
{
    return hypot(x - place_x, y - place_y) < drop_reach;
}

/** The magnet of an arm whose gripper is at (x, y). */
static void hold(place_t arm, bool release, double x, double y, cell_outputs_t *outputs)
{
    block_t *held = NULL;
    for (int i = 0; i < BLOCKS; i++) {
        held = blocks[i].place == arm ? &blocks[i] : held;
    }
    if (held == NULL && !release) {
        for (int i = 0; i < BLOCKS; i++) {
            block_t *block = &blocks[i];
            const bool is_free = block->place != AT_EXTRACTOR && block->place != AT_ROBOT && block->place != LOST;
            if (held == NULL && is_free && hypot(block->x - x, block->y - y) < magnet_reach) {
                const bool was_moulded = block->place == IN_CHANNEL;
                block->place = arm;
                held = block;
                outputs->moulded += was_moulded ? 1.0 : 0.0;
                outputs->last_moulded = was_moulded ? now : outputs->last_moulded;
            }
        }
    } else if (held != NULL && release) {
        if (is_near(x, y, 0.0, width)) {
            held->place = ON_FEEDER_BELT;
            held->way = fmax(x, 0.0);
        } else if (is_near(x, y, belt_length, 0.0) || is_near(x, y, 0.0, 0.0)) {
            held->place = ON_EXTRACTION_BELT;
            held->way = belt_length - x;
        } else if (arm == AT_EXTRACTOR && y > extractor_reach - drop_reach) {
            held->place = IN_CHANNEL;
            held->way = width - y;
        } else {
            held->place = LOST;
            outputs->lost += 1.0;
        }
    }
}

/** True if the centre of a block is within these limits. */
static bool sees(double x_from, double x_to, double y_from, double y_to)
{
    bool seen = false;
    for (int i = 0; i < BLOCKS; i++) {
        const block_t *block = &blocks[i];
        seen |= block->place != LOST && block->x > x_from && block->x < x_to && block->y > y_from && block->y < y_to;
    }
    return seen;
}

static bool is_held(place_t arm)
{
    bool held = false;
    for (int i = 0; i < BLOCKS; i++) {
        held |= blocks[i].place == arm;
    }
    return held;
}

/* Checks ----------------------------------------------------------------------------------------------------------- */

static bool moves(int drive)
{
    return fabs(drives[drive].speed) > moving;
}

static void check(cell_outputs_t *outputs)
{
    const double extractor = drives[EXTRACTOR].position, robot = drives[ROBOT].position;
    const double feeder = drives[FEEDER].position;
    const double opening = drives_at_start[DOOR].highest - drives[DOOR].position;
    for (int i = 0; i < BLOCKS; i++) {
        for (int j = 0; j < i; j++) {
            const bool are_here = blocks[i].place != LOST && blocks[j].place != LOST;
            const double reach = 0.98 * size;
            faults[CELL_BLOCKS_OVERLAP] |=
                are_here && fabs(blocks[i].x - blocks[j].x) < reach && fabs(blocks[i].y - blocks[j].y) < reach;
        }
    }
    faults[CELL_FEEDER_BELT_RUNS_WITH_FEEDER] |= pusher() > 0.0 && moves(FEEDER_BELT);
    faults[CELL_FEEDER_BELT_RUNS_WITH_ROBOT] |= robot < over_belt && moves(FEEDER_BELT);
    faults[CELL_EXTRACTION_BELT_RUNS_WITH_EXTRACTOR] |= extractor < over_belt && moves(EXTRACTION_BELT);
    faults[CELL_EXTRACTION_BELT_RUNS_WITH_ROBOT] |= robot > robot_way() - over_belt && moves(EXTRACTION_BELT);
    faults[CELL_DOOR_IS_ON_EXTRACTOR] |= extractor > door_reach && opening < 1.5 * size;
    faults[CELL_FEEDER_MEETS_EXTRACTOR] |= extractor > door_reach && feeder > mould_entry;
    faults[CELL_FEEDER_PUSHES_AT_OPEN_DOOR] |= feeder > mould_entry && drives[FEEDER].speed > moving && opening > 0.01;
    for (int i = CELL_IS_GOOD + 1; i < CELL_FAULTS; i++) {
        if (faults[i] && !faults_before[i]) {
            outputs->collisions += 1.0;
            outputs->first_collision = outputs->first_collision > 0.0 ? outputs->first_collision : (double)i;
        }
    }
    outputs->faults = outputs->collisions + outputs->lost;
    memcpy(faults_before, faults, sizeof faults);
    memset(faults, 0, sizeof faults);
}

/* Steps ------------------------------------------------------------------------------------------------------------ */

/** The angle of an axis behind its gear, rad. */
static double angle(int drive)
{
    return drives[drive].position / drives[drive].radius;
}

static void sense(cell_outputs_t *outputs)
{
    const double before = 0.03, after = 0.08, end = 0.01, place = 0.005, at_switch = 0.06;
    outputs->feeder_belt = angle(FEEDER_BELT);
    outputs->feeder = angle(FEEDER);
    outputs->door = angle(DOOR);
    outputs->extractor = angle(EXTRACTOR);
    outputs->extraction_belt = angle(EXTRACTION_BELT);
    outputs->robot = angle(ROBOT);
    outputs->feeder_belt_start = sees(-before, after, width - end, width + end);
    outputs->feeder_belt_end = sees(belt_length - end, belt_length + end, width - end, width + end);
    const double mould = width - mould_depth;
    outputs->channel = sees(belt_length - end, belt_length + end, mould + 0.8 * place, width - place);
    outputs->mould = sees(belt_length - end, belt_length + end, mould - place, mould + place);
    outputs->extraction_belt_start = sees(belt_length - after, belt_length + before, -end, end);
    outputs->extraction_belt_end = sees(-end, end, -end, end);
    outputs->extractor_over_belt = drives[EXTRACTOR].position < at_switch;
    outputs->extractor_in_mould = drives[EXTRACTOR].position > 0.17;
    outputs->robot_over_belt = drives[ROBOT].position < at_switch;
    outputs->robot_over_source = drives[ROBOT].position > robot_way() - at_switch;
    outputs->extractor_has_block = is_held(AT_EXTRACTOR);
    outputs->robot_has_block = is_held(AT_ROBOT);
    outputs->x1 = blocks[0].x;
    outputs->y1 = blocks[0].y;
    outputs->x2 = blocks[1].x;
    outputs->y2 = blocks[1].y;
    outputs->x3 = blocks[2].x;
    outputs->y3 = blocks[2].y;
    outputs->x4 = blocks[3].x;
    outputs->y4 = blocks[3].y;
}

void cell_init(cell_inputs_t *inputs, cell_outputs_t *outputs)
{
    (void)inputs;
    memcpy(drives, drives_at_start, sizeof drives);
    memcpy(blocks, blocks_at_start, sizeof blocks);
    memset(faults, 0, sizeof faults);
    memset(faults_before, 0, sizeof faults_before);
    memset(outputs, 0, sizeof *outputs);
    now = 0.0;
    for (int i = 0; i < BLOCKS; i++) {
        locate(&blocks[i]);
    }
    sense(outputs);
}

void cell_step(cell_inputs_t *inputs, cell_outputs_t *outputs)
{
    const double feeder_belt = drives[FEEDER_BELT].position, extraction_belt = drives[EXTRACTION_BELT].position;
    now += step;
    move(&drives[FEEDER_BELT], inputs->duty_feeder_belt);
    move(&drives[FEEDER], inputs->duty_feeder);
    move(&drives[DOOR], inputs->duty_door);
    move(&drives[EXTRACTOR], inputs->duty_extractor);
    move(&drives[EXTRACTION_BELT], inputs->duty_extraction_belt);
    move(&drives[ROBOT], inputs->duty_robot);
    const double turned = drives[ROBOT].position / radius;
    hold(AT_EXTRACTOR, inputs->release_extractor, belt_length, drives[EXTRACTOR].position, outputs);
    hold(AT_ROBOT, inputs->release_robot, -radius * sin(turned), radius + radius * cos(turned), outputs);
    for (int i = 0; i < BLOCKS; i++) {
        carry(&blocks[i], drives[FEEDER_BELT].position - feeder_belt,
              drives[EXTRACTION_BELT].position - extraction_belt);
        locate(&blocks[i]);
    }
    check(outputs);
    sense(outputs);
}
