/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A generated target as ports and communication see it: its control object and its topics.
 */
#ifndef EPG_TARGET_H
#define EPG_TARGET_H

#include <stddef.h>
#include <stdint.h>

#include "epg/control.h"
#include "epg/message.h"

typedef enum epg_qos { EPG_QOS_RELIABLE, EPG_QOS_BEST_EFFORT } epg_qos_t;

/** What a topic is for. */
typedef enum epg_topic_role {
    EPG_TOPIC_VALUES,      /**< setpoints or monitoring values */
    EPG_TOPIC_ENABLE,      /**< subscription: a Bool that enables or disables the target */
    EPG_TOPIC_DIAGNOSTICS, /**< publication: state and statistics, at `period_ns` */
    EPG_TOPIC_ECHO         /**< subscription: each message goes on as publication `index`, of the same type, at once;
                                publication: what such a subscription sends */
} epg_topic_role_t;

/** When a publication is sent. */
typedef enum epg_topic_trigger {
    EPG_TOPIC_PERIOD, /**< at every `period_ns` */
    EPG_TOPIC_CYCLES, /**< at every `cycles`-th control cycle; those that come too fast are left out */
    EPG_TOPIC_CHANGE  /**< when a value has changed, as seen by the communication side; once per millisecond at most */
} epg_topic_trigger_t;

/** A subscription or a publication. */
typedef struct epg_topic {
    const char *name; /**< as written: relative to the namespace, absolute with a leading '/', private with "~/" */
    const epg_message_t *message;
    const void *layout; /**< what the message's functions want to know besides, such as names of joints; or NULL */
    size_t size;        /**< largest message in bytes */
    epg_qos_t qos;
    uint16_t depth; /**< messages that a history keeps at most ("keep last"); at least 1 */
    epg_topic_role_t role;
    size_t index; /**< of the first setpoint (subscription) or monitoring value (publication) */
    size_t count; /**< of values in a message; 0: it carries none (diagnostics, echo) */
    const char *const
        *values; /**< `count` names by which people know them; NULL: the one value is called as the topic */
    epg_topic_trigger_t trigger;
    uint32_t cycles;
    uint64_t period_ns;
} epg_topic_t;

/** What people call value `value` of `topic`: "pan_subscriber", or "joint_states/pan.position". */
static inline const char *epg_topic_value_name(const epg_topic_t *topic, size_t value)
{
    return topic->values == NULL ? topic->name : topic->values[value];
}

/** A port of the model: its value can be watched and recorded. */
typedef struct epg_signal {
    const char *name;    /**< "inputs.position_pan" */
    const char *unit;    /**< "" when the model states none */
    const double *value; /**< belongs to the control side */
    size_t index;        /**< of the monitoring value that it is copied to */
} epg_signal_t;

/** No domain is configured. */
#define EPG_DOMAIN_DEFAULT 255

typedef struct epg_target {
    epg_control_t *control;
    const epg_application_t *application;
    const char *node;                 /**< "$serial" in it stands for the board's serial number: epg/names.h */
    const char *name_space;           /**< "" or "/robot1"; the same */
    uint8_t domain;                   /**< ROS_DOMAIN_ID; EPG_DOMAIN_DEFAULT: the agent's, or the environment's */
    uint64_t communication_period_ns; /**< between two publications */
    size_t component_count;
    const char *const *components; /**< names of all components; a fault's component is an index into it */
    /** Called before publication `index` is handed to the transport: epg_target_publishing().  NULL: nobody wants it. */
    void (*publishing)(size_t index);
    size_t subscription_count;
    const epg_topic_t *subscriptions;
    size_t publication_count;
    const epg_topic_t *publications;

    const char *version;                     /**< of the EPG that generated it */
    const char *hash;                        /**< of everything it was generated from: 16 hexadecimal digits */
    const struct epg_middleware *middleware; /**< as configured; NULL: none runs */
    const void *options;                     /**< of that middleware, whose header says what */
    const struct epg_middleware *console;    /**< runs beside it on a stream of its own; NULL: none */
    const void *console_options;
    struct epg_store *store;     /**< what is kept over a restart: epg/store.h; NULL: nothing is */
    struct epg_node *node_state; /**< memory of a middleware that uses epg/node.h; NULL */
    size_t signal_count;         /**< 0: signals are not monitored */
    const epg_signal_t *signals;
    size_t time_index; /**< of the monitoring value that is the cycle's time, in the bits of a 64-bit whole number */
} epg_target_t;

/** Name of component `index` of a status; "" for EPG_NO_COMPONENT. */
static inline const char *epg_target_component(const epg_target_t *target, uint16_t index)
{
    return index < target->component_count ? target->components[index] : "";
}

/** A middleware is about to send publication `index`.  Communication side. */
static inline void epg_target_publishing(const epg_target_t *target, size_t index)
{
    if (target->publishing != NULL) {
        target->publishing(index);
    }
}

#endif
