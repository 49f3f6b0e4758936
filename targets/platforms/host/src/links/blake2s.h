/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The hash BLAKE2s with a key (RFC 7693, "The BLAKE2 Cryptographic Hash and Message Authentication Code").
 *
 * With a key, the hash of a message proves that its sender has the key:
 *
 *     epg_host_blake2s_t hash;
 *     epg_host_blake2s_begin(&hash, 16, key, sizeof key);
 *     epg_host_blake2s_add(&hash, message, size);
 *     epg_host_blake2s_end(&hash, tag); // 16 bytes
 */
#ifndef EPG_HOST_BLAKE2S_H
#define EPG_HOST_BLAKE2S_H

#include <stddef.h>
#include <stdint.h>

enum {
    EPG_HOST_BLAKE2S_MOST = 32, /**< bytes of the longest hash, and of the longest key */
    EPG_HOST_BLAKE2S_BLOCK = 64
};

typedef struct epg_host_blake2s {
    uint32_t state[8];
    uint64_t count;                              /**< bytes that were compressed */
    unsigned char block[EPG_HOST_BLAKE2S_BLOCK]; /**< bytes that wait */
    size_t waiting;
    size_t size; /**< bytes of the hash */
} epg_host_blake2s_t;

/** Begins a hash of `size` bytes (1 to 32).  `key` has `key_size` bytes (0 to 32; 0: no key). */
void epg_host_blake2s_begin(epg_host_blake2s_t *hash, size_t size, const void *key, size_t key_size);

void epg_host_blake2s_add(epg_host_blake2s_t *hash, const void *data, size_t size);

/** Writes the hash. */
void epg_host_blake2s_end(epg_host_blake2s_t *hash, unsigned char *output);

#endif
