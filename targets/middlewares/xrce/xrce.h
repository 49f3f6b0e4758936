/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * ROS 2 through an agent: the middleware `xrce`, on eProsima's Micro XRCE-DDS client.  docs/ros2.md describes it.
 *
 * There is one in an executable.  It takes no memory but the generator's, never waits, and does a bounded amount of
 * work per poll.
 */
#ifndef EPG_XRCE_H
#define EPG_XRCE_H

#include <stddef.h>
#include <stdint.h>

#include "epg/middleware.h"

/** Bytes around a message in a frame: header of the frame, of the submessage, and whose it is. */
#define EPG_XRCE_OVERHEAD 12

/** Bytes of the largest frame: `mtu`, or what a message of `message` bytes takes. */
#define EPG_XRCE_FRAME(mtu, message)                                                                                   \
    (((message) + EPG_XRCE_OVERHEAD > (mtu) ? (message) + EPG_XRCE_OVERHEAD : (mtu)) + 3) / 4 * 4

/** Bytes of memory of a reliable stream that keeps `history` frames of `frame` bytes: each has its length before it. */
#define EPG_XRCE_HISTORY_SIZE(history, frame) ((history) * ((frame) + 4))

/** Memory of the generator's. */
typedef struct epg_xrce_options {
    uint16_t history;     /**< frames in flight of a reliable stream: 2, 4, 8 or 16 */
    size_t input_frame;   /**< bytes of the largest frame that is taken from the agent */
    size_t output_frame;  /**< bytes of the largest frame that is sent */
    uint8_t *received;    /**< `input_frame` bytes */
    uint8_t *input;       /**< EPG_XRCE_HISTORY_SIZE(history, input_frame) */
    uint8_t *output;      /**< EPG_XRCE_HISTORY_SIZE(history, output_frame) */
    uint8_t *best_effort; /**< `output_frame` bytes */
} epg_xrce_options_t;

/** How it stands with the agent. */
typedef enum epg_xrce_state {
    EPG_XRCE_WAITING,  /**< for an agent */
    EPG_XRCE_CREATING, /**< there is one: node, topics, readers and writers are made */
    EPG_XRCE_RUNNING   /**< topics flow */
} epg_xrce_state_t;

/** For tests and for people who look for a fault. */
typedef struct epg_xrce_status {
    epg_xrce_state_t state;
    uint32_t connections; /**< how often it has been running */
    uint32_t lost;        /**< how often a connection was given up, also one that was not running yet */
    uint32_t refused;     /**< how often the agent has refused to create something */
    uint32_t unsent;      /**< frames for which the transport had no room */
    uint32_t dropped;     /**< frames from the agent that were none, or none of this session */
} epg_xrce_status_t;

/** Communication side. */
epg_xrce_status_t epg_xrce_status(void);

extern const epg_middleware_t epg_xrce;

#endif
