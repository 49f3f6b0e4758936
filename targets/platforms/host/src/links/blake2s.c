/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * BLAKE2s, as sections 2 and 3 of RFC 7693 define it.
 */
#include "blake2s.h"

#include <stdbool.h>
#include <string.h>

enum { BLOCK = EPG_HOST_BLAKE2S_BLOCK, ROUNDS = 10, WORDS = 16 };

/* Section 2.6: the initialisation vector, the same as that of SHA-256. */
static const uint32_t start[8] = {0x6A09E667, 0xBB67AE85, 0x3C6EF372, 0xA54FF53A,
                                  0x510E527F, 0x9B05688C, 0x1F83D9AB, 0x5BE0CD19};

/* Section 2.7: the order of the words of a block in each round. */
static const uint8_t order[ROUNDS][WORDS] = {
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}, {14, 10, 4, 8, 9, 15, 13, 6, 1, 12, 0, 2, 11, 7, 5, 3},
    {11, 8, 12, 0, 5, 2, 15, 13, 10, 14, 3, 6, 7, 1, 9, 4}, {7, 9, 3, 1, 13, 12, 11, 14, 2, 6, 5, 10, 4, 0, 15, 8},
    {9, 0, 5, 7, 2, 4, 10, 15, 14, 1, 11, 12, 6, 8, 3, 13}, {2, 12, 6, 10, 0, 11, 8, 3, 4, 13, 7, 5, 15, 14, 1, 9},
    {12, 5, 1, 15, 14, 13, 4, 10, 0, 7, 6, 3, 9, 2, 8, 11}, {13, 11, 7, 14, 12, 1, 3, 9, 5, 0, 15, 4, 8, 6, 2, 10},
    {6, 15, 14, 9, 11, 3, 0, 8, 12, 2, 13, 7, 1, 4, 10, 5}, {10, 2, 8, 4, 7, 6, 1, 5, 15, 11, 9, 14, 3, 12, 13, 0},
};

static uint32_t rotate(uint32_t word, unsigned int bits)
{
    return word >> bits | word << (32U - bits);
}

/** The function G of section 3.1: mixes two words of the block into a column or a diagonal. */
static void mix(uint32_t v[WORDS], unsigned int a, unsigned int b, unsigned int c, unsigned int d, uint32_t x,
                uint32_t y)
{
    v[a] += v[b] + x;
    v[d] = rotate(v[d] ^ v[a], 16);
    v[c] += v[d];
    v[b] = rotate(v[b] ^ v[c], 12);
    v[a] += v[b] + y;
    v[d] = rotate(v[d] ^ v[a], 8);
    v[c] += v[d];
    v[b] = rotate(v[b] ^ v[c], 7);
}

static uint32_t get_word(const unsigned char *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8U | (uint32_t)bytes[2] << 16U | (uint32_t)bytes[3] << 24U;
}

/** The function F of section 3.2.  `last` is true for the last block. */
static void compress(epg_host_blake2s_t *hash, const unsigned char *block, bool last)
{
    uint32_t m[WORDS];
    uint32_t v[WORDS];
    for (unsigned int i = 0; i < WORDS; i++) {
        m[i] = get_word(block + 4U * i);
    }
    for (unsigned int i = 0; i < 8; i++) {
        v[i] = hash->state[i];
        v[i + 8] = start[i];
    }
    v[12] ^= (uint32_t)hash->count;
    v[13] ^= (uint32_t)(hash->count >> 32U);
    v[14] ^= last ? UINT32_MAX : 0U;
    for (unsigned int round = 0; round < ROUNDS; round++) {
        const uint8_t *s = order[round];
        for (unsigned int i = 0; i < 4; i++) { /* the columns */
            mix(v, i, i + 4, i + 8, i + 12, m[s[2 * i]], m[s[2 * i + 1]]);
        }
        for (unsigned int i = 0; i < 4; i++) { /* the diagonals */
            mix(v, i, (i + 1) % 4 + 4, (i + 2) % 4 + 8, (i + 3) % 4 + 12, m[s[2 * i + 8]], m[s[2 * i + 9]]);
        }
    }
    for (unsigned int i = 0; i < 8; i++) {
        hash->state[i] ^= v[i] ^ v[i + 8];
    }
}

void epg_host_blake2s_begin(epg_host_blake2s_t *hash, size_t size, const void *key, size_t key_size)
{
    *hash = (epg_host_blake2s_t){.size = size};
    memcpy(hash->state, start, sizeof start);
    /* Section 2.5: the parameter block; fan-out and depth are 1. */
    hash->state[0] ^= UINT32_C(0x01010000) ^ (uint32_t)key_size << 8U ^ (uint32_t)size;
    if (key_size > 0) { /* the first block is the key, with zeros after it */
        memcpy(hash->block, key, key_size);
        hash->waiting = BLOCK;
    }
}

void epg_host_blake2s_add(epg_host_blake2s_t *hash, const void *data, size_t size)
{
    const unsigned char *bytes = data;
    while (size > 0) {
        if (hash->waiting == BLOCK) { /* it is not the last block */
            hash->count += BLOCK;
            compress(hash, hash->block, false);
            hash->waiting = 0;
        }
        const size_t room = BLOCK - hash->waiting;
        const size_t count = size < room ? size : room;
        memcpy(hash->block + hash->waiting, bytes, count);
        hash->waiting += count;
        bytes += count;
        size -= count;
    }
}

void epg_host_blake2s_end(epg_host_blake2s_t *hash, unsigned char *output)
{
    memset(hash->block + hash->waiting, 0, BLOCK - hash->waiting);
    hash->count += hash->waiting;
    compress(hash, hash->block, true);
    for (size_t i = 0; i < hash->size; i++) {
        output[i] = (unsigned char)(hash->state[i / 4] >> 8U * (i % 4));
    }
}
