/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A space that two machines share: its owner (a belt, or the door) lets its guest (the feeder, an arm) in by a lease.
 *
 * Both send a message all the time.  It has a stamp of the sender's clock, the newest stamp that the sender has received
 * from the other one (its echo), and a state.  The guest's state is `SPACE_INSIDE`, `SPACE_WANTED` or `SPACE_AWAY`.  The
 * owner's state is 1 if it grants a lease.
 *
 * The guest measures the age of a grant by its own clock, from its own stamp that came back: the time on the way makes a
 * lease shorter, and never longer.  The owner waits `timeout` after its last grant.  By then the lease has ended, because
 *
 *     lease (1 + drift) + one control cycle < timeout (1 - drift).
 *
 * Then the owner needs a message that the guest has sent after that: it echoes a stamp that is not older.
 *
 * Zeros mean: the guest is inside, the owner grants nothing.  A subscriber with `on_timeout: zero` and `initial: 0` makes
 * zeros of silence.
 */
#ifndef SPACE_H
#define SPACE_H

#include <stdbool.h>

/** States of a guest. */
enum { SPACE_INSIDE = 0, SPACE_WANTED = 1, SPACE_AWAY = 2 };

/** A message, with times in s. */
typedef struct space_message {
    double stamp;
    double echo;
    double state;
} space_message_t;

/** The owner's side of a space.  All members are 0 at the start: then the owner waits as after a grant at time 0. */
typedef struct space_owner {
    double granted; /**< time of the last grant, s */
    bool grants;
} space_owner_t;

/** True if the guest has the state `state`. */
bool space_is(const space_message_t *heard, int state);

/**
 * True if the guest may enter the space, or move in it: a grant answers a message of the last `lease` seconds, which the
 * guest has sent since it asked for the space at the time `asked`.  Earlier grants were for something else, such as homing.
 */
bool space_is_leased(const space_message_t *heard, double asked, double now, double lease);

/** True if the owner may use the space: the guest has no lease, and has said after its end that it is not inside. */
bool space_is_free(const space_owner_t *owner, const space_message_t *heard, double now, double timeout);

/** Grants a lease, or none, from now on. */
void space_grant(space_owner_t *owner, bool grants, double now);

#endif
