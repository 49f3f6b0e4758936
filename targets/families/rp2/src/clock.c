/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Time: the chip's microsecond timer, refined within a control cycle by core 1's SysTick.
 *
 * The timer is the same for both cores and independent of the PWM that makes the tick; its microseconds come from the
 * crystal, as clk_sys does, so the two never drift apart.  Within a cycle one microsecond is coarse: there time is that
 * of the tick plus clocks counted by the SysTick of core 1, which nobody else uses.
 */
#include "epg/port.h"

#include "parts.h"

/** SysTick counts 24 bits down. */
#define SYSTICK_BITS 0xFFFFFFU
/** Control and status register, Armv6-M ARM B3.3.3: processor clock, no interrupt, enabled. */
#define SYSTICK_FREE_RUNNING 0x5U

static struct {
    uint64_t begin_ns;
    uint32_t begin_us;      /* of the microsecond timer, low word */
    uint32_t begin_systick; /* it counts down */
    uint32_t range_us;      /* SysTick is unambiguous for longer than this */
    uint32_t ns_per_clock;  /* times 2^24 */
    bool in_cycle;
} cycle;

uint64_t __not_in_flash_func(epg_pico_timer_us)(void)
{
    /* Not the latched registers, which both cores would fight for.  The low word wraps every 71 minutes: if it did
     * between two readings of the high word, a second reading is from after that. */
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
    /* Core 1 has nothing else to do; time passes, so this ends. */
    while (epg_port_time_ns() < time_ns) {
        tight_loop_contents();
    }
}
