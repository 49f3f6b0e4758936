/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * State and statistics of a target as `diagnostic_msgs/msg/DiagnosticArray`, which rqt and other tools of ROS 2 show.
 */
#ifndef EPG_DIAGNOSTICS_H
#define EPG_DIAGNOSTICS_H

#include "epg/node.h"

/** Bytes of the largest message, whatever names and numbers stand in it; of a serial number up to 64 characters. */
#define EPG_DIAGNOSTICS_SIZE 1280

/** For `message` of a publication whose role is EPG_TOPIC_DIAGNOSTICS; epg_diagnostics_write() writes it. */
extern const epg_message_t epg_message_diagnostic_array;

/**
 * Writes the message as CDR; returns its bytes, 0 if it does not fit or if there is no status yet.  Level: OK, WARN
 * while disabled by request, ERROR while a fault is latched.
 */
size_t epg_diagnostics_write(epg_node_t *node, epg_stamp_t stamp, void *data, size_t size);

#endif
