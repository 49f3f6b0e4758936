/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Topics whose other end asks for, or offers, what they cannot have: DDS lets no message through then, in silence.
 */
#ifndef EPG_DDS_MATCHING_H
#define EPG_DDS_MATCHING_H

#include "dds/dds.h"

/** Warns, on stderr, if a reader has appeared that `writer` of topic `name` ("/pan_publisher") cannot serve. */
void epg_dds_check_writer(dds_entity_t writer, const char *name);

/** Warns if a writer has appeared that cannot serve `reader`. */
void epg_dds_check_reader(dds_entity_t reader, const char *name);

#endif
