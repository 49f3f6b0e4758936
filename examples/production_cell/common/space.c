/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Leases of spaces that two machines share.
 */
#include "space.h"

bool space_is(const space_message_t *heard, int state)
{
    return heard->state > (double)state - 0.5 && heard->state < (double)state + 0.5;
}

bool space_is_leased(const space_message_t *heard, double asked, double now, double lease)
{
    return heard->state > 0.5 && heard->echo > asked && heard->echo <= now && now - heard->echo < lease;
}

bool space_is_free(const space_owner_t *owner, const space_message_t *heard, double now, double timeout)
{
    const double end = owner->granted + timeout;
    return !owner->grants && now > end && heard->echo > end && heard->echo <= now && !space_is(heard, SPACE_INSIDE);
}

void space_grant(space_owner_t *owner, bool grants, double now)
{
    owner->grants = grants;
    if (grants) {
        owner->granted = now;
    }
}
