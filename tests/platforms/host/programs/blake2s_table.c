/**
 * @file
 * Prints the hashes of messages of all sizes from 0 to 299, with keys of 0 to 32 bytes, for a comparison with Python's.
 */
#include <stdio.h>

#include "links/blake2s.h"

int main(void)
{
    unsigned char data[300];
    for (size_t i = 0; i < sizeof data; i++) {
        data[i] = (unsigned char)(i * 7U);
    }
    for (size_t size = 0; size < sizeof data; size++) {
        unsigned char hash[EPG_HOST_BLAKE2S_MOST];
        const size_t hash_size = 1 + size % EPG_HOST_BLAKE2S_MOST;
        epg_host_blake2s_t state;
        epg_host_blake2s_begin(&state, hash_size, data, size % (EPG_HOST_BLAKE2S_MOST + 1));
        epg_host_blake2s_add(&state, data, size);
        epg_host_blake2s_end(&state, hash);
        for (size_t i = 0; i < hash_size; i++) {
            printf("%02x", hash[i]);
        }
        printf("\n");
    }
    return 0;
}
