/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What libmicroros asks of an operating system: memory and, on a microcontroller, the time.
 *
 * rcl allocates while it connects.  Here that comes out of static memory of the generator's, so a target uses no heap
 * after its start; and as nothing in it outlives a connection, all of it is free again when one has ended.  That matters
 * too because rcl_init() of ROS 2 Humble copies the name of the enclave, and rmw_microxrcedds never frees it.
 *
 * Communication side.
 */
#ifndef EPG_MICRO_ROS_SYSTEM_H
#define EPG_MICRO_ROS_SYSTEM_H

#include <stdbool.h>
#include <stddef.h>

#include <rcutils/allocator.h>

/**
 * Bytes for a node with `topics` topics: a quarter more than was measured with rcl of ROS 2 Humble and names as long as
 * libmicroros takes them, which is 800 + 208 * topics on RP2040, and 1888 + 264 * topics where a pointer has 8 bytes.
 */
#define EPG_MICRO_ROS_MEMORY(topics) (304U * sizeof(void *) + (160U + 24U * sizeof(void *)) * (topics))

/** Alignment of that memory. */
#define EPG_MICRO_ROS_ALIGNED _Alignas(max_align_t)

/** Takes `memory` for all that is allocated from now on; false: libmicroros has refused it. */
bool epg_micro_ros_memory_start(void *memory, size_t size);

/** Allocates from it; NULL when it is full.  The same functions are rcl's default ones, where it lets them be set. */
rcutils_allocator_t epg_micro_ros_memory(void);

/** Frees every block that has not been.  None of them is used any more. */
void epg_micro_ros_memory_free(void);

#endif
