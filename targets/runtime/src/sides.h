/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The form of the words in epg_control_t that both sides use.
 */
#ifndef EPG_SIDES_H
#define EPG_SIDES_H

#include "epg/access.h"
#include "epg/control.h"

/** The word `lease` has the unit 2^EPG_LEASE_SHIFT ns. */
enum { EPG_LEASE_SHIFT = 20 };

/** Lets the accesses of the user's program act at a point.  Returns true if one of them returns true. */
static inline bool epg_reach(epg_control_t *control, epg_access_point_t point)
{
    epg_access_t *const accesses = atomic_load_explicit(&control->accesses, memory_order_acquire);
    return accesses != NULL && accesses->reach(accesses, control, point);
}

#endif
