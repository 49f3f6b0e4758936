/**
 * @file
 * One thread writes and one reads, both as fast as they can.  No value may be torn, older than the last one read, or
 * older than a write that had returned.
 *
 * Argument: seconds; the program ends at the first wrong value.  With -DRACES_ONLY, for ThreadSanitizer, the threads
 * share only the exchange: any other shared variable would order their accesses and hide races.
 */
#define _POSIX_C_SOURCE 200809L

#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "epg/exchange.h"

enum { WORDS = 24 };

typedef struct value {
    uint64_t words[WORDS];
} value_t;

static value_t buffers[4];
static epg_exchange_t exchange = EPG_EXCHANGE(buffers);
static uint64_t end_ns;

#ifdef RACES_ONLY
enum { RACES = 1 }; /* at a race, ThreadSanitizer ends the program */
#else
enum { RACES = 0 };
static _Atomic uint64_t finished; /* number of the newest write that has returned */
#endif

static uint64_t time_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now); /* the threads run as long as they may */
    return (uint64_t)now.tv_sec * 1000000000U + (uint64_t)now.tv_nsec;
}

static void *write_values(void *argument)
{
    uint64_t *count = argument;
    value_t value;
    while (time_ns() < end_ns) {
        for (int i = 0; i < 100; i++) {
            ++*count;
            for (int word = 0; word < WORDS; word++) {
                value.words[word] = *count;
            }
            epg_exchange_write(&exchange, &value);
#ifndef RACES_ONLY
            atomic_store(&finished, *count);
#endif
        }
    }
    return NULL;
}

int main(int argc, char **argv)
{
    end_ns = time_ns() + (uint64_t)((argc > 1 ? atof(argv[1]) : 1.0) * 1e9);
    uint64_t writes = 0;
    uint64_t reads = 0;
    uint64_t changes = 0;
    uint64_t torn = 0;
    uint64_t disordered = 0;
    uint64_t stale = 0;
    uint64_t last = 0;

    pthread_t writer;
    if (pthread_create(&writer, NULL, write_values, &writes) != 0) {
        fprintf(stderr, "no second thread\n");
        return 3;
    }
    while (time_ns() < end_ns && (RACES || torn + disordered + stale == 0)) {
        for (int i = 0; i < 100; i++) {
            value_t value;
#ifdef RACES_ONLY
            const uint64_t expected = 0;
#else
            const uint64_t expected = atomic_load(&finished);
#endif
            const bool given = i % 2 == 0 ? epg_exchange_read(&exchange, &value) : epg_exchange_take(&exchange, &value);
            if (!given) {
                stale += last < expected;
                continue;
            }
            reads++;
            for (int word = 1; word < WORDS; word++) {
                if (value.words[word] != value.words[0]) {
                    torn++;
                    break;
                }
            }
            disordered += value.words[0] < last;
            stale += value.words[0] < expected;
            changes += value.words[0] != last;
            last = value.words[0];
        }
    }
    const bool wrong = torn + disordered + stale > 0;
    if (RACES || !wrong) {
        pthread_join(writer, NULL);
    }
    printf("writes %" PRIu64 " reads %" PRIu64 " changes %" PRIu64 " torn %" PRIu64 " disordered %" PRIu64
           " stale %" PRIu64 "\n",
           RACES || !wrong ? writes : 0, reads, changes, torn, disordered, stale);
    return wrong ? 1 : 0; /* this also ends the writer */
}
