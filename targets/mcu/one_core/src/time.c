/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The board time.
 *
 * The family's clock never stops, but may count microseconds only.  Within a control cycle, the counter of the tick's
 * timer shows the time since the tick much more exactly.
 */
#include "epg/port.h"

#include "control.h"

/** Reads of a clock that stands still after which a wait for it ends: the wait is in an interrupt. */
#define READS_OF_A_DEAD_CLOCK 100000U

epg_one_core_cycle_t epg_one_core_cycle EPG_ONE_CORE_DATA;

uint64_t EPG_ONE_CORE_CODE epg_port_time_ns(void)
{
    const epg_one_core_cycle_t *cycle = &epg_one_core_cycle;
    if (!cycle->runs) {
        return epg_one_core_time_ns();
    }
    const uint32_t since_ns = epg_one_core_tick_ns(cycle->target);
    /* In a cycle that is longer than its period, the resolution of the clock is enough. */
    return since_ns == EPG_ONE_CORE_TICK_PASSED ? epg_one_core_time_ns() : cycle->ticks.due_ns + since_ns;
}

void EPG_ONE_CORE_CODE epg_port_wait_until(uint64_t time_ns)
{
    uint64_t last_ns = epg_port_time_ns();
    uint32_t reads = 0;
    while (last_ns < time_ns && reads < READS_OF_A_DEAD_CLOCK) {
        const uint64_t now_ns = epg_port_time_ns();
        reads = now_ns == last_ns ? reads + 1U : 0U;
        last_ns = now_ns;
    }
}
