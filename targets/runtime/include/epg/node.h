/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A ROS 2 node without its transport: the part that all ROS 2 middlewares share.
 *
 * This module makes names, decides which publications are due, and converts messages to values and back.  A middleware
 * only carries the bytes:
 *
 * 1. It makes one reader for each of `target->subscriptions` and one writer for each of `target->publications`, with
 *    the names that epg_node_topic() gives.
 * 2. It calls epg_node_listen(), and then passes each message that has arrived to epg_node_receive().
 * 3. It asks for the time and passes the answers to `clock` (epg/wall_clock.h).
 * 4. It calls epg_node_poll(), which passes the publications that are due to the middleware's `send` function.  All
 *    values of one call belong to one control cycle.
 *
 * The generator defines the object in `target->node_state` for a middleware whose `uses` names `node`.
 *
 * All functions belong to the communication side.
 */
#ifndef EPG_NODE_H
#define EPG_NODE_H

#include "epg/target.h"
#include "epg/wall_clock.h"

/** Bytes of the longest node name, namespace and topic name, with the terminating zero. */
#define EPG_NODE_NAME_SIZE 64
#define EPG_NODE_SPACE_SIZE 64
#define EPG_NODE_TOPIC_SIZE 192

/** The state of one publication. */
typedef struct epg_node_publication {
    uint64_t due_ns; /**< next due time, in board time; for EPG_TOPIC_CYCLES, the tick of the due cycle */
    bool waiting;    /**< it was due, but the middleware had no room yet */
    bool sent;       /**< it was sent at least once: `sent_values` are valid */
} epg_node_publication_t;

/** The counters whose growth makes the level of the diagnostics WARN for a while. */
enum { EPG_NODE_OVERRUNS, EPG_NODE_TIMEOUTS, EPG_NODE_REFUSED, EPG_NODE_MALFORMED, EPG_NODE_STEPS, EPG_NODE_WARNINGS };

typedef struct epg_node_warning {
    uint32_t count;    /**< value of the counter in the last diagnostics */
    uint64_t until_ns; /**< time at which the warning ends, in board time; 0: the counter has never grown */
} epg_node_warning_t;

enum { EPG_NODE_PUBLISHERS = 8 };

/**
 * The edge from `false` to `true` on the topic that enables the target.  Only an edge enables it, because a node can
 * repeat `true`.  Each message `false` is a stop.
 */
typedef struct epg_node_edge {
    bool low;   /**< the last message was `false` */
    bool early; /**< it came so soon after the connection that it may have waited in the agent */
    bool risen; /**< there was a `true`, at `risen_ns` */
    uint64_t risen_ns;
    uint32_t high[EPG_NODE_PUBLISHERS]; /**< senders whose own last message was `true`, the newest first; 0: none */
    uint32_t ignored;   /**< number of messages `true` that were ignored while the target was disabled */
    const char *advice; /**< reason why the newest `true` was ignored, and the remedy; NULL: none was */
} epg_node_edge_t;

typedef struct epg_node {
    /* The generator sets these members. */
    double *values;                       /**< `monitor_count` numbers */
    double *sent_values;                  /**< `monitor_count` numbers sent last, for EPG_TOPIC_CHANGE; may be NULL */
    double *received;                     /**< room for the values of the largest subscription; may be NULL */
    epg_node_publication_t *publications; /**< one per publication */
    unsigned char *buffer;                /**< `buffer_size` bytes: room for the largest publication */
    size_t buffer_size;

    /* These members belong to node.c. */
    const epg_target_t *target;
    bool (*send)(size_t publication, const void *message, size_t size);
    char name[EPG_NODE_NAME_SIZE];
    char name_space[EPG_NODE_SPACE_SIZE]; /**< "" or "/robot1" */
    bool valid;                           /**< `values` are those of a cycle */
    uint64_t time_ns;                     /**< tick of that cycle, in board time */
    epg_clock_t clock;                    /**< for the stamps; the middleware sets it (epg/wall_clock.h) */
    bool waits;                           /**< topics with a stamp wait until the clock is set */
    uint32_t unsent;                      /**< publications never sent: newer ones came first, or there was no room */
    uint32_t lost_seen;                   /**< number of lost cycles of the history that `unsent` contains */
    uint32_t malformed;                   /**< received messages that did not fit their type */
    const char *client_advice;            /**< how a client whose requests have no reply would get one; may be NULL */
    epg_node_warning_t warnings[EPG_NODE_WARNINGS];
    bool services_clean;   /**< requests that are read in this poll may enable (epg_gate_poll()) */
    bool topics_clean;     /**< the same for messages */
    uint64_t connected_ns; /**< time of the connection, or of the end of a silence in which messages have waited */
    epg_node_edge_t edge;

    /** A text that no other program on any computer has: the platform sets it before the start; NULL on boards. */
    const char *program;
} epg_node_t;

/**
 * Clears all state and makes the node's names.  `send` must pass the message `data` of publication `publication` to the
 * middleware and return at once.  It returns false if there is no room now; it is then called again later, with newer
 * values if there are any.
 */
void epg_node_start(epg_node_t *node, const epg_target_t *target,
                    bool (*send)(size_t publication, const void *data, size_t size));

/**
 * Sends the publications that are due at `now_ns` (board time).  Only while the middleware is connected.  Returns true
 * if there were any.
 *
 * The diagnostics wait for a call in which no values are due, for at most 5 ms, so that no call takes long.  Messages
 * with a stamp wait until the clock is set, for at most 1 s after the connection.  They are not made up for.
 */
bool epg_node_poll(epg_node_t *node, uint64_t now_ns);

/** Must be called when the connection is up (again).  Drops publications that were due before; schedules begin now. */
void epg_node_connected(epg_node_t *node, uint64_t now_ns);

/** Must be called when messages that follow may have waited for long: an older `false` then allows no `true` to enable. */
void epg_node_delayed(epg_node_t *node, uint64_t now_ns);

/** Must be called at the beginning of each poll, before messages and requests are read. */
void epg_node_listen(epg_node_t *node);

/**
 * Must be called when a message for subscription `subscription` has arrived.  `publisher` is a number for its sender; 0
 * if the middleware does not name it.
 */
void epg_node_receive(epg_node_t *node, size_t subscription, const void *data, size_t size, uint32_t publisher,
                      uint64_t now_ns);

/**
 * Writes the full ROS name of `topic` with its leading slash, such as "/robot1/pan_subscriber".  (DDS puts "rt" before
 * it.)  The name "~" is that of the node itself, such as "/robot1/JIWY_node".  Returns its length, 0 if it does not fit into `size` bytes.
 */
size_t epg_node_topic(const epg_node_t *node, const epg_topic_t *topic, char *name, size_t size);

/** The same for a name that is not in a topic, such as that of a service. */
size_t epg_node_name(const epg_node_t *node, const char *relative, bool service, char *name, size_t size);

/**
 * Returns a number by which an agent distinguishes this node from others.  It is never 0, different for two boards and
 * for two nodes on one computer, and the same after a restart.  It is the hash FNV-1a (Fowler, Noll, Vo), 32 bits, of
 * the program, the serial number, the namespace and the name.
 */
uint32_t epg_node_key(const epg_node_t *node);

#endif
