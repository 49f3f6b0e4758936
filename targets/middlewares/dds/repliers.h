/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The services of the node on DDS, as rmw_cyclonedds makes them: a reader for requests and a writer for replies each.
 *
 * A header of 16 bytes precedes each request and its reply: the number of the client, and the number of the request.
 * rmw_fastrtps does not write it, but puts these numbers elsewhere; the two cannot call each other's services.  A
 * request of another kind of client is counted as malformed.
 *
 * Source: rmw_cyclonedds_cpp 2.2 (ROS 2 Jazzy), serdata.hpp, cdds_request_header_t; rmw_node.cpp, rmw_init_cs() and
 * rmw_send_response().
 */
#ifndef EPG_DDS_REPLIERS_H
#define EPG_DDS_REPLIERS_H

#include <stddef.h>
#include <stdint.h>

#include "dds/dds.h"
#include "epg/node.h"

/** Allocates the memory for all services of `node`.  Returns DDS_RETCODE_OUT_OF_RESOURCES if there is none. */
dds_return_t epg_dds_start_repliers(epg_node_t *node);

/** Creates the reader and the writer of each service.  Returns a negative return code if one fails. */
dds_return_t epg_dds_create_repliers(dds_entity_t participant);

/** Copies the readers and the writers, one of each per service. */
void epg_dds_list_repliers(dds_entity_t *readers, dds_entity_t *writers);

/** Takes the next request if none is in work, and sends the reply when it is ready. */
void epg_dds_poll_repliers(uint64_t now_ns);

/** Must be called when the participant is deleted: ends the work on a request. */
void epg_dds_leave_repliers(void);

/** Frees the memory. */
void epg_dds_stop_repliers(void);

#endif
