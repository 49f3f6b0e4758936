/* Flash: erasing and programming it, and code in flash and in RAM. */
#include "cases.h"

#include <string.h>

#include "hardware/flash.h"
#include "pico/flash.h"
#include "pico/multicore.h"
#include "pico/stdlib.h"

#define OFFSET (PICO_FLASH_SIZE_BYTES - 2u * FLASH_SECTOR_SIZE)

static uint8_t page[FLASH_PAGE_SIZE];

static void __no_inline_not_in_flash_func(write_flash)(void *unused)
{
    (void)unused;
    flash_range_erase(OFFSET, FLASH_SECTOR_SIZE);
    flash_range_program(OFFSET, page, sizeof page);
}

static volatile uint32_t turns;

static void __not_in_flash_func(core_1_turns)(void)
{
    flash_safe_execute_core_init();
    for (;;) {
        turns++;
    }
}

/* Erases and programs while core 1 is locked out, then programs again without erasing: this can only clear bits. */
void case_flash(void)
{
    for (uint32_t n = 0; n < sizeof page; n++) {
        page[n] = (uint8_t)(n ^ 0x5au);
    }
    multicore_reset_core1();
    multicore_launch_core1(core_1_turns);
    busy_wait_us(100);
    const uint32_t before = turns;
    const uint32_t start = time_us_32();
    results[0] = (uint32_t)flash_safe_execute(write_flash, NULL, 1000);
    results[1] = time_us_32() - start;
    results[2] = turns - before;
    results[3] = (uint32_t)memcmp((const void *)(XIP_BASE + OFFSET), page, sizeof page);
    results[4] = *(const uint32_t *)(XIP_BASE + OFFSET + FLASH_PAGE_SIZE);
    if (arguments[0] != 0) { /* a read while the flash is being written is a fault */
        const uint32_t saved = save_and_disable_interrupts();
        *(volatile uint32_t *)(uintptr_t)0x18000008u = 0;
        results[5] = *(const volatile uint32_t *)(XIP_BASE + OFFSET);
        restore_interrupts(saved);
    }
    multicore_reset_core1();
}

/* The same sum from flash and from RAM; volatile, so that the compiler does not compute it in advance. */
void __attribute__((noinline)) case_from_flash(void)
{
    uint32_t sum = 0;
    for (uint32_t n = 0; n < 100; n++) {
        sum += n * n * arguments[0];
    }
    results[0] = sum;
}

void __no_inline_not_in_flash_func(case_from_ram)(void)
{
    uint32_t sum = 0;
    for (uint32_t n = 0; n < 100; n++) {
        sum += n * n * arguments[0];
    }
    results[0] = sum;
}
