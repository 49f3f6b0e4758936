/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The services of the node on DDS.
 */
#include "repliers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "epg/host_log.h"
#include "epg/service.h"
#include "graph.h"
#include "message.h"

enum {
    HEADER = 16,          /* bytes of the header before a request and a reply */
    DEPTH = 10,           /* of ROS 2's default QoS of services */
    MATCH_NS = 100000000, /* longest time that a reply waits for its reader, as in rmw_cyclonedds */
    TOPIC = 16,           /* bytes of "rq" and "Request" */
    ID = 64,              /* bytes of an identification in the user data of an endpoint */
    NAME = EPG_NODE_TOPIC_SIZE + TOPIC,
    STRANGERS = 8 /* programs with another RMW that are remembered */
};

typedef struct replier {
    dds_entity_t reader;
    dds_entity_t writer;
    struct ddsi_sertype *type; /* of the replies */
    int before_stop;           /* requests that wait, up to the newest one to disable */
    int stale;                 /* requests that wait since before a stop of something else */
} replier_t;

static struct {
    epg_node_t *node;
    size_t count;
    replier_t *repliers;
    size_t next; /* replier whose requests are looked for first, so that none waits without end */

    size_t asked; /* replier of the request in work */
    unsigned char header[HEADER];
    char client[ID]; /* identification of the client, as both its endpoints have it */
    bool ready;
    uint64_t ready_ns;

    dds_guid_t strangers[STRANGERS]; /* participants of another RMW that were reported, the newest first */
} services;

/* Creation ----------------------------------------------------------------------------------------------------- */

dds_return_t epg_dds_start_repliers(epg_node_t *node)
{
    services.node = node;
    services.count = node->target->service_count;
    services.next = 0;
    memset(services.strangers, 0, sizeof services.strangers);
    services.repliers = calloc(services.count + 1, sizeof *services.repliers);
    return services.repliers == NULL ? DDS_RETCODE_OUT_OF_RESOURCES : DDS_RETCODE_OK;
}

/** Writes the identification of service `index`, by which a client finds the reader and the writer that belong together. */
static void identify(dds_entity_t participant, size_t index, char *text, size_t size)
{
    dds_guid_t guid = {{0}};
    size_t length = 0;
    (void)dds_get_guid(participant, &guid);
    for (size_t i = 0; i < 12; i++) { /* the other four bytes are the same for all participants */
        length += (size_t)snprintf(text + length, size - length, "%x.", (unsigned int)guid.v[i]);
    }
    (void)snprintf(text + length, size - length, "%x", (unsigned int)index + 1U);
}

static dds_qos_t *qos_of(const char *hash, const char *id)
{
    char extra[ID + 16];
    dds_qos_t *qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, 0);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, DEPTH);
    dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
    dds_qset_writer_data_lifecycle(qos, false);
    (void)snprintf(extra, sizeof extra, "serviceid=%s;", id);
    epg_dds_set_user_data(qos, hash, extra);
    return qos;
}

/** Creates the reader for requests, or the writer for replies. */
static dds_return_t create_endpoint(dds_entity_t participant, size_t index, bool reply, const char *id)
{
    replier_t *replier = &services.repliers[index];
    const epg_service_kind_t *kind = services.node->target->services[index].kind;
    const epg_service_type_t *type = reply ? &kind->reply : &kind->request;
    struct ddsi_sertype *sertype;
    char name[NAME];
    if (epg_service_topic(services.node, index, reply, name, sizeof name) == 0) {
        return DDS_RETCODE_BAD_PARAMETER;
    }
    const dds_entity_t topic = epg_dds_topic(participant, name, type->type, &sertype);
    if (topic < 0) {
        return topic;
    }
    dds_qos_t *qos = qos_of(type->hash, id);
    dds_entity_t entity;
    if (reply) {
        replier->type = sertype;
        entity = replier->writer = dds_create_writer(participant, topic, qos, NULL);
    } else {
        entity = replier->reader = dds_create_reader(participant, topic, qos, NULL);
    }
    dds_delete_qos(qos);
    return entity;
}

