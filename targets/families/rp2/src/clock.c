/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Time: the chip's microsecond timer, refined within a control cycle by core 1's SysTick.
 *
 * Both cores read the same microsecond timer.  It does not depend on the PWM slice that makes the tick.  Its
 * microseconds are derived from the same crystal as clk_sys, so timer and tick never drift apart.
 *
 * One microsecond is too coarse within a control cycle.  There, the time is the time at the begin of the cycle plus the
 * clocks of clk_sys since then.  SysTick counts these clocks: a 24-bit counter in each core.  No other code uses core
 * 1's.
 */
#include "epg/port.h"

#include "parts.h"

/** SysTick counts 24 bits down. */
#define SYSTICK_BITS 0xFFFFFFU
/** Control and status register, Armv6-M ARM B3.3.3: processor clock, no interrupt, enabled. */
#define SYSTICK_FREE_RUNNING 0x5U

static struct {
    uint64_t begin_ns;
    uint32_t begin_us;      /* low 32 bits of the microsecond timer */
    uint32_t begin_systick; /* SysTick counts down */
    uint32_t range_us;      /* half of the time in which SysTick wraps: no count is ambiguous */
    uint32_t ns_per_clock;  /* times 2^24 */
    bool in_cycle;
} cycle;

uint64_t __not_in_flash_func(epg_pico_timer_us)(void)
{
    /* The raw registers: the latched ones (timelr, timehr) have one latch for both cores.  The low word wraps every
     * 71 minutes.  If the high word has changed between its two readings, the low word is read again after the wrap. */
    uint32_t high = timer_hw->timerawh;
    uint32_t low = timer_hw->timerawl;
    const uint32_t again = timer_hw->timerawh;
    if (again != high) {
        high = again;
        low = timer_hw->timerawl;
    }
    return (uint64_t)high << 32 | low;
}

void epg_pico_cycle_clock_start(uint32_t clock)
{
    cycle.in_cycle = false;
    cycle.range_us = (SYSTICK_BITS / 2U) / (clock / 1000000U);
    cycle.ns_per_clock = (uint32_t)(((1000000000ULL << 24) + clock / 2U) / clock);
    systick_hw->csr = 0;
    systick_hw->rvr = SYSTICK_BITS;
    systick_hw->cvr = 0;
    systick_hw->csr = SYSTICK_FREE_RUNNING;
}

uint32_t __not_in_flash_func(epg_pico_clocks_to_ns)(uint32_t clocks)
{
    return (uint32_t)((uint64_t)clocks * cycle.ns_per_clock >> 24);
}

void __not_in_flash_func(epg_pico_cycle_clock_begin)(uint64_t now_ns)
{
    cycle.begin_systick = systick_hw->cvr;
    cycle.begin_us = timer_hw->timerawl;
    cycle.begin_ns = now_ns;
    cycle.in_cycle = true;
}

void __not_in_flash_func(epg_pico_cycle_clock_end)(void)
{
    cycle.in_cycle = false;
}

uint64_t __not_in_flash_func(epg_port_time_ns)(void)
{
    if (!cycle.in_cycle || sio_hw->cpuid == 0U) {
        return epg_pico_timer_us() * 1000U;
    }
    const uint32_t passed_us = timer_hw->timerawl - cycle.begin_us;
    if (passed_us >= cycle.range_us) {
        return cycle.begin_ns + (uint64_t)passed_us * 1000U;
    }
    return cycle.begin_ns + epg_pico_clocks_to_ns((cycle.begin_systick - systick_hw->cvr) & SYSTICK_BITS);
}

void __not_in_flash_func(epg_port_wait_until)(uint64_t time_ns)
{
    /* A busy wait: core 1 has nothing else to do. */
    while (epg_port_time_ns() < time_ns) {
        tight_loop_contents();
    }
}
