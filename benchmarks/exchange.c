/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Prints the time of one operation of the exchange in nanoseconds, for values of several sizes: alone, and while
 * another thread does the opposite operation as fast as it can.
 *
 *   exchange <thousands of operations>
 */
#define _POSIX_C_SOURCE 200809L

#include "epg/exchange.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { LARGEST = 1024 };

typedef void operation_t(epg_exchange_t *exchange, void *value);

static unsigned char buffers[4 * LARGEST];
static epg_exchange_t exchange;
static atomic_bool running;

static void write_value(epg_exchange_t *to, void *value)
{
    epg_exchange_write(to, value);
}

static void read_value(epg_exchange_t *from, void *value)
{
    (void)epg_exchange_read(from, value);
}

static void take_value(epg_exchange_t *from, void *value)
{
    (void)epg_exchange_take(from, value);
}

static void *oppose(void *operation)
{
    unsigned char value[LARGEST] = {0};
    operation_t *const *act = operation;
    while (atomic_load(&running)) {
        (*act)(&exchange, value);
    }
    return NULL;
}

/** Time of one operation in nanoseconds: the best of five series of `count` operations. */
static double measure(operation_t *operation, unsigned long count)
{
    unsigned char value[LARGEST] = {1};
    double best = 1e300;
    for (int repetition = 0; repetition < 5; repetition++) {
        struct timespec begin;
        struct timespec end;
        clock_gettime(CLOCK_MONOTONIC, &begin);
        for (unsigned long i = 0; i < count; i++) {
            operation(&exchange, value);
        }
        clock_gettime(CLOCK_MONOTONIC, &end);
        const double ns = (double)(end.tv_sec - begin.tv_sec) * 1e9 + (double)(end.tv_nsec - begin.tv_nsec);
        best = ns < best ? ns : best;
    }
    return best / (double)count;
}

/** The same as measure(), while another thread does the operation `opposite`. */
static double measure_opposed(operation_t *operation, operation_t *opposite, unsigned long count)
{
    pthread_t thread;
    atomic_store(&running, true);
    if (pthread_create(&thread, NULL, oppose, &opposite) != 0) {
        fputs("no second thread\n", stderr);
        exit(1);
    }
    const double ns = measure(operation, count);
    atomic_store(&running, false);
    pthread_join(thread, NULL);
    return ns;
}

int main(int argc, char **argv)
{
    static const size_t sizes[] = {8, 16, 72, 256, LARGEST};
    const unsigned long count = 1000UL * (argc > 1 ? strtoul(argv[1], NULL, 10) : 100UL);
    if (count == 0) {
        fputs("usage: exchange THOUSANDS\n", stderr);
        return 2;
    }
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        exchange = (epg_exchange_t){.buffers = buffers, .size = sizes[i]};
        const double write = measure(write_value, count);
        const double read = measure(read_value, count);
        (void)measure(take_value, 1);
        const double take = measure(take_value, count); /* there is no new value to take */
        const double write_opposed = measure_opposed(write_value, read_value, count);
        const double read_opposed = measure_opposed(read_value, write_value, count);
        printf("%zu %.2f %.2f %.2f %.2f %.2f\n", sizes[i], write, read, take, write_opposed, read_opposed);
    }
    return 0;
}
