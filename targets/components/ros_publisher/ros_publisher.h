/**
 * @file
 * A value to publish.
 */
#ifndef EPG_ROS_PUBLISHER_H
#define EPG_ROS_PUBLISHER_H

#include "epg/finite.h"

/** Puts `value` into `slot`; one that is not finite (a conversion that overflows) leaves the one before it there. */
static inline void epg_ros_publisher_write(double *slot, double value)
{
    if (epg_is_finite(value)) {
        *slot = value;
    }
}

#endif
