/* The time of reads from flash, SRAM and devices.  The code that measures is in SRAM. */
#include "cases.h"

#include "hardware/structs/busctrl.h"
#include "hardware/structs/systick.h"
#include "hardware/structs/timer.h"
#include "hardware/structs/xip_ctrl.h"
#include "hardware/sync.h"
#include "pico/multicore.h"
#include "pico/stdlib.h"

#define READS 8u
#define TURNS 1000u
#define LONGEST 0xffffffu

static void start_systick(void)
{
    systick_hw->rvr = LONGEST;
    systick_hw->cvr = 0;
    systick_hw->csr = 5; /* enabled, at the frequency of the processor */
}

static uint32_t __attribute__((noinline)) __scratch_y("memory") time_of_read(const volatile uint32_t *word)
{
    const uint32_t start = systick_hw->cvr;
    (void)*word;
    return (start - systick_hw->cvr) & LONGEST;
}

/* The cycles of reads of the words at the addresses in the arguments, after a flush of the cache; then its counters. */
static void __no_inline_not_in_flash_func(read_all)(void)
{
    xip_ctrl_hw->flush = 1;
    (void)xip_ctrl_hw->flush;
    xip_ctrl_hw->ctr_acc = 0;
    xip_ctrl_hw->ctr_hit = 0;
    for (uint32_t n = 0; n < READS; n++) {
        results[n] = time_of_read((const volatile uint32_t *)(uintptr_t)arguments[n]);
    }
    results[READS] = xip_ctrl_hw->ctr_acc;
    results[READS + 1u] = xip_ctrl_hw->ctr_hit;
}

void case_read_times(void)
{
    start_systick();
    const uint32_t saved = save_and_disable_interrupts();
    read_all();
    restore_interrupts(saved);
}

static volatile uint32_t words[4] __attribute__((aligned(16))); /* one in each bank */
static const volatile uint32_t *volatile read_by_core_1;

static void __scratch_x("memory") core_1_reads(void)
{
    const volatile uint32_t *const word = read_by_core_1;
    for (;;) {
        (void)*word;
        (void)*word;
        (void)*word;
    }
}

static uint32_t __attribute__((noinline)) __scratch_y("memory") time_of_reads(const volatile uint32_t *word)
{
    const uint32_t start = systick_hw->cvr;
    for (uint32_t n = 0; n < TURNS; n++) {
        (void)*word;
    }
    return (start - systick_hw->cvr) & LONGEST;
}

/* The cycles of 1000 reads of core 0: alone; beside reads of core 1 in another bank, in the same bank; of a timer
 * beside core 1; and in the same bank again, with a higher priority than core 1. */
void case_contention(void)
{
    start_systick();
    const uint32_t saved = save_and_disable_interrupts();
    multicore_reset_core1();
    (void)time_of_reads(&words[0]); /* now the cache has all that it reads from flash */
    results[0] = time_of_reads(&words[0]);
    results[1] = time_of_reads(&timer_hw->timerawl);
    const volatile uint32_t *const by_core_1[] = {&words[1], &words[0], &timer_hw->timerawl};
    for (uint32_t n = 0; n < 3u; n++) {
        read_by_core_1 = by_core_1[n];
        multicore_reset_core1();
        multicore_launch_core1(core_1_reads);
        busy_wait_us(20);
        results[2u + n] = time_of_reads(n < 2u ? &words[0] : &timer_hw->timerawl);
    }
    busctrl_hw->priority = BUSCTRL_BUS_PRIORITY_PROC0_BITS;
    read_by_core_1 = &words[0];
    multicore_reset_core1();
    multicore_launch_core1(core_1_reads);
    busy_wait_us(20);
    results[5] = time_of_reads(&words[0]);
    busctrl_hw->priority = 0;
    multicore_reset_core1();
    restore_interrupts(saved);
}
