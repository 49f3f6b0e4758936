/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What outlives a run of the host: one file.
 */
#ifndef EPG_HOST_STORE_H
#define EPG_HOST_STORE_H

/** From now on the port layer's store is the file `path`, which need not exist; NULL, as at the start: there is none. */
void epg_host_store_open(const char *path);

#endif
