/**
 * @file
 * A generated target as ports and communication see it: its control object and its topics.
 */
#ifndef EPG_TARGET_H
#define EPG_TARGET_H

#include <stddef.h>
#include <stdint.h>

#include "epg/control.h"

typedef enum epg_qos { EPG_QOS_RELIABLE, EPG_QOS_BEST_EFFORT } epg_qos_t;

/** One topic of type `std_msgs/msg/Float64`. */
typedef struct epg_topic {
    const char *name; /**< as written: relative to the namespace, or absolute with a leading slash */
    epg_qos_t qos;
    size_t index; /**< of the setpoint (subscription) or monitoring value (publication) */
} epg_topic_t;

/** A port of the model: its value can be watched and recorded. */
typedef struct epg_signal {
    const char *name;    /**< "inputs.position_pan" */
    const char *unit;    /**< "" when the model states none */
    const double *value; /**< belongs to the control side */
    size_t index;        /**< of the monitoring value that it is copied to */
} epg_signal_t;

typedef struct epg_target {
    epg_control_t *control;
    const epg_application_t *application;
    const char *node;
    const char *name_space;           /**< "" or "/robot1" */
    uint64_t communication_period_ns; /**< between two publications */
    const char *enable_topic;         /**< of type `std_msgs/msg/Bool`; NULL: none */
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
    size_t signal_count;                     /**< 0: signals are not monitored */
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
