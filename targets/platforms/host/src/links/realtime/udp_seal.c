/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Sealed datagrams.
 */
#include "udp_seal.h"

#include <string.h>

#include "links/blake2s.h"

enum {
    NONCES = 4, /* places in the head */
    COUNTER = NONCES + 2 * EPG_HOST_UDP_NONCE,
    TAG = COUNTER + 8,
    TAG_SIZE = EPG_HOST_UDP_SEAL - TAG,
    BITS = 64
};

static const unsigned char magic[] = {0x01, 'E', 'P', 'K'};

/* Keys --------------------------------------------------------------------------------------------------------- */

static int digit_of(char character)
{
    static const char digits[] = "0123456789abcdefABCDEF";
    const char *found = character == '\0' ? NULL : strchr(digits, character);
    const int value = found == NULL ? -1 : (int)(found - digits);
    return value < 16 ? value : value - 6;
}

bool epg_host_udp_key_read(const char *text, unsigned char key[EPG_HOST_UDP_KEY])
{
    size_t count = 0;
    memset(key, 0, EPG_HOST_UDP_KEY);
    for (; *text != '\0'; text++) {
        const int digit = digit_of(*text);
        if (digit >= 0 && count < 2U * EPG_HOST_UDP_KEY) {
            key[count / 2] = (unsigned char)(key[count / 2] << 4U | digit);
            count++;
        } else if (digit >= 0 || strchr("- \t\r\n", *text) == NULL) {
            return false;
        }
    }
    return count == 2U * EPG_HOST_UDP_KEY;
}

void epg_host_udp_key_write(const unsigned char key[EPG_HOST_UDP_KEY], char text[EPG_HOST_UDP_KEY_TEXT])
{
    static const char digits[] = "0123456789abcdef";
    for (size_t i = 0; i < EPG_HOST_UDP_KEY; i++) {
        *text++ = digits[key[i] >> 4U];
        *text++ = digits[key[i] & 15U];
        if (i % 2 == 1) {
            *text++ = i + 1 < EPG_HOST_UDP_KEY ? '-' : '\0';
        }
    }
}

/* Datagrams ---------------------------------------------------------------------------------------------------- */

bool epg_host_udp_is_sealed(const unsigned char *data, size_t size)
{
    return size >= EPG_HOST_UDP_SEAL && memcmp(data, magic, sizeof magic) == 0;
}

const unsigned char *epg_host_udp_seal_of_program(const unsigned char *data)
{
    return data + NONCES;
}

const unsigned char *epg_host_udp_seal_of_target(const unsigned char *data)
{
    return data + NONCES + EPG_HOST_UDP_NONCE;
}

void epg_host_udp_seal_derive(epg_host_udp_seal_t *seal, const unsigned char key[EPG_HOST_UDP_KEY],
                              const unsigned char program[EPG_HOST_UDP_NONCE],
                              const unsigned char target[EPG_HOST_UDP_NONCE])
{
    static const char purpose[] = "EPG console";
    epg_host_udp_seal_t derived = {0}; /* the two numbers can be those of `seal` */
    epg_host_blake2s_t hash;
    memcpy(derived.nonces, program, EPG_HOST_UDP_NONCE);
    memcpy(derived.nonces + EPG_HOST_UDP_NONCE, target, EPG_HOST_UDP_NONCE);
    epg_host_blake2s_begin(&hash, sizeof derived.key, key, EPG_HOST_UDP_KEY);
    epg_host_blake2s_add(&hash, purpose, sizeof purpose - 1);
    epg_host_blake2s_add(&hash, derived.nonces, sizeof derived.nonces);
    epg_host_blake2s_end(&hash, derived.key);
    *seal = derived;
}

bool epg_host_udp_seal_is_of(const epg_host_udp_seal_t *seal, const unsigned char *data)
{
    return memcmp(seal->nonces, data + NONCES, sizeof seal->nonces) == 0;
}

/** Computes the tag of the counter and the datagram behind the head. */
static void compute_tag(const epg_host_udp_seal_t *seal, epg_host_udp_direction_t direction, const unsigned char *data,
                        size_t size, unsigned char tag[TAG_SIZE])
{
    const unsigned char first = (unsigned char)direction;
    epg_host_blake2s_t hash;
    epg_host_blake2s_begin(&hash, TAG_SIZE, seal->key, sizeof seal->key);
    epg_host_blake2s_add(&hash, &first, 1);
    epg_host_blake2s_add(&hash, data + COUNTER, TAG - COUNTER);
    epg_host_blake2s_add(&hash, data + EPG_HOST_UDP_SEAL, size - EPG_HOST_UDP_SEAL);
    epg_host_blake2s_end(&hash, tag);
}

bool epg_host_udp_seal_proves(const epg_host_udp_seal_t *seal, epg_host_udp_direction_t direction,
                              const unsigned char *data, size_t size)
{
    unsigned char tag[TAG_SIZE];
    compute_tag(seal, direction, data, size, tag);
    unsigned int difference = 0; /* of all bytes, so that the time of the comparison says nothing about the tag */
    for (size_t i = 0; i < TAG_SIZE; i++) {
        difference |= (unsigned int)(tag[i] ^ data[TAG + i]);
    }
    return difference == 0;
}

static uint64_t counter_of(const unsigned char *data)
{
    uint64_t counter = 0;
    for (unsigned int i = 0; i < 8; i++) {
        counter |= (uint64_t)data[COUNTER + i] << 8U * i;
    }
    return counter;
}

bool epg_host_udp_seal_accept(epg_host_udp_seal_t *seal, const unsigned char *data)
{
    const uint64_t counter = counter_of(data);
    if (counter > seal->newest) {
        const uint64_t step = counter - seal->newest;
        const uint64_t before = step < BITS ? seal->seen << step : 0U;
        seal->seen = step <= BITS ? before | UINT64_C(1) << (step - 1U) : 0U;
        seal->newest = counter;
        return true;
    }
    const uint64_t age = seal->newest - counter;
    if (age == 0 || age > BITS || (seal->seen >> (age - 1U) & 1U) != 0) {
        return false;
    }
    seal->seen |= UINT64_C(1) << (age - 1U);
    return true;
}

void epg_host_udp_seal_write(const epg_host_udp_seal_t *seal, epg_host_udp_direction_t direction, uint64_t counter,
                             unsigned char *data, size_t size)
{
    memcpy(data, magic, sizeof magic);
    memcpy(data + NONCES, seal->nonces, sizeof seal->nonces);
    for (unsigned int i = 0; i < 8; i++) {
        data[COUNTER + i] = (unsigned char)(counter >> 8U * i);
    }
    compute_tag(seal, direction, data, size + EPG_HOST_UDP_SEAL, data + TAG);
}
