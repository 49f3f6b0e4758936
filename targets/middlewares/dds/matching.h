/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Warnings about incompatible QoS.
 *
 * A reader can request a quality of service that a writer of the same topic does not offer.  DDS then delivers no
 * messages between the two, and reports nothing to the user.
 */
#ifndef EPG_DDS_MATCHING_H
#define EPG_DDS_MATCHING_H

#include "dds/dds.h"

/** Warns on stderr if a reader has appeared that `writer` of topic `name` ("/pan_publisher") cannot serve. */
void epg_dds_check_writer(dds_entity_t writer, const char *name);

/** Warns on stderr if a writer has appeared that cannot serve `reader` of topic `name`. */
void epg_dds_check_reader(dds_entity_t reader, const char *name);

#endif
