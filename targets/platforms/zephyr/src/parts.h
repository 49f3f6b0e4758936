/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What the parts of the port layer ask of each other.
 */
#ifndef EPG_ZEPHYR_PARTS_H
#define EPG_ZEPHYR_PARTS_H

#include "epg/ring.h"
#include "epg/zephyr.h"

/* port.c, inputs.c and outputs.c -------------------------------------------------------------------------------------- */

/** A device refused what it was asked for while peripherals were started. */
extern bool epg_zephyr_device_refused;

/** Whether all devices in epg_zephyr_hardware are there and started. */
bool epg_zephyr_devices_ready(void);

/** Whether a device is there and started; if not, the log says so. */
bool epg_zephyr_ready(const struct device *device);

/** Before the first output starts.  False: one has refused a write, and its component is given up until a reset. */
bool epg_zephyr_outputs_start(void);

/** Latches the fault of an output that has refused a write.  In each cycle, after requests to enable. */
void epg_zephyr_outputs_check(epg_control_t *control);

/** Whether a component is in no safe state: the watchdog is to reset the board. */
bool epg_zephyr_outputs_unsafe(void);

/** Whether all outputs are registers of the chip, so that writing them takes a few microseconds. */
bool epg_zephyr_outputs_are_registers(void);

/** The row of the table for a pin of the portable code; NULL: it has none. */
const epg_zephyr_pin_t *epg_zephyr_pin(uint8_t pin);

/**
 * Reads all inputs that can be read in an interrupt.  From the tick's, while the control thread waits for it: that uses
 * the same variables.
 */
void epg_zephyr_inputs_sample(void);

/** Whether the inputs of the cycle to come are those of the last epg_zephyr_inputs_sample().  Control thread. */
void epg_zephyr_inputs_use(bool of_tick);

/* tick_pico.c, tick_counter.c or tick_timer.c -------------------------------------------------------------------- */

/**
 * Starts the tick, which calls epg_zephyr_control_tick() from its interrupt every `period_ns`.  Returns EPG_ZEPHYR_OK,
 * or what is wrong.
 */
epg_zephyr_error_t epg_zephyr_tick_start(const epg_zephyr_tick_t *tick, uint64_t period_ns);
void epg_zephyr_tick_stop(void);

/**
 * When the newest tick was, in the time base of epg_port_time_ns(), and in `*now_ns` what the time is now: both read at
 * once.  Before the first tick, when the tick was started.
 */
uint64_t epg_zephyr_tick_newest_ns(uint64_t *now_ns);

/* control.c ------------------------------------------------------------------------------------------------------ */

/** `fault`: what ended the run before this one; it is latched. */
epg_zephyr_error_t epg_zephyr_control_start(const epg_zephyr_target_t *zephyr, epg_fault_t fault);
void epg_zephyr_control_stop(void);

/** Whether the control thread is the caller. */
bool epg_zephyr_control_calls(void);

/** A tick: from its interrupt. */
void epg_zephyr_control_tick(void);

/**
 * Runs no cycle until epg_zephyr_control_release(): ticks of this time are not missed.  Waits for the cycle at hand.
 * False when the target is enabled, or when the control thread does not answer.  From the communication thread.
 */
bool epg_zephyr_control_hold(void);
void epg_zephyr_control_release(void);

/** Bytes of the stack, and how many of them have ever been used; 0 where Zephyr does not count. */
void epg_zephyr_control_stack(uint32_t *size, uint32_t *used);

/* stack.c --------------------------------------------------------------------------------------------------------- */

/** Bytes that have ever been used of the stack of `thread`, `size` bytes large; 0 where Zephyr does not count. */
uint32_t epg_zephyr_stack_used(const struct k_thread *thread, size_t size);

/* communication.c ------------------------------------------------------------------------------------------------ */

/** Calls `serve` in a thread, at least once per millisecond. */
void epg_zephyr_communication_start(void (*serve)(void));
/** From any thread but that one. */
void epg_zephyr_communication_stop(void);

/** Whether the communication thread is the caller. */
bool epg_zephyr_communication_calls(void);

/** Asks for `serve` at once; from anywhere. */
void epg_zephyr_communication_wake(void);

void epg_zephyr_communication_stack(uint32_t *size, uint32_t *used);

/* fatal.c -------------------------------------------------------------------------------------------------------- */

/** What the previous run left behind: EPG_FAULT_NONE, EPG_FAULT_WATCHDOG or EPG_FAULT_PROCESSOR. */
epg_fault_t epg_zephyr_fault_before_reset(void);

/* watchdog.c ------------------------------------------------------------------------------------------------------ */

#ifdef CONFIG_EPG_WATCHDOG
epg_zephyr_error_t epg_zephyr_watchdog_start(uint64_t period_ns);
void epg_zephyr_watchdog_stop(void);
/** After a cycle in which `silence` is epg_control_silence().  Control thread. */
void epg_zephyr_watchdog_feed(uint32_t silence);
/** Gives more time, while flash is written.  Communication thread. */
void epg_zephyr_watchdog_relax(bool relaxed);
/** Whether the watchdog has caused the last reset; what tells that may be gone after the first call. */
bool epg_zephyr_watchdog_has_reset(void);
#else
static inline epg_zephyr_error_t epg_zephyr_watchdog_start(uint64_t period_ns)
{
    (void)period_ns;
    return EPG_ZEPHYR_OK;
}

static inline void epg_zephyr_watchdog_stop(void)
{
}

static inline void epg_zephyr_watchdog_feed(uint32_t silence)
{
    (void)silence;
}

static inline void epg_zephyr_watchdog_relax(bool relaxed)
{
    (void)relaxed;
}

static inline bool epg_zephyr_watchdog_has_reset(void)
{
    return false;
}
#endif

/* serial_lines.c --------------------------------------------------------------------------------------------------- */

/** Two rings, and the device of the UART API whose interrupt moves bytes between it and them. */
typedef struct epg_zephyr_lines {
    const struct device *device;
    epg_ring_t *received;
    epg_ring_t *sent;
    atomic_uint *damaged; /**< counts errors of what comes; NULL: there are none */
    bool back_pressure;   /**< a full ring makes the other end wait; false: what comes then is lost and counted */
    atomic_bool full;     /**< it waits */
} epg_zephyr_lines_t;

/** Starts with empty rings; false when the device has no interrupts.  `lines` must stay.  A second call starts anew. */
bool epg_zephyr_lines_start(epg_zephyr_lines_t *lines);

/** There is something in `lines->sent`: it is taken out and sent. */
void epg_zephyr_lines_send(const epg_zephyr_lines_t *lines);

/** There may be room in `lines->received` again. */
void epg_zephyr_lines_go_on(epg_zephyr_lines_t *lines);

/* native_sim: what is simulated around the control cycles ----------------------------------------------------------- */

#ifdef CONFIG_ARCH_POSIX
#include "epg/native_sim.h"
#else
static inline void epg_native_sim_starting(void)
{
}

static inline void epg_native_sim_started(void)
{
}

static inline void epg_native_sim_before_cycle(uint64_t tick_ns)
{
    (void)tick_ns;
}

static inline void epg_native_sim_after_cycle(void)
{
}
#endif

#endif
