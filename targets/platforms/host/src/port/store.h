/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The file of the port layer's store.
 */
#ifndef EPG_HOST_STORE_H
#define EPG_HOST_STORE_H

#include "epg/store.h"

/** Sets the file of the port layer's store.  It need not exist.  NULL, the value at the start: there is no store. */
void epg_host_store_open(const char *path);

/** Says on stderr which values of the file were not loaded, and why.  Must be called after the store was loaded. */
void epg_host_store_tell(const epg_store_t *store);

#endif
