/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Interrupts of the user.  Part of the native simulator's runner: Zephyr's image knows nothing of signals.
 */
#define _POSIX_C_SOURCE 200809L

#include <signal.h>
#include <stddef.h>

void epg_native_sim_catch_interrupts(volatile int *flag);

static volatile int *interrupted;

static void on_interrupt(int number)
{
    (void)number;
    *interrupted = 1;
}

void epg_native_sim_catch_interrupts(volatile int *flag)
{
    /* Restarted: the simulator's threads wait for each other by semaphores, and do not expect less than that. */
    struct sigaction action = {.sa_handler = on_interrupt, .sa_flags = (int)(SA_RESETHAND | SA_RESTART)};
    interrupted = flag;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}