dds_return_t epg_dds_create_repliers(dds_entity_t participant)
{
    dds_return_t code = DDS_RETCODE_OK;
    for (size_t i = 0; i < services.count && code >= 0; i++) {
        char id[ID];
        identify(participant, i, id, sizeof id);
        code = create_endpoint(participant, i, true, id); /* first: who finds the reader can then be answered */
        code = code < 0 ? code : create_endpoint(participant, i, false, id);
    }
    return code;
}

void epg_dds_list_repliers(dds_entity_t *readers, dds_entity_t *writers)
{
    for (size_t i = 0; i < services.count; i++) {
        readers[i] = services.repliers[i].reader;
        writers[i] = services.repliers[i].writer;
    }
}

/* Clients ------------------------------------------------------------------------------------------------------ */

/** Copies the identification of a client from the QoS of one of its endpoints.  Returns false if there is none. */
static bool client_of(const dds_qos_t *qos, char *client)
{
    static const char key[] = "clientid=";
    void *data = NULL;
    size_t size = 0;
    bool found = false;
    if (qos != NULL && dds_qget_userdata(qos, &data, &size) && data != NULL) {
        const char *text = data; /* CycloneDDS adds a zero to it */
        const char *start = strstr(text, key);
        const size_t length = start == NULL ? 0 : strcspn(start + sizeof key - 1, ";");
        found = length > 0 && length < ID;
        if (found) {
            memcpy(client, start + sizeof key - 1, length);
            client[length] = '\0';
        }
    }
    dds_free(data);
    return found;
}

/** Returns true if the writer of replies knows the reader of the client, so that a reply arrives there. */
static bool reader_is_known(dds_entity_t writer)
{
    dds_instance_handle_t readers[64];
    const size_t room = sizeof readers / sizeof readers[0];
    const dds_return_t count = dds_get_matched_subscriptions(writer, readers, room);
    bool found = count > (dds_return_t)room; /* too many to look at */
    for (dds_return_t i = 0; i < count && !found; i++) {
        char client[ID];
        dds_builtintopic_endpoint_t *reader = dds_get_matched_subscription_data(writer, readers[i]);
        if (reader != NULL) {
            found = client_of(reader->qos, client) && strcmp(client, services.client) == 0;
            dds_builtintopic_free_endpoint(reader);
        }
    }
    return found;
}

/**
 * Reports a client that gets no replies, because its RMW writes requests in another way.  Each program is reported once,
 * whatever it asks for.
 */
static void report_stranger(size_t index, const dds_guid_t *participant)
{
    services.node->client_advice =
        "a client of another RMW gets no reply: run it with RMW_IMPLEMENTATION=rmw_cyclonedds_cpp";
    for (size_t i = 0; i < STRANGERS; i++) {
        if (memcmp(&services.strangers[i], participant, sizeof *participant) == 0) {
            return;
        }
    }
    memmove(&services.strangers[1], &services.strangers[0], sizeof services.strangers - sizeof services.strangers[0]);
    services.strangers[0] = *participant;
    const epg_service_t *service = &services.node->target->services[index];
    char name[EPG_NODE_TOPIC_SIZE] = "";
    (void)epg_node_name(services.node, service->name, true, name, sizeof name);
    if (epg_host_logs(EPG_HOST_LOG_WARN)) {
        fprintf(stderr,
                "warning: a client of another RMW asks for %s: it gets no reply\n"
                "hint: run it with RMW_IMPLEMENTATION=rmw_cyclonedds_cpp\n",
                name);
    }
}

/* Requests and replies ----------------------------------------------------------------------------------------- */

