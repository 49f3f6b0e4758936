/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions that the files of the port layer for STM32 call in each other, besides those of `epg/family.h`,
 * `epg/one_core.h` and `epg/port.h`.
 *
 * The files here cite the reference manual RM0433 of the STM32H743, revision 8; RM0410 of the STM32F767 has the same
 * registers.
 * The folders f7 and h7 have the parts that differ, and cite the manual of their series.
 */
#ifndef EPG_STM32_PARTS_H
#define EPG_STM32_PARTS_H

#include <stdatomic.h>

#include "epg/family.h"
#include "epg/one_core.h"
#include "epg/port.h"
#include "epg/stm32.h"
#include "epg/stm32_device.h"

/**
 * Places a function, a variable or a table of the control cycle in tightly coupled memory (ITCM, DTCM), if the linker
 * script has the section, as EPG's own does.  Other linker scripts treat it as any other function, variable or constant.
 */
#define EPG_STM32_CYCLE(name) EPG_ONE_CORE_CODE name
#define EPG_STM32_CYCLE_DATA EPG_ONE_CORE_DATA
#define EPG_STM32_CYCLE_TABLE __attribute__((section(".rodata.epg_cycle")))

/**
 * Places a buffer of the DMA.  EPG's linker script puts the section in SRAM1 or SRAM2; DMA1 and DMA2 cannot reach TCM.
 * Other linker scripts put it in .bss, so it is never in the heap's memory; epg_stm32_dma_reaches() checks the place.
 */
#define EPG_STM32_DMA __attribute__((section(".bss.epg_dma"), aligned(32)))

/* stm32.c ------------------------------------------------------------------------------------------------------ */

/** Set to true while peripherals are started, if other code uses one of them. */
extern bool epg_stm32_resource_taken;

/**
 * Keeps all interrupts but the tick out until epg_stm32_leave().  For registers that the user's interrupts also change.
 */
uint32_t epg_stm32_enter(void);
void epg_stm32_leave(uint32_t before);

typedef struct epg_stm32_timer epg_stm32_timer_t;

/** Switches the clock of a timer on. */
void epg_stm32_enable_timer(const epg_stm32_timer_t *timer);

/* port.c: pins -------------------------------------------------------------------------------------------------- */

/** The registers of the port of `pin`. */
GPIO_TypeDef *epg_stm32_port(uint8_t pin);

/** Connects `pin` to the peripheral that the generated table has for it, with the pull resistor `pull`. */
void epg_stm32_connect(uint8_t pin, epg_port_pull_t pull);

/** Connects `pin` to the peripheral with the alternate function `function`, 0 ... 15, with the pull resistor `pull`. */
void epg_stm32_connect_function(uint8_t pin, uint32_t function, epg_port_pull_t pull);

/* pwm.c -------------------------------------------------------------------------------------------------------- */

/**
 * The timers that drive outputs, one bit per number of ST.  They start in step with the tick: tick.c.
 */
extern uint32_t epg_stm32_output_timers;

/** Stops the timers of all outputs.  Their pins must be plain outputs already. */
void epg_stm32_pwm_stop_all(void);

/* quadrature.c ------------------------------------------------------------------------------------------------- */

/** Stops all decoders. */
void epg_stm32_quadrature_stop_all(void);

/* time.c ------------------------------------------------------------------------------------------------------- */

/** Starts TIM7, if it does not run.  Returns false if other code uses it. */
bool epg_stm32_time_start(void);

/* f7, h7: what differs between the series of STM32 ------------------------------------------------------------- */

/** A timer. */
struct epg_stm32_timer {
    TIM_TypeDef *registers;
    volatile uint32_t *enable; /**< register of the RCC that switches its clock on */
    uint32_t enable_bit;
    volatile uint32_t *freeze; /**< register of DBGMCU that stops it while a debugger has stopped the core */
    uint32_t freeze_bit;
    IRQn_Type interrupt;
    uint8_t masters[4]; /**< the timers that are its ITR0 ... ITR3; 0: none */
    bool on_apb2;
    bool has_32_bits;
    bool has_break;  /**< its outputs need MOE in BDTR */
    bool is_trigger; /**< it can be a slave of other timers */
};

/** A timer by ST's number; NULL if the chip does not have it. */
const epg_stm32_timer_t *epg_stm32_timer(uint32_t number);

/** Switches the clock of a port on; 0 is port A. */
void epg_stm32_enable_port(uint32_t port);

/**
 * The frequency of a clock in Hz, decoded from the registers of the clock tree.  The names are those of `clocks` in the
 * data of the chip.  0 if there is no such clock, or if its source cannot be known.
 */
uint32_t epg_stm32_clock_hz(const char *name);

/** Switches the clock on that RNG measures its noise with, or off if it was off before.  Within epg_stm32_enter(). */
void epg_stm32_random_clock(bool on);

/**
 * NULL if the chip and its voltage permit the frequency that the core has; else the reason, for example that the
 * silicon is older than revision V, and in `limit_hz` the frequency that is permitted.
 */
const char *epg_stm32_core_limit(uint32_t *limit_hz);

#endif
