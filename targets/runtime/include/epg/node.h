/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What all ROS 2 middlewares have in common: names, what is due to be published, messages to values and back.
 *
 * A middleware carries bytes: it makes one reader for each `target->subscriptions` and one writer for each
 * `target->publications`, under the names that epg_node_topic() gives, hands what arrives to epg_node_receive(), and
 * calls epg_node_poll(), which hands out what is due.  All values of one call of epg_node_poll() belong to one
 * control cycle.  A middleware whose `uses` has `node` finds an object in `target->node_state`.
 *
 * All of it belongs to the communication side.
 */
#ifndef EPG_NODE_H
#define EPG_NODE_H

#include "epg/target.h"

/** Bytes of the longest names, with the terminating zero. */
#define EPG_NODE_NAME_SIZE 64
#define EPG_NODE_SPACE_SIZE 64
#define EPG_NODE_TOPIC_SIZE 192

/** What is kept of one publication. */
typedef struct epg_node_publication {
    uint64_t due_ns; /**< board time, or time of the cycle for EPG_TOPIC_CYCLES */
    bool waiting;    /**< it was due, and the middleware had no room yet */
    bool sent;       /**< at least once: `sent_values` mean something */
} epg_node_publication_t;

typedef struct epg_node {
    /* The generator's. */
    double *values;                       /**< `monitor_count` */
    double *sent_values;                  /**< `monitor_count`: as sent last, for EPG_TOPIC_CHANGE; NULL: none is */
    double *received;                     /**< of the subscription with most values; NULL: there is none */
    epg_node_publication_t *publications; /**< one per publication */
    unsigned char *buffer;                /**< `buffer_size` bytes: of the largest publication */
    size_t buffer_size;

    /* The node's. */
    const epg_target_t *target;
    bool (*send)(size_t publication, const void *message, size_t size);
    char name[EPG_NODE_NAME_SIZE];
    char name_space[EPG_NODE_SPACE_SIZE]; /**< "" or "/robot1" */
    bool valid;                           /**< `values` are of a cycle */
    uint64_t time_ns;                     /**< of that cycle's tick */
    int64_t epoch_ns;                     /**< what is added to board time; 0: the clock is not set */
    uint32_t unsent;                      /**< publications that were due and never sent, because newer ones came */
    uint32_t malformed;                   /**< messages received that were none of their type */
} epg_node_t;

/**
 * Clears all state and makes the node's names.  `send` hands message `data` of publication `publication` to the
 * middleware and returns at once; false: there is no room now, and it is asked again, with newer values if there are.
 */
void epg_node_start(epg_node_t *node, const epg_target_t *target,
                    bool (*send)(size_t publication, const void *data, size_t size));

/** Sends what is due at `now_ns` (epg_port_time_ns()).  Only while the middleware is connected. */
void epg_node_poll(epg_node_t *node, uint64_t now_ns);

/** The middleware is connected (again): what was due meanwhile is forgotten, and schedules begin now. */
void epg_node_connected(epg_node_t *node, uint64_t now_ns);

/** A message for subscription `subscription` has arrived. */
void epg_node_receive(epg_node_t *node, size_t subscription, const void *data, size_t size, uint64_t now_ns);

/** The clock: `epoch_ns` nanoseconds since 1970 at board time `now_ns`. */
void epg_node_set_time(epg_node_t *node, uint64_t epoch_ns, uint64_t now_ns);

/**
 * The full ROS name of `topic` with its leading slash, such as "/robot1/pan_subscriber"; DDS puts "rt" before it.
 * Returns its length, 0 if it does not fit.
 */
size_t epg_node_topic(const epg_node_t *node, const epg_topic_t *topic, char *name, size_t size);

/**
 * A number by which an agent tells this node from others: never 0, and not the same for two boards, nor for two nodes on
 * one computer.  FNV-1a (Fowler, Noll, Vo), 32 bits, over serial number, namespace and name.
 */
uint32_t epg_node_key(const epg_node_t *node);

#endif
