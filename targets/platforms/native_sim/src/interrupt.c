/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Ctrl-C, SIGTERM, and the end of the terminal (SIGHUP).  A part of the native simulator, the program around the image: Zephyr has no signals of Linux.
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
    /* SA_RESTART: the simulator's threads wait for each other by semaphores, and do not handle an interrupted wait. */
    struct sigaction action = {.sa_handler = on_interrupt, .sa_flags = (int)(SA_RESETHAND | SA_RESTART)};
    interrupted = flag;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    /* The system and the shell each send a SIGHUP, so this handler must stay.  `nohup` has it ignored. */
    struct sigaction hangup;
    if (sigaction(SIGHUP, NULL, &hangup) == 0 && hangup.sa_handler != SIG_IGN) {
        action.sa_flags = SA_RESTART;
        sigaction(SIGHUP, &action, NULL);
    }
}
