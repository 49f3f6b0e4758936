/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What makes a DDS participant a node of the ROS graph: the topic `ros_discovery_info`, on which each participant says
 * which nodes it has and which readers and writers are theirs.  `ros2 node list` and `ros2 node info` show that.
 *
 * Source: rmw_dds_common of ROS 2 Jazzy: msg/ParticipantEntitiesInfo.msg, msg/NodeEntitiesInfo.msg, msg/Gid.msg.  (ROS 2
 * Humble has identifiers of 24 bytes there, and does not understand it.)
 */
#ifndef EPG_DDS_GRAPH_H
#define EPG_DDS_GRAPH_H

#include <stdbool.h>
#include <stddef.h>

#include "dds/dds.h"
#include "epg/node.h"

/** "typehash=RIHS01_...;" as USER_DATA of a reader or writer; nothing for an empty `hash`.  REP 2016. */
void epg_dds_set_type_hash(dds_qos_t *qos, const char *hash);

/**
 * Publishes that `participant` has one node, `node`, with these readers and writers; what is published stays for those
 * who join later.  Returns the writer, or a negative return code.
 */
dds_entity_t epg_dds_publish_graph(dds_entity_t participant, const epg_node_t *node, const dds_entity_t *readers,
                                   size_t reader_count, const dds_entity_t *writers, size_t writer_count);

#endif
