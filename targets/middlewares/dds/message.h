/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Messages for CycloneDDS as bytes, with their encapsulation header.
 *
 * CycloneDDS usually has a C description of each type, and uses it to (de)serialise structures.  EPG, however, has
 * already serialised its messages (epg/message.h).  CycloneDDS offers an interface for this case, which rmw_cyclonedds
 * uses, too: a type (`sertype`) whose messages (`serdata`) are made of bytes and give bytes.
 *
 * Source: dds/ddsi/ddsi_sertype.h and ddsi_serdata.h of CycloneDDS 0.10; OMG, "DDS Interoperability Wire Protocol" 2.5,
 * 10.2 (encapsulation header).
 */
#ifndef EPG_DDS_MESSAGE_H
#define EPG_DDS_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>

#include "dds/dds.h"
#include "dds/ddsi/ddsi_serdata.h"

/** Largest accepted message in bytes that arrives.  A larger one is dropped before memory is allocated for it. */
#define EPG_DDS_MESSAGE_LARGEST 65536

/**
 * Creates a topic of `participant`; `name` and `type_name` are those of DDS.  `*type` is needed to write messages; it
 * exists as long as the topic.  Returns the topic, or a negative return code.
 */
dds_entity_t epg_dds_topic(dds_entity_t participant, const char *name, const char *type_name,
                           struct ddsi_sertype **type);

/** Writes `size` bytes of little-endian CDR.  Never waits; returns a negative return code if there is no room. */
dds_return_t epg_dds_write(dds_entity_t writer, const struct ddsi_sertype *type, const void *data, size_t size);

/**
 * Returns the CDR of a received message, without its encapsulation header and padding, and its size.  Returns NULL if
 * the runtime cannot read the message: it is big endian, has another encoding, or is too short.
 */
const void *epg_dds_content(const struct ddsi_serdata *message, size_t *size);

#endif
