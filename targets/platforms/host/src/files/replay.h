/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Replay: the model computes again from the inputs of a recording, cycle by cycle.
 *
 * A recording is a CSV file.  Its first line is a comment with facts for `epg replay`, the second one has the names of
 * the columns: `time` in s, `cycle`, `inputs.<name>`, others such as `outputs.<name>`, and `changes` as the last one.
 * `cycle` is the number of the control cycle since the enabling, from 1; 0 while the target is disabled.  `changes` has
 * the parameters that changed in this cycle, before the model's step, as words `<parameter>=<number>` with blanks
 * between them.  In cycle 1 these are all parameters that differ from the generated ones.
 *
 * The control cycle, the initialisation and the model are those of every other run.  Sensors, actuators, setpoints and
 * the plant take no part.  The time is that of the recording and simulated, so the program can be stopped in a debugger.
 */
#ifndef EPG_HOST_REPLAY_H
#define EPG_HOST_REPLAY_H

#include <stdio.h>

#include "epg/host.h"

/**
 * Replays each enabled part of the recording `path`, and writes its cycles to `trace` if that is not NULL.  Returns the
 * exit status of the program, after a message `path:line: error: ...` if the recording is wrong.
 */
int epg_host_replay(const epg_host_target_t *host, const char *path, FILE *trace, bool quiet);

#endif
