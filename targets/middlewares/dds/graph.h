/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The ROS graph: makes a DDS participant visible as a ROS 2 node.
 *
 * On the topic `ros_discovery_info`, each participant publishes its nodes, and the readers and writers of each node.
 * `ros2 node list` and `ros2 node info` show this information.
 *
 * Source: rmw_dds_common of ROS 2 Jazzy: msg/ParticipantEntitiesInfo.msg, msg/NodeEntitiesInfo.msg, msg/Gid.msg.  (ROS
 * 2 Humble cannot read these messages, because it has identifiers of 24 bytes there.)
 */
#ifndef EPG_DDS_GRAPH_H
#define EPG_DDS_GRAPH_H

#include <stdbool.h>
#include <stddef.h>

#include "dds/dds.h"
#include "epg/node.h"

/**
 * Sets "typehash=RIHS01_...;" (REP 2016) and the text `more` as USER_DATA of a reader or writer.  Does nothing if `hash`
 * is empty.
 */
void epg_dds_set_user_data(dds_qos_t *qos, const char *hash, const char *more);

/**
 * Publishes that `participant` has one node, `node`, with these readers and writers.  Participants that join later get
 * this message, too.  Returns the writer, or a negative return code.
 */
dds_entity_t epg_dds_publish_graph(dds_entity_t participant, const epg_node_t *node, const dds_entity_t *readers,
                                   size_t reader_count, const dds_entity_t *writers, size_t writer_count);

#endif
