/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The status of a target as a ROS 2 message, `diagnostic_msgs/msg/DiagnosticArray`.  Tools such as rqt display it.
 */
#ifndef EPG_DIAGNOSTICS_H
#define EPG_DIAGNOSTICS_H

#include "epg/node.h"

/** Bytes of the largest message, for all names and numbers, and for a serial number of at most 64 characters. */
#define EPG_DIAGNOSTICS_SIZE 1536

/** The `message` of a publication with the role EPG_TOPIC_DIAGNOSTICS.  epg_diagnostics_write() writes it. */
extern const epg_message_t epg_message_diagnostic_array;

/**
 * Writes the message as CDR (epg/cdr.h).  Returns the number of bytes, 0 if they do not fit or if there is no status
 * yet.  The level is ERROR while a fault is latched, WARN while the target is disabled by request, and OK otherwise.
 */
size_t epg_diagnostics_write(epg_node_t *node, epg_stamp_t stamp, void *data, size_t size);

#endif
