#include "replay.h"

/* Angles in rad, one pair per control cycle.  recording.c has them: variables of a model begin anew with the model. */
extern double recorded_angles[1000000][2];

static size_t replay_cycle;

static void show(replay_outputs_t *outputs)
{
    outputs->angle_pan = recorded_angles[replay_cycle][0];
    outputs->angle_tilt = recorded_angles[replay_cycle][1];
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
