/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A copy of the vector table in RAM.
 *
 * The handlers of a program are often functions with fixed names in the user's files.  EPG defines none of these names.
 * It copies the table that the program uses, and replaces entries in the copy.  All others stay the user's.
 */
#include "epg/one_core.h"

#define VECTORS (16U + EPG_ONE_CORE_INTERRUPTS)

/** The alignment of a table: the next power of two of its size (Armv7-M ARM, B3.2.5). */
#define ALIGNMENT (VECTORS <= 32U ? 128U : VECTORS <= 64U ? 256U : VECTORS <= 128U ? 512U : 1024U)
_Static_assert(VECTORS <= 256U, "the alignment of the vector table");

static epg_one_core_handler_t vectors[VECTORS] EPG_ONE_CORE_DATA __attribute__((aligned(ALIGNMENT)));

/** The table of the program. */
static const epg_one_core_handler_t *original;

/** Makes changes of the table visible to the core's reads of vectors (B3.2.5, and Cortex-M7: caches). */
static void publish(void)
{
#if defined(__DCACHE_PRESENT) && __DCACHE_PRESENT
    SCB_CleanDCache_by_Addr((uint32_t *)(void *)vectors, (int32_t)sizeof vectors);
#endif
    __DSB();
    __ISB();
}

static void copy_table(void)
{
    if (SCB->VTOR == (uintptr_t)vectors) {
        return;
    }
    original = (const epg_one_core_handler_t *)(uintptr_t)SCB->VTOR;
    for (size_t i = 0; i < VECTORS; i++) {
        vectors[i] = original[i];
    }
    publish();
    SCB->VTOR = (uintptr_t)vectors;
    publish();
}

epg_one_core_handler_t epg_one_core_set_handler(IRQn_Type interrupt, epg_one_core_handler_t handler)
{
    copy_table();
    epg_one_core_handler_t *entry = &vectors[16 + (int32_t)interrupt];
    const epg_one_core_handler_t before = *entry;
    *entry = handler;
    publish();
    return before;
}

void epg_one_core_enable(IRQn_Type interrupt, epg_one_core_handler_t handler)
{
    NVIC_DisableIRQ(interrupt);
    (void)epg_one_core_set_handler(interrupt, handler);
    NVIC_SetPriority(interrupt, epg_one_core_transport_priority);
    NVIC_EnableIRQ(interrupt);
}

void epg_one_core_disable(IRQn_Type interrupt)
{
    NVIC_DisableIRQ(interrupt);
    __DSB();
    __ISB();
    if (original != NULL) {
        (void)epg_one_core_set_handler(interrupt, original[16 + (int32_t)interrupt]);
    }
}
