/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The communication thread.  It runs every millisecond, and at once after a transport's interrupt.
 *
 * Threads of higher priority run first.  If they make it wait too long, the watchdog is no longer fed.
 */
#include <zephyr/kernel.h>

#include "parts.h"

BUILD_ASSERT(CONFIG_EPG_COMMUNICATION_PRIORITY < CONFIG_NUM_PREEMPT_PRIORITIES,
             "CONFIG_EPG_COMMUNICATION_PRIORITY must be less than the number of preemptible priorities");

#ifdef CONFIG_FPU_SHARING
#define THREAD_OPTIONS K_FP_REGS
#else
#define THREAD_OPTIONS 0
#endif

/*
 * The kernel counts a timeout from the next tick of the system clock, so it takes up to one tick longer.  One tick less
 * gives at most a millisecond.
 */
#define TICKS_PER_MS (CONFIG_SYS_CLOCK_TICKS_PER_SEC / 1000)
#define PERIOD K_TICKS(MAX(TICKS_PER_MS - 1, 1))

static K_THREAD_STACK_DEFINE(stack, CONFIG_EPG_COMMUNICATION_STACK_SIZE);
static struct k_thread thread;
static K_SEM_DEFINE(work, 0, 1);
static atomic_bool stopping;
static bool running;

void epg_zephyr_communication_wake(void)
{
    k_sem_give(&work);
}

static void run(void *first, void *second, void *third)
{
    void (*const serve)(void) = *(void (**)(void))first;
    ARG_UNUSED(second);
    ARG_UNUSED(third);
    while (!atomic_load(&stopping)) {
        serve();
        (void)k_sem_take(&work, PERIOD);
    }
}

void epg_zephyr_communication_start(void (*serve)(void))
{
    static void (*argument)(void);
    argument = serve;
    atomic_store(&stopping, false);
    (void)k_thread_create(&thread, stack, K_THREAD_STACK_SIZEOF(stack), run, &argument, NULL, NULL,
                          K_PRIO_PREEMPT(CONFIG_EPG_COMMUNICATION_PRIORITY), THREAD_OPTIONS, K_NO_WAIT);
    (void)k_thread_name_set(&thread, "epg_communication");
    running = true;
}

bool epg_zephyr_communication_calls(void)
{
    return running && k_current_get() == &thread;
}

void epg_zephyr_communication_stop(void)
{
    if (running) {
        atomic_store(&stopping, true);
        epg_zephyr_communication_wake();
        (void)k_thread_join(&thread, K_FOREVER); /* this ends soon: no middleware waits */
        running = false;
    }
}

void epg_zephyr_communication_stack(uint32_t *size, uint32_t *used)
{
    *size = CONFIG_EPG_COMMUNICATION_STACK_SIZE;
    *used = running ? epg_zephyr_stack_used(&thread, CONFIG_EPG_COMMUNICATION_STACK_SIZE) : 0U;
}
