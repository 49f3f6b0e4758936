/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32: starting, stopping and monitoring a target.
 *
 * **Control.**  The chip has one processor core.  The control cycle runs in the interrupt of a timer, the tick.  It has
 * the highest priority, 0.  All other interrupts of the program must have a lower one, 1 or more, so that none of them
 * can delay the tick.  A target does not start while an enabled interrupt has priority 0.
 *
 * **Communication.**  On bare metal it runs in an interrupt of the lowest priority, on FreeRTOS in a task.
 *
 * **Tick.**  A timer counts its clock, divided by a prescaler, from 0 to an upper limit and then begins again.  Each of
 * these updates raises the interrupt.  The counter repeats by itself, so a tick can be late but is never lost.
 *
 * **PWM outputs.**  A pin is high while the counter of its timer is below the channel's compare value.  The hardware
 * takes over a new value at the next update (preload).  The timers of the outputs start in step with the tick.
 *
 * **Encoders.**  A timer in encoder mode counts the edges of one encoder, with 16 or 32 bits.  16 bits are extended to
 * 32 at each reading.
 *
 * **USB.**  If the target's transport is `usb`, or if a console has no other transport, the chip is a USB device with one
 * or two serial ports (CDC ACM).  The hardware is OTG_FS, with the clock HSI48.
 *
 * **Time.**  TIM7 is the clock of EPG.  It counts microseconds and never stops.  Programs must not use it.
 *
 * **In a project of your own** (for example of STM32CubeMX), the program sets up the clocks, and EPG checks them at the
 * start.  It reads the registers of the clock tree, because a variable such as SystemCoreClock can be wrong.
 *
 * A program contains one target.  The generated `<name>_start()` and `<name>_stop()` call the functions below:
 *
 *     #include "jiwy.h"
 *     #include "epg/stm32.h"
 *
 *     if (!jiwy_start()) {
 *         epg_stm32_status_t status;
 *         epg_stm32_status(&status);
 *         if (status.error == EPG_STM32_ERROR_CLOCK) {
 *             const epg_mcu_clock_t *clock = epg_stm32_wrong_clock();
 *             printf("%s has %lu Hz\n", clock->name, (unsigned long)clock->found_hz);
 *         }
 *     }
 *
 * This header includes no header of ST, because generated code includes it.
 */
#ifndef EPG_STM32_H
#define EPG_STM32_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/mcu.h"
#include "epg/middleware.h"
#include "epg/target.h"
#include "epg/transport.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The number of a pin is 16 * port + pin: PA0 is 0, PD12 is 60.  Timers have ST's numbers: TIM4 is 4.  So have the
 * UARTs: USART3 is 3, UART4 is 4.
 */

/** A pin that a component drives. */
typedef struct epg_stm32_output {
    uint8_t pin;
    bool high; /**< safe level of the pin */
} epg_stm32_output_t;

/** A pin that a peripheral uses, with the number of its alternate function. */
typedef struct epg_stm32_function {
    uint8_t pin;
    uint8_t function; /**< 0 ... 15 */
} epg_stm32_function_t;

/** A clock of the chip, with the frequency in Hz for which the generator computed the dividers. */
typedef struct epg_stm32_clock {
    const char *name; /**< as in `clocks` of the `.tcf` */
    uint32_t hz;
} epg_stm32_clock_t;

/**
 * What the port layer must know of the target before it starts; generated.
 *
 * `instance` in the structures of `epg/port.h` counts from 0 in the order of the chip's data.  `timers` and `uarts`
 * map it to ST's number.
 */
typedef struct epg_stm32_hardware {
    size_t output_count;
    const epg_stm32_output_t *outputs; /**< made safe before main() and after each fault */
    size_t function_count;
    const epg_stm32_function_t *functions;
    size_t timer_count;
    const uint8_t *timers;
    size_t uart_count;
    const uint8_t *uarts;
    uint32_t other_streams; /**< streams of the DMA that other code uses: bit 0 is DMA1_Stream0, bit 8 DMA2_Stream0 */
} epg_stm32_hardware_t;

extern const epg_stm32_hardware_t epg_stm32_hardware;

