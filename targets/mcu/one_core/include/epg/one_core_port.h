/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Those parts of `epg/family_port.h` that are the same for all chips with one Cortex-M3, M4 or M7 core.
 *
 * A family's `epg/family_port.h` includes this file after its device header, which includes Arm's `core_cm3.h`,
 * `core_cm4.h` or `core_cm7.h`.
 */
#ifndef EPG_ONE_CORE_PORT_H
#define EPG_ONE_CORE_PORT_H

#include <stdbool.h>

/** Bytes of the FPU's registers in a stack frame: Armv7-M ARM, B1.5.7. */
#if __FPU_PRESENT && __FPU_USED
#define EPG_FAMILY_FPU_FRAME 72
#else
#define EPG_FAMILY_FPU_FRAME 0
#endif

/**
 * Makes the outputs safe, remembers the fault over the next reset, ends control, and never returns.  A watchdog that
 * runs then resets the chip.  A debugger stops here, with the reason in `format`; NULL: no reason.
 */
void epg_one_core_panic(const char *format, ...) __attribute__((noreturn));

#define epg_family_panic epg_one_core_panic
#define epg_family_sleep __WFI

static inline bool epg_family_in_interrupt(void)
{
    return __get_IPSR() != 0U;
}

/*
 * Where the linker script has memory for the control cycle, a family defines these macros before it includes this file:
 * attributes of the functions and of the variables that every tick uses.
 */
#ifndef EPG_ONE_CORE_CODE
#define EPG_ONE_CORE_CODE
#endif
#ifndef EPG_ONE_CORE_DATA
#define EPG_ONE_CORE_DATA
#endif

#endif
