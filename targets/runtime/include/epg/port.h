/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The port layer: the functions by which EPG's portable code uses the hardware.
 *
 * Each platform implements these functions once, in `targets/platforms/<name>` or, for its registers, in
 * `targets/families/<name>`.  The portable code (runtime, component drivers, generated tables, model) includes no
 * header of an SDK.  It can therefore be compiled into a static library before the SDK's settings are known.
 *
 * All functions are called from the control side unless their comment names another context.  The generator has already
 * checked pins, peripherals and ranges.  A function must therefore not fail, and it must not allocate memory or block.
 * Only epg_port_wait_until() waits, and only epg_port_store_write() may fail and block.
 *
 * Peripherals are described by constant structures, which the generator fills.  In them, `instance` is the number of
 * the hardware unit (a PIO block, a PWM slice, a timer), and `slot` is the number of the part of that unit that is used
 * (a state machine, a channel).  Pins have the numbers that the description of the SoC gives them.
 */
#ifndef EPG_PORT_H
#define EPG_PORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Returns the board time: monotonic, in nanoseconds.  May be called from every context. */
uint64_t epg_port_time_ns(void);

/**
 * Waits until epg_port_time_ns() has reached `time_ns`.  Called within a control cycle; `time_ns` is less than one
 * control period ahead.  In simulated time it returns at once, because outputs act at the instant of their tick there.
 */
void epg_port_wait_until(uint64_t time_ns);

/**
 * A quadrature decoder: hardware that counts the edges of an incremental encoder.
 *
 * The encoder has two outputs, A and B.  Both are square waves, a quarter of a period apart.  The order of their edges
 * is the direction of the movement.  The decoder counts every edge of both signals, which is four counts per period of
 * A (x4 decoding).
 */
typedef struct epg_port_quadrature {
    uint8_t pin_a;
    uint8_t pin_b;
    uint8_t instance;
    uint8_t slot;
    bool pull_up; /**< enables the pull-up resistors of both pins */
} epg_port_quadrature_t;

/** Configures the pins and starts counting. */
void epg_port_quadrature_start(const epg_port_quadrature_t *decoder);

/**
 * Returns the free-running count of edges (x4), modulo 2^32.  A wrap is not reported.  The caller takes signed
 * differences between two calls, so it must call this at least once per control cycle.
 */
uint32_t epg_port_quadrature_count(const epg_port_quadrature_t *decoder);

/**
 * Returns false if the decoder has stopped and its count is therefore meaningless: for example, a state machine has
 * left its program, or a timer has lost its clock.  Called once per control cycle.  A port whose decoders cannot stop
 * always returns true.
 */
bool epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder);

/**
 * A PWM output: a pin that is high for an adjustable share of each period.
 *
 * A prescaler divides the clock of the peripheral.  A counter counts the divided clock from 0 to `top` and then starts
 * the next period, so a period lasts `prescaler * (top + 1)` clocks of the peripheral.
 */
typedef struct epg_port_pwm {
    uint8_t pin;
    uint8_t instance;
    uint8_t slot;
    uint16_t prescaler;
    uint16_t top;
} epg_port_pwm_t;

/** Configures the pin and starts the PWM with level 0 (always low). */
void epg_port_pwm_start(const epg_port_pwm_t *pwm);

/**
 * Sets the high time in clocks after the prescaler, from 0 (always low) to `top + 1` (always high).  It takes effect at
 * the next PWM period.
 */
void epg_port_pwm_write(const epg_port_pwm_t *pwm, uint32_t level);

/** The pull resistor of an input.  It sets the level of the pin while no circuit drives it. */
typedef enum epg_port_pull { EPG_PULL_NONE, EPG_PULL_UP, EPG_PULL_DOWN } epg_port_pull_t;

/** Makes `pin` an output.  Its first level is `level` (true: high). */
void epg_port_output_start(uint8_t pin, bool level);

/** Sets the level of an output (true: high). */
void epg_port_output_write(uint8_t pin, bool level);

/** Makes `pin` an input with the pull resistor `pull`. */
void epg_port_input_start(uint8_t pin, epg_port_pull_t pull);

/** Returns the present level of an input (true: high). */
bool epg_port_input_read(uint8_t pin);

/**
 * Copies up to `size` bytes of the newest record to `data`.  The record is the one that epg_port_store_write() stored
 * last, also before a restart.  Returns the number of bytes copied, 0 if nothing is stored.  Called before the control
 * loop starts.
 */
size_t epg_port_store_read(void *data, size_t size);

/**
 * Stores a record of `size` bytes, which replaces the record before it.  If power fails meanwhile, the new record is
 * either complete or absent.  Returns NULL if the record was stored, and otherwise a text that says why it was not.
 *
 * Called from the communication side, and only while the outputs are safe: it may block, and it may delay control
 * cycles.
 */
const char *epg_port_store_write(const void *data, size_t size);

/**
 * Returns the serial number of the board, which no other board has: letters and digits, the same after every start
 * ("E6616407E3A51B2C").  Called from the communication side, and before the control loop starts.
 */
const char *epg_port_serial(void);

/**
 * Returns a number of this start of the program: random, the same until the program ends, never 0.  A request that names
 * an event of the program before a restart is recognised by it.  In simulated time it is a constant, so that all runs
 * are equal.
 *
 * Called from the communication side, and before the control loop starts.  The first call may take some milliseconds.
 */
uint32_t epg_port_boot_id(void);

#ifdef __cplusplus
}
#endif

#endif
