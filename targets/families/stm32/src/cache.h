/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The data cache, where the core has one and the program has enabled it (PM0253, 4.8).
 *
 * The functions work on whole lines of 32 bytes.  They do nothing to memory that is not cached.
 */
#ifndef EPG_STM32_CACHE_H
#define EPG_STM32_CACHE_H

#include <stddef.h>
#include <stdint.h>

#include "epg/stm32_device.h"

/** Writes changed lines from the cache to memory.  Also waits until all earlier writes have reached memory. */
static inline void epg_stm32_cache_clean(const void *address, size_t size)
{
#if defined(__DCACHE_PRESENT) && __DCACHE_PRESENT == 1U
    if ((SCB->CCR & SCB_CCR_DC_Msk) != 0U) {
        SCB_CleanDCache_by_Addr((void *)(uintptr_t)address, (int32_t)size);
    }
#else
    (void)address;
    (void)size;
#endif
    __DSB();
}

/**
 * Drops lines from the cache, so that the next reading finds what is in memory.  The lines must not have changes, and
 * no other data may share them.
 */
static inline void epg_stm32_cache_drop(void *address, size_t size)
{
#if defined(__DCACHE_PRESENT) && __DCACHE_PRESENT == 1U
    if ((SCB->CCR & SCB_CCR_DC_Msk) != 0U) {
        SCB_InvalidateDCache_by_Addr(address, (int32_t)size);
    }
#else
    (void)address;
    (void)size;
#endif
    __DSB();
}

#endif
