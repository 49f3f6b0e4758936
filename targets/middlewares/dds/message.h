/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Messages as CycloneDDS carries them, without knowing what is in them: bytes with their encapsulation header.
 *
 * CycloneDDS wants a description of each type in C, from which it (de)serialises structures; node and topics of EPG
 * have their own (epg/message.h).  This is CycloneDDS's way out, which rmw_cyclonedds takes too: a type (`sertype`)
 * whose messages (`serdata`) are made of bytes and give bytes.
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

/** Bytes of the largest message that is taken; a larger one is dropped before memory is found for it. */
#define EPG_DDS_MESSAGE_LARGEST 65536

/**
 * A topic of `participant` with the name and type as DDS has them.  `*type` is what messages for it are made with; it
 * lives as long as the topic.  Returns the topic, or a negative return code.
 */
dds_entity_t epg_dds_topic(dds_entity_t participant, const char *name, const char *type_name,
                           struct ddsi_sertype **type);

/** Writes `size` bytes of CDR, little endian.  Never waits: a negative return code if there is no room. */
dds_return_t epg_dds_write(dds_entity_t writer, const struct ddsi_sertype *type, const void *data, size_t size);

/**
 * The CDR of a message received, without encapsulation header and padding; NULL if it is none that the runtime reads:
 * big endian, another encoding, or too short.
 */
const void *epg_dds_content(const struct ddsi_serdata *message, size_t *size);

#endif
