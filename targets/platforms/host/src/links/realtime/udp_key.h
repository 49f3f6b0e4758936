/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The key of the console by UDP, from a file or from chance.
 */
#ifndef EPG_HOST_UDP_KEY_H
#define EPG_HOST_UDP_KEY_H

#include <stdbool.h>
#include <stddef.h>

#include "udp_seal.h"

/** Reads the key from the file `path`, which nobody else may be able to read.  Returns false after a message. */
bool epg_host_udp_key_load(const char *path, unsigned char key[EPG_HOST_UDP_KEY]);

/** Fills `data` with bytes from the system's random source. */
void epg_host_udp_random(void *data, size_t size);

#endif
