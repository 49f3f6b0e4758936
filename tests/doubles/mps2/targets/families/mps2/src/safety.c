/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The watchdog, and what is known after a reset.
 */
#include "epg/one_core.h"
#include "parts.h"

#define FAULT 0xEF4A17EDU
#define GUARDED 0x6A2D3D01U

/* Survive a reset. */
static NOT_CLEARED volatile uint32_t remembered; /* FAULT: the processor has had a fault */
static NOT_CLEARED volatile uint32_t guarded;    /* GUARDED: the watchdog runs */

void epg_one_core_remember_fault(void)
{
    remembered = FAULT;
}

epg_fault_t epg_family_fault_before_reset(void)
{
    const epg_fault_t fault = remembered == FAULT  ? EPG_FAULT_PROCESSOR
                              : guarded == GUARDED ? EPG_FAULT_WATCHDOG
                                                   : EPG_FAULT_NONE;
    remembered = 0U;
    guarded = 0U;
    return fault;
}

void epg_one_core_watchdog_start(uint32_t timeout_ms)
{
    WATCHDOG_LOCK = 0x1ACCE551U;
    WATCHDOG->load = timeout_ms * (MPS2_HZ / 1000U) / 2U; /* the second time resets */
    WATCHDOG->control = 3U;
    guarded = GUARDED;
}

void epg_one_core_watchdog_feed(void)
{
    WATCHDOG->clear = 1U;
}

void epg_one_core_watchdog_stop(void)
{
    WATCHDOG->control = 0U;
    WATCHDOG->load = UINT32_MAX; /* QEMU counts on: 171 s until a request */
    guarded = 0U;
}

const IRQn_Type epg_one_core_spare_interrupts[] = {SPARE0_IRQn, SPARE1_IRQn, (IRQn_Type)-1};

const char *epg_one_core_interrupt_name(int32_t interrupt)
{
    return interrupt == FREE_IRQn ? "FREE" : interrupt == TIMER1_IRQn ? "TIMER1" : NULL;
}
