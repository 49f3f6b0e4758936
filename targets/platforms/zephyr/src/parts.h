/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions that the files of Zephyr's port layer call in each other.
 */
#ifndef EPG_ZEPHYR_PARTS_H
#define EPG_ZEPHYR_PARTS_H

#include "epg/ring.h"
#include "epg/zephyr.h"

/*
 * port.c, inputs.c and outputs.c --------------------------------------------------------------------------------------
 */

/** Set to true while peripherals are started, if a driver returns an error or a device is missing. */
extern bool epg_zephyr_device_refused;

/** True if all devices in epg_zephyr_hardware are ready. */
bool epg_zephyr_devices_ready(void);

/** True if a device exists and its driver has started it.  If not, a message is written to the log. */
bool epg_zephyr_ready(const struct device *device);

/**
 * Must be called before the first output starts.  Returns false if an output has refused a write since the last reset.
 * Its component must not be used until the next reset.
 */
bool epg_zephyr_outputs_start(void);

/** Latches EPG_FAULT_OUTPUT if an output has refused a write.  Called in each cycle, after requests to enable. */
void epg_zephyr_outputs_check(epg_control_t *control);

/** True if a component could not be brought into a safe state.  The watchdog must then reset the board. */
bool epg_zephyr_outputs_unsafe(void);

/** True if all outputs are registers of the chip.  Writing them then takes a few microseconds and never waits. */
bool epg_zephyr_outputs_are_registers(void);

/** The row of the table of pins for a pin number of the portable code.  NULL if there is none. */
const epg_zephyr_pin_t *epg_zephyr_pin(uint8_t pin);

/**
 * Reads all inputs that can be read in an interrupt.  Called by the tick's interrupt, only while the control thread
 * waits for the tick, because both use the same variables.
 */
void epg_zephyr_inputs_sample(void);

/**
 * Chooses the inputs of the next cycle: true for those of the last epg_zephyr_inputs_sample(), false to read them anew.
 * Called by the control thread.
 */
void epg_zephyr_inputs_use(bool of_tick);

/* tick_pico.c, tick_counter.c or tick_timer.c -------------------------------------------------------------------- */

/**
 * Starts the tick: its interrupt calls epg_zephyr_control_tick() every `period_ns`.  Returns EPG_ZEPHYR_OK or an error.
 */
epg_zephyr_error_t epg_zephyr_tick_start(const epg_zephyr_tick_t *tick, uint64_t period_ns);
void epg_zephyr_tick_stop(void);

/**
 * Returns the time of the newest tick, and sets `*now_ns` to the present time.  Both are times of epg_port_time_ns(),
 * read at the same instant.  Before the first tick, returns the time at which the tick was started.
 */
uint64_t epg_zephyr_tick_newest_ns(uint64_t *now_ns);

/* start.c -------------------------------------------------------------------------------------------------------- */

/**
 * True if a clock has the frequency, in Hz, for which the generator computed its divisions.  If not, a message with
 * `name` and both frequencies is written to the log.
 */
bool epg_zephyr_check_clock(const char *name, uint32_t expected_hz, uint32_t found_hz);

/* control.c ------------------------------------------------------------------------------------------------------ */

/** Starts the control thread.  `fault`, the fault that ended the run before the last reset, is latched. */
epg_zephyr_error_t epg_zephyr_control_start(const epg_zephyr_target_t *zephyr, epg_fault_t fault);
/** Stops the control thread after its present cycle, with the outputs safe, and then the tick and the watchdog. */
void epg_zephyr_control_stop(void);

/** True if the caller is the control thread. */
bool epg_zephyr_control_calls(void);

/** A tick.  Called by the tick's interrupt. */
void epg_zephyr_control_tick(void);

/**
 * Holds the control loop: waits for the end of the present cycle, and runs no cycle until epg_zephyr_control_release().
 * Ticks during a hold do not count as missed.  Must be called from the communication thread.
 *
 * Returns false if the target is enabled, or if the control thread does not answer.
 */
