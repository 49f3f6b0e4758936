/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Random numbers that depend only on a seed, the name of a connection and the number of a message.
 *
 * A further connection or message therefore changes no other one.  Algorithm: SplitMix64 (G. Steele, D. Lea, C. Flood,
 * "Fast splittable pseudorandom number generators", OOPSLA 2014), seeded by a FNV-1a hash of the name.
 */
#ifndef EPG_SYSTEM_RANDOM_H
#define EPG_SYSTEM_RANDOM_H

#include <stdint.h>

typedef struct random {
    uint64_t state;
} random_t;

static inline uint64_t random_next(random_t *random)
{
    random->state += 0x9E3779B97F4A7C15U;
    uint64_t mixed = random->state;
    mixed = (mixed ^ mixed >> 30) * 0xBF58476D1CE4E5B9U;
    mixed = (mixed ^ mixed >> 27) * 0x94D049BB133111EBU;
    return mixed ^ mixed >> 31;
}

/** The numbers of message `number` of the connection `name`. */
static inline random_t random_of(uint64_t seed, const char *name, uint64_t number)
{
    uint64_t hash = 0xCBF29CE484222325U;
    for (; *name != '\0'; name++) {
        hash = (hash ^ (unsigned char)*name) * 0x100000001B3U;
    }
    random_t random = {.state = seed};
    random.state = random_next(&random) ^ hash;
    random.state = random_next(&random) + number;
    return random;
}

/** A number from 0 to `count` - 1.  Its distribution is uniform but for `count` / 2^64. */
static inline uint64_t random_below(random_t *random, uint64_t count)
{
    return random_next(random) % count;
}

#endif
