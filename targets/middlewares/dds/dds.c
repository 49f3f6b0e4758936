/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The DDS participant, with one reader for each subscription, one writer for each publication, and both for each
 * service.
 *
 * CycloneDDS has its own threads, which receive messages and send lost ones again.  The code in this file runs on the
 * communication side and does not wait for these threads.
 */
#include "dds.h"

#include <stdio.h>
#include <stdlib.h>

#include "domain.h"
#include "epg/host_log.h"
#include "epg/node.h"
#include "epg/port.h"
#include "graph.h"
#include "matching.h"
#include "message.h"
#include "repliers.h"

enum {
    BATCH = 16,         /* messages taken from a reader in one poll; the others wait for the next poll */
    PREFIX = 2,         /* length of "rt" before the names of topics */
    CLOCK_PAUSE = 10,   /* s between two readings of the computer's clock */
    SECOND = 1000000000 /* ns */
};

typedef struct endpoint {
    dds_entity_t entity; /* reader or writer */
    struct ddsi_sertype *type;
    char topic[PREFIX + EPG_NODE_TOPIC_SIZE]; /* "rt/pan_publisher" */
} endpoint_t;

static struct {
    const epg_target_t *target;
    epg_node_t *node;
    uint32_t domain_id;
    char configuration[EPG_DDS_CONFIGURATION_SIZE];
    bool failed_before; /* the reason of a failed connection has been reported */
    uint64_t due_ns;    /* next attempt to connect, or next check of QoS */
    uint64_t clock_ns;  /* next reading of the computer's clock: the correction of the last one must be over */
    dds_entity_t domain;
    dds_entity_t participant; /* 0: not connected */
    dds_entity_t waitset;
    endpoint_t *readers; /* one per subscription */
    endpoint_t *writers; /* one per publication */
} dds;

static bool send_message(size_t publication, const void *data, size_t size)
{
    const endpoint_t *writer = &dds.writers[publication];
    return epg_dds_write(writer->entity, writer->type, data, size) == DDS_RETCODE_OK;
}

/* Creation of the entities ------------------------------------------------------------------------------------- */

/** Even a reliable writer never waits: a full history drops its oldest message, and a write that would block fails. */
static dds_qos_t *qos_of(const epg_topic_t *topic)
{
    dds_qos_t *qos = dds_create_qos();
    const bool reliable = topic->qos == EPG_QOS_RELIABLE;
    dds_qset_reliability(qos, reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, 0);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, topic->depth);
    dds_qset_durability(qos, topic->transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_durability_service(qos, 0, DDS_HISTORY_KEEP_LAST, topic->depth, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED);
    if (topic->deadline_ns > 0) {
        dds_qset_deadline(qos, (dds_duration_t)topic->deadline_ns);
    }
    if (topic->lifespan_ns > 0) {
        dds_qset_lifespan(qos, (dds_duration_t)topic->lifespan_ns);
    }
    dds_qset_writer_data_lifecycle(qos, false);
    epg_dds_set_user_data(qos, topic->message->hash, "");
    return qos;
}

/** Creates the reader or writer of `topic`.  Returns it, or a negative return code. */
static dds_return_t create_endpoint(endpoint_t *endpoint, const epg_topic_t *topic, bool writes)
{
    endpoint->topic[0] = 'r';
    endpoint->topic[1] = 't';
    if (epg_node_topic(dds.node, topic, endpoint->topic + PREFIX, sizeof endpoint->topic - PREFIX) == 0) {
        return DDS_RETCODE_BAD_PARAMETER;
    }
    const dds_entity_t entity = epg_dds_topic(dds.participant, endpoint->topic, topic->message->type, &endpoint->type);
    if (entity < 0) {
        return entity;
    }
    dds_qos_t *qos = qos_of(topic);
    endpoint->entity = writes ? dds_create_writer(dds.participant, entity, qos, NULL)
                              : dds_create_reader(dds.participant, entity, qos, NULL);
    dds_delete_qos(qos);
    return endpoint->entity;
}

/** Creates the readers or writers of all `topics`.  If one fails, prints the name of its topic. */
static dds_return_t create_endpoints(endpoint_t *endpoints, const epg_topic_t *topics, size_t count, bool writes)
{
    for (size_t i = 0; i < count; i++) {
        const dds_return_t code = create_endpoint(&endpoints[i], &topics[i], writes);
        if (code < 0) {
            if (!dds.failed_before && epg_host_logs(EPG_HOST_LOG_ERROR)) {
                fprintf(stderr, "error: cannot make topic %s\n", endpoints[i].topic);
            }
            return code;
        }
    }
    return DDS_RETCODE_OK;
}

