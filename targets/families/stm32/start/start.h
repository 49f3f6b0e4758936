/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The parts of the start that differ between the series of STM32.
 */
#ifndef EPG_STM32_START_H
#define EPG_STM32_START_H

/** Makes all memories of the linker script usable.  Called first: it must use registers and the stack only. */
void epg_start_memories(void);

/**
 * Sets up the clocks for which the generator has computed the dividers.  If one of them does not start in time, the chip
 * stays on its internal clock, and the target then refuses to start: its check finds a wrong clock.
 */
void epg_start_clocks(void);

#endif
