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
    size_t subscription_count;
    const epg_topic_t *subscriptions;
    size_t publication_count;
    const epg_topic_t *publications;
} epg_target_t;

#endif