/** Creates the participant as rmw_cyclonedds does.  There is no security enclave, so its name is "/". */
static dds_entity_t create_participant(uint32_t domain)
{
    static const char user_data[] = "enclave=/;";
    dds_qos_t *qos = dds_create_qos();
    dds_qset_userdata(qos, user_data, sizeof user_data - 1);
    const dds_entity_t participant = dds_create_participant(domain, qos, NULL);
    dds_delete_qos(qos);
    return participant;
}

static dds_return_t create_waitset(void)
{
    dds_return_t code = dds.waitset = dds_create_waitset(dds.participant);
    for (size_t i = 0; i < dds.target->subscription_count && code >= 0; i++) {
        const dds_entity_t condition = dds_create_readcondition(dds.readers[i].entity, DDS_ANY_STATE);
        code = condition < 0 ? condition : dds_waitset_attach(dds.waitset, condition, 0);
    }
    return code;
}

static dds_return_t publish_graph(void)
{
    const size_t readers = dds.target->subscription_count + dds.target->service_count;
    const size_t writers = dds.target->publication_count + dds.target->service_count;
    dds_entity_t *entities = calloc(readers + writers + 1, sizeof *entities);
    if (entities == NULL) {
        return DDS_RETCODE_OUT_OF_RESOURCES;
    }
    for (size_t i = 0; i < dds.target->subscription_count; i++) {
        entities[i] = dds.readers[i].entity;
    }
    for (size_t i = 0; i < dds.target->publication_count; i++) {
        entities[readers + i] = dds.writers[i].entity;
    }
    epg_dds_list_repliers(entities + dds.target->subscription_count,
                          entities + readers + dds.target->publication_count);
    const dds_return_t code =
        epg_dds_publish_graph(dds.participant, dds.node, entities, readers, entities + readers, writers);
    free(entities);
    return code;
}

/** Creates all other entities of `dds.participant`, which must exist. */
static dds_return_t create_all(void)
{
    dds_return_t code = create_endpoints(dds.readers, dds.target->subscriptions, dds.target->subscription_count, false);
    if (code >= 0) {
        code = create_endpoints(dds.writers, dds.target->publications, dds.target->publication_count, true);
    }
    if (code >= 0) {
        code = epg_dds_create_repliers(dds.participant);
    }
    if (code >= 0) {
        code = create_waitset();
    }
    return code >= 0 ? publish_graph() : code;
}

static void leave(void)
{
    if (dds.participant > 0) {
        (void)dds_delete(dds.participant);
    }
    if (dds.domain > 0) {
        (void)dds_delete(dds.domain);
    }
    dds.participant = 0;
    dds.domain = 0;
    epg_dds_leave_repliers();
}

static dds_return_t join_domain(void)
{
    const dds_entity_t made = dds_create_domain(dds.domain_id, dds.configuration);
    if (made < 0 && made != DDS_RETCODE_PRECONDITION_NOT_MET) { /* not met: the program has made this domain already */
        return made;
    }
    dds.domain = made > 0 ? made : 0;
    const dds_return_t code = dds.participant = create_participant(dds.domain_id);
    return code < 0 ? code : create_all();
}

/** Sets the clock.  Of several readings of both clocks, the one during which the least time passed counts. */
static void set_clock(uint64_t now_ns)
{
    dds.clock_ns = now_ns + CLOCK_PAUSE * (uint64_t)SECOND;
    for (int i = 0; i < EPG_CLOCK_ANSWERS; i++) {
        const uint64_t before_ns = epg_port_time_ns();
        const uint64_t epoch_ns = (uint64_t)dds_time();
        const uint64_t took_ns = epg_port_time_ns() - before_ns;
        epg_clock_answer(&dds.node->clock, epoch_ns, before_ns + took_ns / 2U, took_ns);
    }
}

/** Tries to join the domain.  The network may not be up yet, so the attempt is repeated while the control loop runs. */
static void try_to_join(uint64_t now_ns)
{
    const dds_return_t code = join_domain();
    dds.due_ns = now_ns + SECOND;
    if (code < 0) {
        leave();
        if (!dds.failed_before && epg_host_logs(EPG_HOST_LOG_ERROR)) {
            fprintf(stderr, "error: cannot make a DDS participant: %s\nhint: the node tries again every second\n",
                    dds_strretcode(code));
        }
        dds.failed_before = true;
        return;
    }
    if (dds.failed_before && epg_host_logs(EPG_HOST_LOG_INFO)) {
        fputs("the DDS participant is ready\n", stderr);
    }
    dds.failed_before = false;
    set_clock(now_ns);
    epg_node_connected(dds.node, now_ns);
}

