/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The ROS graph: makes a DDS participant visible as a ROS 2 node.
 */
#include "graph.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "epg/cdr.h"
#include "message.h"

#define TYPE "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"
#define TYPE_HASH "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"

enum { GID = 16, FIXED = 64 + EPG_NODE_NAME_SIZE + EPG_NODE_SPACE_SIZE }; /* bytes */

void epg_dds_set_user_data(dds_qos_t *qos, const char *hash, const char *more)
{
    char text[192];
    const int length = snprintf(text, sizeof text, "typehash=%s;%s", hash, more);
    if (hash[0] != '\0' && length > 0 && (size_t)length < sizeof text) {
        dds_qset_userdata(qos, text, (size_t)length);
    }
}

static bool write_gid(epg_cdr_writer_t *message, dds_entity_t entity)
{
    dds_guid_t guid;
    const bool good = dds_get_guid(entity, &guid) == DDS_RETCODE_OK;
    for (size_t i = 0; i < GID; i++) {
        epg_cdr_write_u8(message, good ? guid.v[i] : 0);
    }
    return good;
}

static bool write_gids(epg_cdr_writer_t *message, const dds_entity_t *entities, size_t count)
{
    bool good = true;
    epg_cdr_write_u32(message, (uint32_t)count);
    for (size_t i = 0; i < count; i++) {
        good = write_gid(message, entities[i]) && good;
    }
    return good;
}

/** Creates the writer with the QoS of rmw_dds_common: reliable, and the last message is kept for later readers. */
static dds_entity_t create_writer(dds_entity_t participant, struct ddsi_sertype **type)
{
    const dds_entity_t topic = epg_dds_topic(participant, "ros_discovery_info", TYPE, type);
    dds_qos_t *qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, 0);
    dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_durability_service(qos, 0, DDS_HISTORY_KEEP_LAST, 1, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
    dds_qset_writer_data_lifecycle(qos, false);
    epg_dds_set_user_data(qos, TYPE_HASH, "");
    const dds_entity_t writer = topic < 0 ? topic : dds_create_writer(participant, topic, qos, NULL);
    dds_delete_qos(qos);
    return writer;
}

dds_entity_t epg_dds_publish_graph(dds_entity_t participant, const epg_node_t *node, const dds_entity_t *readers,
                                   size_t reader_count, const dds_entity_t *writers, size_t writer_count)
{
    struct ddsi_sertype *type;
    const size_t size = FIXED + GID * (reader_count + writer_count);
    const dds_entity_t writer = create_writer(participant, &type);
    if (writer < 0) {
        return writer;
    }
    unsigned char *data = malloc(size);
    if (data == NULL) {
        return DDS_RETCODE_OUT_OF_RESOURCES;
    }
    epg_cdr_writer_t message = {.data = data, .size = size};
    bool good = write_gid(&message, participant);
    epg_cdr_write_u32(&message, 1); /* number of nodes */
    epg_cdr_write_string(&message, node->name_space[0] == '\0' ? "/" : node->name_space);
    epg_cdr_write_string(&message, node->name);
    good = write_gids(&message, readers, reader_count) && good;
    good = write_gids(&message, writers, writer_count) && good && !message.failed;
    const dds_return_t code = good ? epg_dds_write(writer, type, data, message.length) : DDS_RETCODE_ERROR;
    free(data);
    return code < 0 ? code : writer;
}
