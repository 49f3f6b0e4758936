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