/** Passes a request to the node, if a client of rmw_cyclonedds has sent it. */
static void pass(size_t index, const struct ddsi_serdata *message, dds_instance_handle_t sender, uint64_t now_ns)
{
    size_t size = 0;
    const unsigned char *data = epg_dds_content(message, &size);
    dds_builtintopic_endpoint_t *writer = dds_get_matched_publication_data(services.repliers[index].reader, sender);
    if (writer == NULL) {
        return; /* the client has ended */
    }
    const bool known = client_of(writer->qos, services.client);
    if (!known) {
        report_stranger(index, &writer->participant_key);
    }
    dds_builtintopic_free_endpoint(writer);
    if (!known || data == NULL || size < HEADER) {
        services.node->malformed++;
        return;
    }
    memcpy(services.header, data, HEADER);
    services.asked = index;
    services.ready = false;
    (void)epg_service_request(services.node, index, data + HEADER, size - HEADER, now_ns);
}

/** Lets the requests to disable that wait act at once: they do not wait for the replies to others. */
static void look_ahead(size_t index)
{
    struct ddsi_serdata *messages[DEPTH] = {NULL};
    dds_sample_info_t infos[DEPTH];
    replier_t *replier = &services.repliers[index];
    const dds_return_t count = dds_readcdr(replier->reader, messages, DEPTH, infos, DDS_ANY_STATE);
    replier->before_stop = 0;
    if (!services.node->services_clean || replier->stale > count) {
        replier->stale = count > 0 ? count : 0;
    }
    for (dds_return_t i = 0; i < count; i++) {
        size_t size = 0;
        const unsigned char *data = epg_dds_content(messages[i], &size);
        if (infos[i].valid_data && data != NULL && size > HEADER &&
            epg_service_is_stop(services.node, index, data + HEADER, size - HEADER)) {
            replier->before_stop = i + 1;
            if (infos[i].sample_state == DDS_SST_NOT_READ) {
                epg_stop(services.node->target->control, EPG_STOP_SERVICE);
            }
        }
        ddsi_serdata_unref(messages[i]);
    }
}

/** Takes one request of each service until one is in work. */
static void take_request(uint64_t now_ns)
{
    const size_t first = services.next;
    for (size_t i = 0; i < services.count && epg_service_idle(services.node); i++) {
        const size_t index = (first + i) % services.count;
        replier_t *replier = &services.repliers[index];
        struct ddsi_serdata *message = NULL;
        dds_sample_info_t info;
        if (dds_takecdr(replier->reader, &message, 1, &info, DDS_ANY_STATE) > 0) {
            epg_service_state_t *state = services.node->target->service_state;
            services.next = (index + 1) % services.count;
            state->stopped = info.sample_state == DDS_SST_READ;
            state->overtaken = replier->before_stop > 1 || replier->stale > 0;
            replier->before_stop--;
            replier->stale -= replier->stale > 0 ? 1 : 0;
            if (info.valid_data) {
                pass(index, message, info.publication_handle, now_ns);
            }
            ddsi_serdata_unref(message);
        }
    }
}

static void send_reply(void)
{
    const replier_t *replier = &services.repliers[services.asked];
    const size_t size = epg_service_reply_size(services.node);
    unsigned char *data = malloc(HEADER + size);
    if (data != NULL) {
        memcpy(data, services.header, HEADER);
        (void)epg_service_reply(services.node, 0, data + HEADER, size);
        (void)epg_dds_write(replier->writer, replier->type, data, HEADER + size);
        free(data);
    }
    epg_service_done(services.node);
}

void epg_dds_poll_repliers(uint64_t now_ns)
{
    if (services.count == 0) {
        return;
    }
    for (size_t i = 0; i < services.count; i++) {
        if (services.node->target->services[i].kind == &epg_service_enable) {
            look_ahead(i);
        }
    }
    take_request(now_ns);
    if (!epg_service_poll(services.node, now_ns)) {
        return;
    }
    if (!services.ready) {
        services.ready = true;
        services.ready_ns = now_ns;
    }
    if (reader_is_known(services.repliers[services.asked].writer) || now_ns - services.ready_ns > MATCH_NS) {
        send_reply();
    }
}

void epg_dds_leave_repliers(void)
{
    if (services.count > 0) {
        epg_service_done(services.node);
    }
}

void epg_dds_stop_repliers(void)
{
    free(services.repliers);
    services.repliers = NULL;
    services.count = 0;
}
