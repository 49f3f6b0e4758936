/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The rcl objects of a target: a context, a node, and a publisher or subscription for each topic.
 */
#include "micro_ros_entities.h"

#include <rcl/error_handling.h>
#include <rmw_microros/rmw_microros.h>

#include "micro_ros_system.h"

#ifdef EPG_MICRO_ROS_TIMEOUTS

/* Longest time in milliseconds for the creation of one entity.  The default of libmicroros is 1000. */
enum { CREATION_MS = 500 };

/* Timeout of a reliable publication.  A negative time means no wait.  With 0, the client library waits until the end of
   the millisecond. */
enum { PUBLISH_MS = -1 };

static void set_context_timeouts(rmw_context_t *context)
{
    (void)rmw_uros_set_context_entity_creation_session_timeout(context, CREATION_MS);
    (void)rmw_uros_set_context_entity_destroy_session_timeout(context, 0);
}

static bool set_publisher_timeout(const rcl_publisher_t *publisher)
{
    return rmw_uros_set_publisher_session_timeout(rcl_publisher_get_rmw_handle(publisher), PUBLISH_MS) == RMW_RET_OK;
}

#else

/* In ROS 2 Galactic, the timeouts are fixed when libmicroros is built. */
static void set_context_timeouts(const rmw_context_t *context)
{
    (void)context;
}

static bool set_publisher_timeout(const rcl_publisher_t *publisher)
{
    (void)publisher;
    return true;
}

#endif

/** Ignores the result of a destruction.  An error only means that the agent has not confirmed, which is not awaited. */
static void ignore(rcl_ret_t result)
{
    if (result != RCL_RET_OK) {
        rcl_reset_error();
    }
}

static bool start_context(epg_micro_ros_entities_t *entities, uint32_t client_key)
{
    rcl_init_options_t options = rcl_get_zero_initialized_init_options();
    if (rcl_init_options_init(&options, epg_micro_ros_memory()) != RCL_RET_OK) {
        return false;
    }
    entities->context = rcl_get_zero_initialized_context();
    rmw_init_options_t *rmw_options = rcl_init_options_get_rmw_init_options(&options);
    const bool started = rcl_init_options_set_domain_id(&options, entities->node->target->domain) == RCL_RET_OK &&
                         rmw_uros_options_set_client_key(client_key, rmw_options) == RMW_RET_OK &&
                         rcl_init(0, NULL, &options, &entities->context) == RCL_RET_OK;
    ignore(rcl_init_options_fini(&options));
    return started;
}

bool epg_micro_ros_entities_connect(epg_micro_ros_entities_t *entities, uint32_t client_key)
{
    const epg_node_t *node = entities->node;
    entities->session = true; /* set before the context exists: a stop meanwhile must free a half-made context, too */
    if (start_context(entities, client_key)) {
        rmw_context_t *context = rcl_context_get_rmw_context(&entities->context);
        rcl_node_options_t options = rcl_node_get_default_options();
        options.enable_rosout = false;
        options.allocator = epg_micro_ros_memory();
        entities->rcl_node = rcl_get_zero_initialized_node();
        set_context_timeouts(context);
        entities->named = rcl_node_init(&entities->rcl_node, node->name, node->name_space, &entities->context,
                                        &options) == RCL_RET_OK;
    }
    rcl_reset_error();
    return entities->named;
}

static rmw_qos_profile_t qos_of(const epg_topic_t *topic)
{
    rmw_qos_profile_t qos = rmw_qos_profile_default;
    qos.depth = topic->depth;
    qos.durability =
        topic->transient_local ? RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL : RMW_QOS_POLICY_DURABILITY_VOLATILE;
    qos.reliability =
        topic->qos == EPG_QOS_RELIABLE ? RMW_QOS_POLICY_RELIABILITY_RELIABLE : RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT;
    return qos;
}

static bool make_publisher(epg_micro_ros_entities_t *entities, size_t index)
{
    const epg_topic_t *topic = &entities->node->target->publications[index];
    epg_micro_ros_type_t *type = &entities->options->types[index];
    rcl_publisher_t *publisher = &entities->options->publishers[index];
    rcl_publisher_options_t options = rcl_publisher_get_default_options();
    char name[EPG_NODE_TOPIC_SIZE];
    options.qos = qos_of(topic);
    options.allocator = epg_micro_ros_memory();
    *publisher = rcl_get_zero_initialized_publisher();
    return epg_node_topic(entities->node, topic, name, sizeof name) > 0 &&
           epg_micro_ros_type_make(type, topic->message) &&
           rcl_publisher_init(publisher, &entities->rcl_node, &type->support, name, &options) == RCL_RET_OK &&
           set_publisher_timeout(publisher);
}

static bool make_subscription(epg_micro_ros_entities_t *entities, size_t index)
{
    const epg_topic_t *topic = &entities->node->target->subscriptions[index];
    epg_micro_ros_type_t *type = &entities->options->types[entities->node->target->publication_count + index];
    rcl_subscription_t *subscription = &entities->options->subscriptions[index];
    rcl_subscription_options_t options = rcl_subscription_get_default_options();
    char name[EPG_NODE_TOPIC_SIZE];
    options.qos = qos_of(topic);
    options.allocator = epg_micro_ros_memory();
    *subscription = rcl_get_zero_initialized_subscription();
    return epg_node_topic(entities->node, topic, name, sizeof name) > 0 &&
           epg_micro_ros_type_make(type, topic->message) &&
           rcl_subscription_init(subscription, &entities->rcl_node, &type->support, name, &options) == RCL_RET_OK;
}

bool epg_micro_ros_entities_make(epg_micro_ros_entities_t *entities, bool *complete)
{
    const epg_target_t *target = entities->node->target;
    bool made = true;
    if (entities->publishers < target->publication_count) {
        made = make_publisher(entities, entities->publishers);
        entities->publishers += made ? 1U : 0U;
    } else if (entities->subscriptions < target->subscription_count) {
        made = make_subscription(entities, entities->subscriptions);
        entities->subscriptions += made ? 1U : 0U;
    }
    *complete = made && entities->publishers == target->publication_count &&
                entities->subscriptions == target->subscription_count;
    rcl_reset_error();
    return made;
}

void epg_micro_ros_entities_drop(epg_micro_ros_entities_t *entities)
{
    while (entities->subscriptions > 0) {
        entities->subscriptions--;
        ignore(rcl_subscription_fini(&entities->options->subscriptions[entities->subscriptions], &entities->rcl_node));
    }
    while (entities->publishers > 0) {
        entities->publishers--;
        ignore(rcl_publisher_fini(&entities->options->publishers[entities->publishers], &entities->rcl_node));
    }
    if (entities->named) {
        ignore(rcl_node_fini(&entities->rcl_node));
    }
    if (entities->session) {
        ignore(rcl_shutdown(&entities->context));
        ignore(rcl_context_fini(&entities->context));
    }
    entities->named = false;
    entities->session = false;
    epg_micro_ros_memory_free();
}
