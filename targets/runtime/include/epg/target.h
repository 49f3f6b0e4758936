/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A generated target: its control object, its topics and its names, as ports and middlewares use them.
 *
 * The generator writes one constant `epg_target_t` per target.
 */
#ifndef EPG_TARGET_H
#define EPG_TARGET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/control.h"
#include "epg/message.h"

/** Quality of service: messages that are lost are sent again (reliable), or not (best effort). */
typedef enum epg_qos { EPG_QOS_RELIABLE, EPG_QOS_BEST_EFFORT } epg_qos_t;

/** The purpose of a topic. */
typedef enum epg_topic_role {
    EPG_TOPIC_VALUES,      /**< setpoints or monitoring values */
    EPG_TOPIC_ENABLE,      /**< subscription: a Bool that enables or disables the target */
    EPG_TOPIC_DIAGNOSTICS, /**< publication: status and statistics, at `period_ns` */
    EPG_TOPIC_PARAMETERS,  /**< publication: changed parameters, looked for at `period_ns` */
    EPG_TOPIC_CLOCK,       /**< publication: simulated time, at `period_ns` */
    EPG_TOPIC_ECHO         /**< subscription: each message is sent at once as publication `index`, of the same type;
                                publication: the messages that such a subscription sends */
} epg_topic_role_t;

/** The event that makes a publication due. */
typedef enum epg_topic_trigger {
    EPG_TOPIC_PERIOD, /**< a period of `period_ns` is over */
    EPG_TOPIC_CYCLES, /**< every `cycles`-th control cycle; cycles that follow too fast are left out */
    EPG_TOPIC_CHANGE  /**< a value has changed, as seen by the communication side; at most once per millisecond */
} epg_topic_trigger_t;

/** A subscription or a publication. */
typedef struct epg_topic {
    const char *name; /**< relative to the namespace, absolute with a leading '/', or private with a leading "~/" */
    const epg_message_t *message;
    const void *layout; /**< data for the functions of `message`, such as the names of joints; may be NULL */
    size_t size;        /**< size of the largest message in bytes */
    epg_qos_t qos;
    uint16_t depth;       /**< number of messages that the history keeps at most ("keep last"); at least 1 */
    bool transient_local; /**< the history is kept for subscribers that come later */
    uint64_t deadline_ns; /**< longest time between two messages; 0: none */
    uint64_t lifespan_ns; /**< age from which a message is no longer delivered; 0: none */
    epg_topic_role_t role;
    size_t index; /**< index of the first setpoint (subscription) or monitoring value (publication) */
    size_t count; /**< number of values in a message; 0: none (diagnostics, echo) */
    const char *const
        *values; /**< `count` names of the values for the user; NULL: the only value has the name of the topic */
    epg_topic_trigger_t trigger;
    uint32_t cycles;
    uint64_t period_ns;
} epg_topic_t;

/** Returns the name of value `value` of `topic` for the user: "pan_subscriber", or "joint_states/pan.position". */
static inline const char *epg_topic_value_name(const epg_topic_t *topic, size_t value)
{
    return topic->values == NULL ? topic->name : topic->values[value];
}

/** A signal: a port of the model whose value can be watched and recorded. */
typedef struct epg_signal {
    const char *name;    /**< such as "inputs.position_pan" */
    const char *unit;    /**< "" if the model has none */
    const double *value; /**< the value belongs to the control side */
    size_t index;        /**< index of the monitoring value to which it is copied */
} epg_signal_t;

/** The value of `domain` if none is configured. */
#define EPG_DOMAIN_DEFAULT 255

typedef struct epg_target {
    epg_control_t *control;
    const epg_application_t *application;
    const char *node;        /**< name of the node; can contain "$serial", the serial number (epg/names.h) */
    const char *name_space;  /**< "" or "/robot1"; can contain "$serial", too */
    const char *given_node;  /**< name of the node that replaces a stored one, too; NULL: none was given */
    const char *given_space; /**< the same for the namespace */
    /**
     * Returns the name that replaces the full name `name` of a topic or a service, or `name` itself.  NULL: no name is
     * replaced.  Only for computers: a launch file gives the names.
     */
    const char *(*rename)(const char *name, bool service);
    bool simulated_time; /**< the time is simulated: stamps have this time, and the clock of the network is not used */
    uint8_t domain;      /**< ROS_DOMAIN_ID; EPG_DOMAIN_DEFAULT: that of the agent or the environment */
    uint64_t communication_period_ns; /**< time between two publications */
    size_t component_count;
    const char *const *components; /**< names of all components; the component of a fault is an index into them */
    size_t fault_count;
    const epg_kind_fault_t *faults; /**< the faults that the kinds of these components declare */
    /** Called before publication `index` is passed to the transport, by epg_target_publishing().  May be NULL. */
    void (*publishing)(size_t index);
    size_t subscription_count;
    const epg_topic_t *subscriptions;
    size_t publication_count;
    const epg_topic_t *publications;

    const char *version; /**< version of the EPG that generated this target */
    const char *hash;    /**< hash of everything it was generated from: 16 hexadecimal digits */
    const char *model;   /**< hash of the model and of the generated values of its parameters: as long */
    const struct epg_middleware *middleware; /**< NULL: none is configured */
    const void *options;                     /**< options of the middleware; its header declares their type */
    const struct epg_middleware *console;    /**< console beside the middleware, on another stream; NULL: none */
    const void *console_options;
    struct epg_store *store;     /**< data that are kept over a restart (epg/store.h); NULL: none */
    struct epg_node *node_state; /**< memory of a middleware that uses epg/node.h; NULL for others */
    size_t service_count;        /**< services of the node (epg/service.h); 0 for a middleware that serves none */
    const struct epg_service *services;
    struct epg_service_state *service_state; /**< NULL: there are no services */
    size_t signal_count;                     /**< 0: signals are not monitored */
    const epg_signal_t *signals;
    size_t time_index; /**< index of the monitoring value that is the tick of the cycle, as the bits of a uint64_t */
} epg_target_t;

/** Returns the name of component `index` of a status; "" for EPG_NO_COMPONENT. */
static inline const char *epg_target_component(const epg_target_t *target, uint16_t index)
{
    return index < target->component_count ? target->components[index] : "";
}

/**
 * Returns the name of a fault of this target for messages: "none", "not finite", "stall", ...; "unknown" for a number
 * that is not a fault of the target.
 */
const char *epg_target_fault(const epg_target_t *target, epg_fault_t fault);

/** Returns the word for the origin of a stop in messages: "line", "topic", ... */
const char *epg_stop_source_name(epg_stop_source_t source);

/** Returns the name of setpoint `index` for the user; "" for an index that is not one. */
const char *epg_target_setpoint(const epg_target_t *target, size_t index);

/**
 * Returns the name of a setpoint that explains a stall: its newest received value is at a limit, so that the axis can be
 * pressed against an end stop.  Returns "" if there is none, and for every other fault.  Communication side.
 */
const char *epg_target_stalling_setpoint(const epg_target_t *target, const epg_status_t *status);

/** Must be called by a middleware before it sends publication `index`.  Communication side. */
static inline void epg_target_publishing(const epg_target_t *target, size_t index)
{
    if (target->publishing != NULL) {
        target->publishing(index);
    }
}

#endif