/* The middleware ----------------------------------------------------------------------------------------------- */

static void start(const epg_target_t *target, const epg_stream_t *stream)
{
    (void)stream; /* CycloneDDS opens its own sockets */
    dds.target = target;
    dds.node = target->node_state;
    dds.failed_before = false;
    dds.participant = 0;
    dds.domain = 0;
    epg_node_start(dds.node, target, send_message);
    dds.readers = calloc(target->subscription_count + 1, sizeof *dds.readers);
    dds.writers = calloc(target->publication_count + 1, sizeof *dds.writers);
    if (dds.readers == NULL || dds.writers == NULL || epg_dds_start_repliers(dds.node) < 0) {
        fputs("error: cannot make a DDS participant: not enough memory\n", stderr);
        dds.due_ns = UINT64_MAX;
        return;
    }
    if (!epg_dds_domain(target->domain, &dds.domain_id) ||
        !epg_dds_configuration(dds.configuration, sizeof dds.configuration)) {
        dds.due_ns = UINT64_MAX; /* a new attempt would fail, too: the environment does not change */
        return;
    }
    try_to_join(epg_port_time_ns());
}

/** Returns a number for a writer, which is not 0. */
static uint32_t number_of(dds_instance_handle_t writer)
{
    return (uint32_t)(writer ^ writer >> 32U) | 1U << 31U;
}

static void receive(size_t subscription, uint64_t now_ns)
{
    struct ddsi_serdata *messages[BATCH] = {NULL};
    dds_sample_info_t infos[BATCH];
    const dds_return_t count = dds_takecdr(dds.readers[subscription].entity, messages, BATCH, infos, DDS_ANY_STATE);
    for (dds_return_t i = 0; i < count; i++) {
        size_t size = 0;
        const void *data = epg_dds_content(messages[i], &size);
        if (infos[i].valid_data && data != NULL) {
            epg_node_receive(dds.node, subscription, data, size, number_of(infos[i].publication_handle), now_ns);
        } else if (infos[i].valid_data) {
            dds.node->malformed++;
        }
        ddsi_serdata_unref(messages[i]);
    }
}

/** Runs once a second: an endpoint with other QoS may have appeared, and the computer's clock may have been set. */
static void look_around(uint64_t now_ns)
{
    dds.due_ns = now_ns + SECOND;
    if (now_ns >= dds.clock_ns) {
        set_clock(now_ns);
    }
    for (size_t i = 0; i < dds.target->subscription_count; i++) {
        epg_dds_check_reader(dds.readers[i].entity, dds.readers[i].topic + PREFIX);
    }
    for (size_t i = 0; i < dds.target->publication_count; i++) {
        epg_dds_check_writer(dds.writers[i].entity, dds.writers[i].topic + PREFIX);
    }
}

static void poll_node(uint64_t now_ns)
{
    if (dds.participant <= 0) {
        if (now_ns >= dds.due_ns) {
            try_to_join(now_ns);
        }
        return;
    }
    epg_node_listen(dds.node);
    for (size_t i = 0; i < dds.target->subscription_count; i++) {
        receive(i, now_ns);
    }
    epg_dds_poll_repliers(now_ns);
    (void)epg_node_poll(dds.node, now_ns);
    if (now_ns >= dds.due_ns) {
        look_around(now_ns);
    }
}

static void wait_for_message(uint64_t until_ns)
{
    const uint64_t now_ns = epg_port_time_ns();
    const dds_duration_t left = until_ns > now_ns ? (dds_duration_t)(until_ns - now_ns) : 0;
    if (dds.participant > 0) {
        (void)dds_waitset_wait(dds.waitset, NULL, 0, left);
    } else {
        dds_sleepfor(left);
    }
}

/** Leaves the domain, so that other nodes see this at once, and not only when the lease of 10 s is over. */
static void stop(void)
{
    leave();
    epg_dds_stop_repliers();
    free(dds.readers);
    free(dds.writers);
    dds.readers = NULL;
    dds.writers = NULL;
}

static const char *state(void)
{
    return dds.participant > 0 ? "running" : "waiting";
}

const epg_middleware_t epg_dds = {
    .start = start, .poll = poll_node, .stop = stop, .wait = wait_for_message, .state = state};
