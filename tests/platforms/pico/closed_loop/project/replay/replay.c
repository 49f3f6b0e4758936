#include "replay.h"

/* Angles in rad, one pair per control cycle; recording.c fills them in before main(). */
double replay_angles[1000000][2];

static size_t replay_cycle;

static void show(replay_outputs_t *outputs)
{
    outputs->angle_pan = replay_angles[replay_cycle][0];
    outputs->angle_tilt = replay_angles[replay_cycle][1];
}

void replay_init(const replay_inputs_t *inputs, replay_outputs_t *outputs)
{
    (void)inputs;
    replay_cycle = 0;
    show(outputs);
}

void replay_step(const replay_inputs_t *inputs, replay_outputs_t *outputs)
{
    (void)inputs;
    replay_cycle++;
    show(outputs);
}
