/**
 * @file
 * Threads enable and stop a target as fast as they can, while a third one runs its cycles.
 *
 * Argument: rounds.  In each round one thread enables and then the other one stops; the order is known, because a call
 * that has returned has arrived.  Then the second thread enables after a stop of its own, which must act.
 */
#define _POSIX_C_SOURCE 200809L

#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>

#include "epg/control.h"
#include "epg/port.h"

static epg_control_t control;
static atomic_bool forbidden;   /* a stop has returned: no cycle that begins now may drive */
static atomic_uint cycles;      /* cycles that have ended */
static atomic_uint driven;      /* cycles that drove the actuator */
static atomic_uint initialised; /* how often the model was initialised */
static atomic_uint wrong;       /* cycles that drove although they began after a stop */
static atomic_uint turn;        /* of the two threads that enable and stop */
static atomic_bool end;
static bool began_forbidden; /* of the thread that runs the cycles */

uint64_t epg_port_time_ns(void)
{
    return (uint64_t)atomic_load(&cycles) * 1000000U;
}

void epg_port_wait_until(uint64_t time_ns)
{
    (void)time_ns;
}

uint32_t epg_port_boot_id(void)
{
    return 1;
}

static void nothing(void)
{
}

static bool yes(void)
{
    return true;
}

static void sample(void)
{
    began_forbidden = atomic_load(&forbidden);
}

static void initialise(void)
{
    atomic_store(&initialised, atomic_load(&initialised) + 1U);
}

static void drive(void)
{
    atomic_store(&driven, atomic_load(&driven) + 1U);
    if (began_forbidden) {
        atomic_store(&wrong, atomic_load(&wrong) + 1U);
    }
}

static const epg_application_t application = {
    .name = "stress",
    .period_ns = 1000000,
    .step_divider = 1,
    .start = nothing,
    .sample = sample,
    .read = nothing,
    .inputs_finite = yes,
    .model_init = initialise,
    .model_step = nothing,
    .model_finite = yes,
    .write = drive,
    .safe = nothing,
};

static void *run_cycles(void *argument)
{
    (void)argument;
    while (!atomic_load(&end)) {
        epg_control_cycle(&control, epg_port_time_ns(), 0);
        atomic_store(&cycles, atomic_load(&cycles) + 1U);
        sched_yield();
    }
    return NULL;
}

static void wait_for_turn(unsigned int mine)
{
    while (atomic_load(&turn) != mine) {
        sched_yield();
    }
}

/* Waits until `count` cycles have begun and ended. */
static void wait_cycles(unsigned int count)
{
    const unsigned int first = atomic_load(&cycles);
    while (atomic_load(&cycles) - first <= count) {
        sched_yield();
    }
}

static void *enable_first(void *argument)
{
    const unsigned int rounds = *(const unsigned int *)argument;
    for (unsigned int i = 0; i < rounds; i++) {
        wait_for_turn(2 * i);
        for (unsigned int k = rand() % 4 == 0 ? 0U : (unsigned int)rand() % 2000U; k > 0; k--) {
            (void)atomic_load(&cycles); /* a random instant of the cycle */
        }
        epg_control_enable(&control, EPG_ENABLE_ANY);
        atomic_store(&turn, 2 * i + 1);
    }
    return NULL;
}

static void fail(const char *what, unsigned int round)
{
    printf("%s in round %u\n", what, round);
    exit(1);
}

int main(int argc, char **argv)
{
    unsigned int rounds = argc > 1 ? (unsigned int)atoi(argv[1]) : 1000U;
    pthread_t threads[2];
    epg_control_start(&control, &application);
    pthread_create(&threads[0], NULL, run_cycles, NULL);
    pthread_create(&threads[1], NULL, enable_first, &rounds);
    for (unsigned int i = 0; i < rounds; i++) {
        wait_for_turn(2 * i + 1);
        epg_stop(&control, EPG_STOP_PROGRAM);
        atomic_store(&forbidden, true);
        wait_cycles(5);
        if (atomic_load(&wrong) > 0U) {
            fail("a cycle after a stop drove the actuator", i);
        }
        const unsigned int before = atomic_load(&initialised);
        epg_stop(&control, EPG_STOP_PROGRAM);
        atomic_store(&forbidden, false);
        epg_control_enable(&control, EPG_ENABLE_ANY);
        wait_cycles(4);
        const unsigned int drives = atomic_load(&driven);
        wait_cycles(1);
        if (atomic_load(&driven) == drives || atomic_load(&initialised) == before) {
            fail("an enable after a stop did not act", i);
        }
        atomic_store(&turn, 2 * i + 2);
    }
    atomic_store(&end, true);
    pthread_join(threads[0], NULL);
    pthread_join(threads[1], NULL);
    printf("rounds %u\n", rounds);
    return 0;
}
