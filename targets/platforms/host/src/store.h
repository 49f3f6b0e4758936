/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The file of the port layer's store.
 */
#ifndef EPG_HOST_STORE_H
#define EPG_HOST_STORE_H

/** Sets the file of the port layer's store.  It need not exist.  NULL, the value at the start: there is no store. */
void epg_host_store_open(const char *path);

#endif
