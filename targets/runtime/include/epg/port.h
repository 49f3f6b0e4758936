/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The port layer: what EPG's portable code asks of a platform.
 *
 * Each folder `targets/platforms/<name>` implements these functions once.  The portable code (runtime, component
 * drivers, generated tables, model) includes no header of any SDK, so it can be compiled into a static library
 * before the SDK's settings are known.  All functions are called from the control side unless stated otherwise, and
 * none may block, allocate or fail: what can be wrong (pins, peripherals, ranges) was checked by the generator.
 */
#ifndef EPG_PORT_H
#define EPG_PORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Monotonic time in nanoseconds.  Callable from every context. */
uint64_t epg_port_time_ns(void);

/**
 * Returns when epg_port_time_ns() is `time_ns` or more.  Called within a control cycle with a time less than a period
 * ahead.  In simulated time it returns at once: there outputs act at the instant of their tick.
 */
void epg_port_wait_until(uint64_t time_ns);

/** A quadrature decoder.  `instance` and `slot` name the peripheral (PIO block and state machine, timer, ...). */
typedef struct epg_port_quadrature {
    uint8_t pin_a;
    uint8_t pin_b;
    uint8_t instance;
    uint8_t slot;
    bool pull_up; /**< enable the pins' pull-up resistors */
} epg_port_quadrature_t;

void epg_port_quadrature_start(const epg_port_quadrature_t *decoder);

/**
 * Free-running count, one per edge of A or B (x4), modulo 2^32; wraps without a trace.  Called at least once per
 * control cycle, so that the caller's signed differences are unambiguous.
 */
uint32_t epg_port_quadrature_count(const epg_port_quadrature_t *decoder);

/**
 * False: the decoder has stopped (a state machine that left its program, a timer whose clock is gone) and its count
 * means nothing any more.  Called once per control cycle.  A port whose decoders cannot stop returns true.
 */
bool epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder);

/** One PWM output.  The period is `prescaler * (top + 1)` clocks; `instance` and `slot` name slice and channel. */
typedef struct epg_port_pwm {
    uint8_t pin;
    uint8_t instance;
    uint8_t slot;
    uint16_t prescaler;
    uint16_t top;
} epg_port_pwm_t;

/** Starts with level 0. */
void epg_port_pwm_start(const epg_port_pwm_t *pwm);

/** Sets the high time in clocks, 0 ... `top + 1` (always high); takes effect at the next period. */
void epg_port_pwm_write(const epg_port_pwm_t *pwm, uint32_t level);

typedef enum epg_port_pull { EPG_PULL_NONE, EPG_PULL_UP, EPG_PULL_DOWN } epg_port_pull_t;

void epg_port_output_start(uint8_t pin, bool level);
void epg_port_output_write(uint8_t pin, bool level);
void epg_port_input_start(uint8_t pin, epg_port_pull_t pull);
bool epg_port_input_read(uint8_t pin);

/**
 * Copies up to `size` bytes of what epg_port_store_write() has stored last, also before the last restart, to `data`;
 * returns how many, 0 when nothing is stored.  Before the control loop starts.
 */
size_t epg_port_store_read(void *data, size_t size);

/**
 * Stores `size` bytes in place of what was stored before, so that it is either there whole or not there; returns
 * whether that could be done.  Called from the communication side, while outputs are safe: it may block, and delay the
 * control cycle too.  A platform that has nothing to store in returns false.
 */
bool epg_port_store_write(const void *data, size_t size);

/**
 * What tells this board from all others: letters and digits, the same after every start ("E6616407E3A51B2C").  From the
 * communication side, and before the control loop starts.
 */
const char *epg_port_serial(void);

#ifdef __cplusplus
}
#endif

#endif
