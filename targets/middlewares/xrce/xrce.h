/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The middleware `xrce`: ROS 2 through an agent, with eProsima's Micro XRCE-DDS client.  docs/ros2.md describes it.
 *
 * DDS, the network protocol of ROS 2, is too large for a microcontroller.  With XRCE-DDS the target is a *client*,
 * which exchanges small frames over a serial line or UDP with an *agent*.  The agent is a program on a computer; it
 * makes the client's topics, readers and writers in DDS.
 *
 * An executable can contain one such client.  It uses only memory that the generator defines, never waits, and does a
 * bounded amount of work per poll.
 */
#ifndef EPG_XRCE_H
#define EPG_XRCE_H

#include <stddef.h>
#include <stdint.h>

#include "epg/middleware.h"

/** Bytes around a message in a frame: the headers of frame and submessage, and the ids of request and writer. */
#define EPG_XRCE_OVERHEAD 12

/** Bytes of the largest frame: `mtu`, or more if a message of `message` bytes needs it; a multiple of 4. */
#define EPG_XRCE_FRAME(mtu, message)                                                                                   \
    (((message) + EPG_XRCE_OVERHEAD > (mtu) ? (message) + EPG_XRCE_OVERHEAD : (mtu)) + 3) / 4 * 4

/** Bytes of memory of a reliable stream with `history` frames of `frame` bytes, each with its length before it. */
#define EPG_XRCE_HISTORY_SIZE(history, frame) ((history) * ((frame) + 4))

/** The memory that the generator defines for the client. */
typedef struct epg_xrce_options {
    uint16_t history;     /**< largest number of unacknowledged frames of a reliable stream: 2, 4, 8 or 16 */
    size_t input_frame;   /**< bytes of the largest frame that is accepted from the agent */
    size_t output_frame;  /**< bytes of the largest frame that is sent */
    uint8_t *received;    /**< `input_frame` bytes */
    uint8_t *input;       /**< EPG_XRCE_HISTORY_SIZE(history, input_frame) */
    uint8_t *output;      /**< EPG_XRCE_HISTORY_SIZE(history, output_frame) */
    uint8_t *best_effort; /**< `output_frame` bytes */
} epg_xrce_options_t;

/** The state of the connection to the agent. */
typedef enum epg_xrce_state {
    EPG_XRCE_WAITING,  /**< no agent has answered yet */
    EPG_XRCE_CREATING, /**< the agent is creating the node, topics, readers and writers */
    EPG_XRCE_RUNNING   /**< messages are exchanged */
} epg_xrce_state_t;

/** Counters for tests, and for users who look for a fault. */
typedef struct epg_xrce_status {
    epg_xrce_state_t state;
    uint32_t connections; /**< how often the state has become EPG_XRCE_RUNNING */
    uint32_t lost;        /**< how often a connection was given up, also before it was running */
    uint32_t refused;     /**< how often the agent refused a session or an entity */
    uint32_t unsent;      /**< frames for which the transport had no room */
    uint32_t dropped;     /**< received frames that were malformed, or did not belong to this session */
} epg_xrce_status_t;

/** Returns the counters.  Communication side. */
epg_xrce_status_t epg_xrce_status(void);

extern const epg_middleware_t epg_xrce;

#endif