/**
 * The timer that makes the tick.  One control period is `prescaler * (top + 1)` periods of its clock.
 *
 * Example: at 200 MHz, prescaler 4 and top 49999 give 4 * 50000 = 200000 clocks, which is a control period of 1 ms.
 */
typedef struct epg_stm32_tick {
    uint8_t timer;      /**< ST's number */
    uint32_t prescaler; /**< 1 ... 65536 */
    uint32_t top;       /**< largest value of the counter */
} epg_stm32_tick_t;

/** A target with its tick, its clocks and its transports; generated. */
typedef struct epg_stm32_target {
    const epg_target_t *target;
    size_t clock_count;
    const epg_stm32_clock_t *clocks; /**< those on which the target depends */
    epg_stm32_tick_t tick;
    const epg_transport_t *transport;         /**< of the target's middleware; NULL if it needs none */
    const char *transport_title;              /**< name of the transport for the user, for example "EPG ROS 2" */
    const epg_transport_t *console_transport; /**< of a console beside another middleware; NULL if there is none */
} epg_stm32_target_t;

/** The reason why epg_stm32_start() or epg_stm32_stop() failed. */
typedef epg_mcu_error_t epg_stm32_error_t;

#define EPG_STM32_OK EPG_MCU_OK
#define EPG_STM32_ERROR_RUNNING EPG_MCU_ERROR_RUNNING     /**< a target is running already */
#define EPG_STM32_ERROR_CLOCK EPG_MCU_ERROR_CLOCK         /**< a clock is wrong: epg_stm32_wrong_clock() */
#define EPG_STM32_ERROR_PLACEMENT EPG_MCU_ERROR_PLACEMENT /**< buffers are in memory that the DMA cannot reach */
#define EPG_STM32_ERROR_RESOURCE EPG_MCU_ERROR_RESOURCE   /**< a peripheral, DMA stream or interrupt is in use */
#define EPG_STM32_ERROR_CALLER EPG_MCU_ERROR_CALLER       /**< epg_stm32_stop() was called where it cannot wait */

/** Measurements of the port layer. */
typedef epg_mcu_status_t epg_stm32_status_t;

/** The transport `usb`: the first serial port of the USB device.  It is linked only if a target uses it. */
extern const epg_transport_t epg_usb;
/** The second serial port.  A device has it if the first port belongs to a middleware and the console uses USB, too. */
extern const epg_transport_t epg_usb_second;

/**
 * Starts the communication side and the control side.  Returns true when the tick's timer runs.  The outputs stay safe
 * until the target is enabled.
 *
 * Returns false, with all outputs safe, if the target cannot start; epg_stm32_status() then reports the reason.
 *
 * Must not be called in an interrupt.  On FreeRTOS it may be called before or after the scheduler starts.
 */
bool epg_stm32_start(const epg_stm32_target_t *target);

/**
 * Stops the communication side and the control side.  When this returns true, all outputs are safe, and
 * epg_stm32_start() may be called again.  Returns true, too, if no target is running.
 *
 * It waits for the end of the communication side's turn.  The communication side itself, an interrupt, and a FreeRTOS
 * task that has suspended the scheduler cannot wait for this: for them it returns false, and the target goes on.
 */
bool epg_stm32_stop(void);

/** Fills `status`.  It reads all stacks, which takes too long for an interrupt. */
void epg_stm32_status(epg_stm32_status_t *status);

/** The reason for EPG_STM32_ERROR_CLOCK.  Its name is NULL if the newest start has found no wrong clock. */
const epg_mcu_clock_t *epg_stm32_wrong_clock(void);

/**
 * The flags of the last reset, as they were at the start of the program: the register RCC_RSR, on STM32F7 RCC_CSR.  After a reset by the
 * watchdog EPG clears them in that register.
 */
uint32_t epg_stm32_reset_flags(void);

/**
 * Makes all outputs safe.  For fault handlers: it uses registers only.  Each pin becomes a plain output at its safe
 * level, and no longer follows its timer.
 */
void epg_stm32_safe_state(void);

#ifdef __cplusplus
}
#endif

#endif