bool epg_zephyr_control_hold(void);
/** Ends a hold. */
void epg_zephyr_control_release(void);

/** Reports the bytes of the stack, and the largest number in use so far; 0 if Zephyr does not measure it. */
void epg_zephyr_control_stack(uint32_t *size, uint32_t *used);

/* stack.c --------------------------------------------------------------------------------------------------------- */

/**
 * The largest number of bytes in use so far of the stack of `thread`, which has `size` bytes.  0 if Zephyr does not
 * measure it.
 */
uint32_t epg_zephyr_stack_used(const struct k_thread *thread, size_t size);

/* communication.c ------------------------------------------------------------------------------------------------ */

/** Starts the communication thread, which calls `serve` at least once per millisecond. */
void epg_zephyr_communication_start(void (*serve)(void));
/** Stops the communication thread and waits for its end.  Must not be called from that thread. */
void epg_zephyr_communication_stop(void);

/** True if the caller is the communication thread. */
bool epg_zephyr_communication_calls(void);

/** Makes the communication thread call `serve` as soon as possible.  May be called from every context. */
void epg_zephyr_communication_wake(void);

/** Reports the bytes of the stack, and the largest number in use so far; 0 if Zephyr does not measure it. */
void epg_zephyr_communication_stack(uint32_t *size, uint32_t *used);

/* fatal.c -------------------------------------------------------------------------------------------------------- */

/** The fault that caused the last reset: EPG_FAULT_NONE, EPG_FAULT_WATCHDOG or EPG_FAULT_PROCESSOR. */
epg_fault_t epg_zephyr_fault_before_reset(void);

/* watchdog.c ------------------------------------------------------------------------------------------------------ */

#ifdef CONFIG_EPG_WATCHDOG
/** Starts the watchdog.  Its timeout is at least four control periods of `period_ns`. */
epg_zephyr_error_t epg_zephyr_watchdog_start(uint64_t period_ns);
/** Stops the watchdog, except if outputs are not safe: then it must reset the board. */
void epg_zephyr_watchdog_stop(void);
/**
 * Feeds the watchdog after a cycle, unless the communication side is stuck.  `silence` is the result of
 * epg_control_silence().  Called by the control thread.
 */
void epg_zephyr_watchdog_feed(uint32_t silence);
/** True: sets a longer timeout, while flash is written.  False: restores it.  Called by the communication thread. */
void epg_zephyr_watchdog_relax(bool relaxed);
/** True if the watchdog caused the last reset.  Must be called once only: it may clear the recorded cause. */
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

/**
 * A device of the UART API, and two rings of bytes.  The device's interrupt moves bytes between the device and the
 * rings.
 */
typedef struct epg_zephyr_lines {
    const struct device *device;
    epg_ring_t *received;
    epg_ring_t *sent;
    atomic_uint *damaged; /**< counts errors of received bytes; NULL if the device cannot have such errors */
    bool back_pressure;   /**< true: a full ring makes the sender wait.  false: bytes are then lost and counted */
    atomic_bool full;     /**< receiving is stopped, because the ring is full */
} epg_zephyr_lines_t;

/**
 * Starts, or starts again, with empty rings.  `lines` must stay valid.  Returns false if the device has no interrupts.
 */
bool epg_zephyr_lines_start(epg_zephyr_lines_t *lines);

/** Sends the bytes in `lines->sent`.  Called after bytes were put into it. */
void epg_zephyr_lines_send(const epg_zephyr_lines_t *lines);

/**
 * Starts to receive again, if it was stopped and `lines->received` has room.  Called after bytes were taken from it.
 */
void epg_zephyr_lines_go_on(epg_zephyr_lines_t *lines);

/*
 * native_sim: the simulation around the control cycles --------------------------------------------------------------
 */

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
