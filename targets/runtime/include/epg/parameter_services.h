/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The parameters of a model as those of a ROS 2 node: the services of rcl_interfaces, and /parameter_events.
 *
 * All parameters are doubles.  They can be set, but not declared or undeclared.  The texts and the rules are those of
 * rclcpp: an integer is not accepted for a double, and a request to read that names an unknown parameter has an empty
 * reply.  Of one request to set parameters, all values that are accepted take effect in the same control cycle, and the
 * reply is sent after that cycle.
 *
 * Requests are read in place, and each reply is computed again for each piece of it.  So a request needs no memory
 * beside its buffer, whose size bounds the work.
 */
#ifndef EPG_PARAMETER_SERVICES_H
#define EPG_PARAMETER_SERVICES_H

#include "epg/parameters.h"
#include "epg/service.h"

/** The texts of a parameter in ROS 2. */
typedef struct epg_parameter_text {
    const char *name;        /**< "PID1.kp" for "PID1\kp" */
    const char *description; /**< with the unit; "" for none */
} epg_parameter_text_t;

/** The `layout` of a publication with the message epg_message_parameter_event. */
typedef struct epg_parameter_event {
    const epg_node_t *node;
    const epg_node_publication_t *publication; /**< the state of this publication */
} epg_parameter_event_t;

extern const epg_service_kind_t epg_service_list_parameters;
extern const epg_service_kind_t epg_service_get_parameters;
extern const epg_service_kind_t epg_service_get_parameter_types;
extern const epg_service_kind_t epg_service_describe_parameters;
extern const epg_service_kind_t epg_service_set_parameters;
extern const epg_service_kind_t epg_service_set_parameters_atomically;

/** std_srvs/srv/Trigger: stores the names and the changed parameters (epg/store.h).  The actuators must be off. */
extern const epg_service_kind_t epg_service_store_parameters;

/**
 * rcl_interfaces/msg/ParameterEvent: the parameters that any program has changed.  If they do not fit
 * into one message, others follow.
 */
extern const epg_message_t epg_message_parameter_event;

#endif
