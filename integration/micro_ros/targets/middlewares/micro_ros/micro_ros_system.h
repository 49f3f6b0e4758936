/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The services of an operating system that libmicroros needs: memory and, on a microcontroller, the time.
 *
 * rcl allocates memory while it connects.  It gets static memory that the generator defines, so a target does not use a
 * heap after its start.  No block is needed longer than its connection, so all blocks are freed when a connection ends.
 * This also repairs a leak: rcl_init() of ROS 2 Humble copies the name of the enclave, which rmw_microxrcedds never
 * frees.
 *
 * All functions belong to the communication side.
 */
#ifndef EPG_MICRO_ROS_SYSTEM_H
#define EPG_MICRO_ROS_SYSTEM_H

#include <stdbool.h>
#include <stddef.h>

#include <rcutils/allocator.h>

/**
 * Bytes of memory for a node with `topics` topics.  This is a quarter more than was measured with rcl of ROS 2 Humble
 * and the longest names that libmicroros accepts: 800 + 208 * topics on RP2040, and 1888 + 264 * topics where a pointer
 * has 8 bytes.
 */
#define EPG_MICRO_ROS_MEMORY(topics) (304U * sizeof(void *) + (160U + 24U * sizeof(void *)) * (topics))

/** Alignment of this memory. */
#define EPG_MICRO_ROS_ALIGNED _Alignas(max_align_t)

/** Uses `memory` for all allocations from now on.  Returns false if libmicroros refuses the allocator. */
bool epg_micro_ros_memory_start(void *memory, size_t size);

/**
 * Returns the allocator of this memory; it gives NULL if the memory is full.  It is also rcl's default allocator, if
 * this version of rcl allows to set one.
 */
rcutils_allocator_t epg_micro_ros_memory(void);

/** Frees all blocks.  Must be called only when none of them is used any more. */
void epg_micro_ros_memory_free(void);

#endif
