/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The entities of a target in DDS, which the agent creates on request.
 */
#include "xrce_entities.h"

#include <string.h>

#include "epg/service.h"
#include "xrce_services.h"

enum {
    ONLY = 1, /* id of the participant, the publisher and the subscriber; topics, writers and readers begin at 1 */
    /* Entities with the same id that the agent has kept of an earlier session must be replaced. */
    MODE = UXR_REPLACE
};

/** The steps before those of the topics. */
enum { PARTICIPANT, PUBLISHER, SUBSCRIBER, FIRST_TOPIC };

static size_t topic_count(const epg_node_t *node)
{
    return node->target->publication_count + node->target->subscription_count;
}

/** Returns the step that creates the first replier.  Before it, each topic has two steps. */
static size_t first_replier(const epg_node_t *node)
{
    return FIRST_TOPIC + 2 * topic_count(node);
}

/** Returns the step that requests the samples of the first reader. */
static size_t first_reading(const epg_node_t *node)
{
    return first_replier(node) + node->target->service_count;
}

static const epg_topic_t *topic_at(const epg_node_t *node, size_t index)
{
    const size_t publications = node->target->publication_count;
    return index < publications ? &node->target->publications[index]
                                : &node->target->subscriptions[index - publications];
}

/**
 * Requests the participant.  Its name is "namespace/node", without a leading slash: micro_ros_agent has no other field
 * from which it could take the node's namespace.  It divides the name at the first slash (its function
 * GraphManager::get_name_and_namespace), so of a longer namespace only the first part is the namespace to ROS 2.
 */
static uint16_t create_participant(const epg_xrce_entities_t *entities)
{
    static const epg_topic_t self = {.name = "~"};
    char name[EPG_NODE_TOPIC_SIZE];
    (void)epg_node_topic(entities->node, &self, name, sizeof name);
    return uxr_buffer_create_participant_bin(entities->session, entities->requests,
                                             uxr_object_id(ONLY, UXR_PARTICIPANT_ID), entities->node->target->domain,
                                             name + 1, MODE);
}

static uint16_t create_topic(const epg_xrce_entities_t *entities, size_t index)
{
    char name[2 + EPG_NODE_TOPIC_SIZE] = "rt";
    const epg_topic_t *topic = topic_at(entities->node, index);
    (void)epg_node_topic(entities->node, topic, name + 2, sizeof name - 2);
    return uxr_buffer_create_topic_bin(entities->session, entities->requests,
                                       uxr_object_id((uint16_t)(index + 1), UXR_TOPIC_ID),
                                       uxr_object_id(ONLY, UXR_PARTICIPANT_ID), name, topic->message->type, MODE);
}

static uint16_t create_endpoint(const epg_xrce_entities_t *entities, size_t index)
{
    const size_t publications = entities->node->target->publication_count;
    const epg_topic_t *topic = topic_at(entities->node, index);
    const uxrQoS_t qos = {
        .durability = topic->transient_local ? UXR_DURABILITY_TRANSIENT_LOCAL : UXR_DURABILITY_VOLATILE,
        .reliability = topic->qos == EPG_QOS_RELIABLE ? UXR_RELIABILITY_RELIABLE : UXR_RELIABILITY_BEST_EFFORT,
        .history = UXR_HISTORY_KEEP_LAST,
        .depth = topic->depth,
    };
    const uxrObjectId of = uxr_object_id((uint16_t)(index + 1), UXR_TOPIC_ID);
    if (index < publications) {
        return uxr_buffer_create_datawriter_bin(entities->session, entities->requests, epg_xrce_writer(index),
                                                uxr_object_id(ONLY, UXR_PUBLISHER_ID), of, qos, MODE);
    }
    return uxr_buffer_create_datareader_bin(entities->session, entities->requests,
                                            uxr_object_id((uint16_t)(index - publications + 1), UXR_DATAREADER_ID),
                                            uxr_object_id(ONLY, UXR_SUBSCRIBER_ID), of, qos, MODE);
}

/**
 * Requests the replier of service `index`.  The binary form has no QoS; agents make both topics reliable.  Agents do not
 * use the name of the service.  Without it, the two longest topics fit into the library's 512 bytes.
 */
static uint16_t create_replier(const epg_xrce_entities_t *entities, size_t index)
{
    enum { END = sizeof "Request" };
    char requests[2 + EPG_NODE_TOPIC_SIZE + END] = "";
    char replies[2 + EPG_NODE_TOPIC_SIZE + END] = "";
    const epg_service_kind_t *kind = entities->node->target->services[index].kind;
    (void)epg_service_topic(entities->node, index, false, requests, sizeof requests);
    (void)epg_service_topic(entities->node, index, true, replies, sizeof replies);
    return uxr_buffer_create_replier_bin(
        entities->session, entities->requests, uxr_object_id(epg_xrce_services_id(index), UXR_REPLIER_ID),
        uxr_object_id(ONLY, UXR_PARTICIPANT_ID), "", kind->request.type, kind->reply.type, requests, replies,
        (uxrQoS_t){.reliability = UXR_RELIABILITY_RELIABLE}, MODE);
}

