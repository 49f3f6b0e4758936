/**
 * @file
 * What rcl allocates for one connection.
 *
 * rcl_init() of ROS 2 Humble copies the name of the enclave, and rmw_microxrcedds never frees it: that would be memory
 * lost with each reconnection.  So all blocks of a connection are kept in a list, and what is left of them at its end
 * is freed.
 */
#ifndef EPG_MICRO_ROS_MEMORY_H
#define EPG_MICRO_ROS_MEMORY_H

#include <rcutils/allocator.h>

/** On the heap of the C library.  Communication side. */
rcutils_allocator_t epg_micro_ros_memory(void);

/** Frees every block that has not been.  None of them is used any more. */
void epg_micro_ros_memory_free(void);

#endif
