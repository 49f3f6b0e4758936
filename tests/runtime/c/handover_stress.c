/**
 * @file
 * Two threads hand a block over and back as fast as they can: the whole block arrives, once, and its answer returns.
 *
 * Argument: rounds.  The threads share no other data, so that ThreadSanitizer detects every access that the handover
 * does not order.
 */
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#include "epg/handover.h"

enum { WORDS = 24 };

static epg_handover_t handover;
static uint64_t block[WORDS];
static atomic_bool end;

static void wrong(const char *what, uint64_t round)
{
    printf("%s in round %" PRIu64 "\n", what, round);
    exit(1);
}

static void *take(void *argument)
{
    uint64_t *rounds = argument;
    while (!atomic_load_explicit(&end, memory_order_relaxed)) {
        if (!epg_handover_there(&handover)) {
            continue;
        }
        ++*rounds;
        for (int i = 0; i < WORDS; i++) {
            if (block[i] != *rounds) {
                wrong("a wrong block", *rounds);
            }
            block[i] = ~*rounds;
        }
        epg_handover_return(&handover);
    }
    return NULL;
}

int main(int argc, char **argv)
{
    const uint64_t count = strtoull(argc > 1 ? argv[1] : "1000", NULL, 10);
    uint64_t taken = 0;
    uint64_t rounds = 0;
    pthread_t thread;
    pthread_create(&thread, NULL, take, &taken);
    while (rounds < count) {
        if (!epg_handover_here(&handover)) {
            continue;
        }
        for (int i = 0; i < WORDS; i++) {
            if (rounds > 0 && block[i] != ~rounds) {
                wrong("a wrong answer", rounds);
            }
            block[i] = rounds + 1;
        }
        rounds++;
        epg_handover_give(&handover);
    }
    while (!epg_handover_here(&handover)) {
    }
    atomic_store_explicit(&end, true, memory_order_relaxed);
    pthread_join(thread, NULL);
    printf("rounds %" PRIu64 "\n", rounds);
    return rounds == taken ? 0 : 1;
}