/** Requests the samples of subscription `index`, until the session ends. */
static uint16_t ask_for_samples(const epg_xrce_entities_t *entities, size_t index)
{
    const uxrDeliveryControl control = {.max_samples = UXR_MAX_SAMPLES_UNLIMITED};
    const bool reliable = entities->node->target->subscriptions[index].qos == EPG_QOS_RELIABLE;
    return uxr_buffer_request_data(entities->session, entities->requests,
                                   uxr_object_id((uint16_t)(index + 1), UXR_DATAREADER_ID),
                                   reliable ? entities->reliable : entities->best_effort, &control);
}

/** Requests the requests of service `index`, until the session ends. */
static uint16_t ask_for_requests(const epg_xrce_entities_t *entities, size_t index)
{
    const uxrDeliveryControl control = {.max_samples = UXR_MAX_SAMPLES_UNLIMITED};
    return uxr_buffer_request_data(entities->session, entities->requests,
                                   uxr_object_id(epg_xrce_services_id(index), UXR_REPLIER_ID),
                                   (uxrStreamId){.raw = EPG_XRCE_SERVICE_STREAM}, &control);
}

static uint16_t ask(const epg_xrce_entities_t *entities)
{
    const uxrObjectId participant = uxr_object_id(ONLY, UXR_PARTICIPANT_ID);
    switch (entities->step) {
    case PARTICIPANT:
        return create_participant(entities);
    case PUBLISHER:
        return uxr_buffer_create_publisher_bin(entities->session, entities->requests,
                                               uxr_object_id(ONLY, UXR_PUBLISHER_ID), participant, MODE);
    case SUBSCRIBER:
        return uxr_buffer_create_subscriber_bin(entities->session, entities->requests,
                                                uxr_object_id(ONLY, UXR_SUBSCRIBER_ID), participant, MODE);
    default:
        break;
    }
    if (entities->step >= first_replier(entities->node)) {
        return create_replier(entities, entities->step - first_replier(entities->node));
    }
    const size_t step = entities->step - FIRST_TOPIC;
    return step % 2 == 0 ? create_topic(entities, step / 2) : create_endpoint(entities, step / 2);
}

void epg_xrce_entities_start(epg_xrce_entities_t *entities)
{
    entities->step = PARTICIPANT;
    entities->request = UXR_INVALID_REQUEST_ID;
    entities->status = UXR_STATUS_NONE;
}

void epg_xrce_entities_answer(epg_xrce_entities_t *entities, uint16_t request, uint8_t status)
{
    if (request == entities->request) {
        entities->status = status;
    }
}

bool epg_xrce_entities_exist(const epg_xrce_entities_t *entities)
{
    return entities->step >= first_reading(entities->node);
}

/** Readers and repliers whose samples are requested in one poll, which must take less than a millisecond. */
enum { READINGS_PER_POLL = 4 };

/** Requests the samples of the next readers and repliers.  The agent's answer consists of the samples only. */
static epg_xrce_progress_t ask_for_next_samples(epg_xrce_entities_t *entities)
{
    const size_t subscriptions = entities->node->target->subscription_count;
    const size_t first = first_reading(entities->node);
    const size_t count = subscriptions + entities->node->target->service_count;
    for (int i = 0; i < READINGS_PER_POLL && entities->step - first < count; i++) {
        const size_t index = entities->step - first;
        const uint16_t request = index < subscriptions ? ask_for_samples(entities, index)
                                                       : ask_for_requests(entities, index - subscriptions);
        if (request == UXR_INVALID_REQUEST_ID) {
            return EPG_XRCE_UNDERWAY; /* the stream is full until the agent has acknowledged its frames */
        }
        entities->step++;
    }
    return entities->step - first < count ? EPG_XRCE_UNDERWAY : EPG_XRCE_COMPLETE;
}

epg_xrce_progress_t epg_xrce_entities_poll(epg_xrce_entities_t *entities)
{
    if (entities->request != UXR_INVALID_REQUEST_ID) {
        if (entities->status == UXR_STATUS_NONE) {
            return EPG_XRCE_UNDERWAY;
        }
        if (entities->status != UXR_STATUS_OK && entities->status != UXR_STATUS_OK_MATCHED) {
            return EPG_XRCE_REFUSED;
        }
        entities->request = UXR_INVALID_REQUEST_ID;
        entities->step++;
    }
    if (epg_xrce_entities_exist(entities)) {
        return ask_for_next_samples(entities);
    }
    entities->status = UXR_STATUS_NONE;
    entities->request = ask(entities);
    return EPG_XRCE_UNDERWAY;
}
