/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Zephyr: what a generated target and the port layer know of each other.
 *
 * The control cycle runs in a meta-IRQ thread, which a tick of the hardware releases: nothing but interrupts goes before
 * it.  Communication is a preemptible thread.  One target per image.
 */
#ifndef EPG_ZEPHYR_H
#define EPG_ZEPHYR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <zephyr/device.h>
#include <zephyr/drivers/gpio.h>
#include <zephyr/drivers/pwm.h>

#include "epg/middleware.h"
#include "epg/outputs.h"
#include "epg/target.h"
#include "epg/transport.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A decoder of the sensor API with epg/zephyr/qdec.h; `instance` and `slot` are those of its epg_port_quadrature_t. */
typedef struct epg_zephyr_decoder {
    uint8_t instance;
    uint8_t slot;
    const struct device *device;
} epg_zephyr_decoder_t;

/**
 * A channel of a PWM device; `instance` and `slot` are those of its epg_port_pwm_t.  Where `period_ns` is 0 the devicetree
 * divides the clock so that levels are clocks of the device; else the device is the application's own, and levels are
 * shares of that period.
 */
typedef struct epg_zephyr_pwm {
    uint8_t instance;
    uint8_t slot;
    const struct device *device;
    uint32_t channel;
    uint32_t period_ns;
    pwm_flags_t flags;
} epg_zephyr_pwm_t;

/**
 * A pin that is read or written, or has a PWM output of a chip; `pin` is its number in the portable code.  What makes
 * outputs safe can take it for itself: configure it as an output, whatever it was.
 */
typedef struct epg_zephyr_pin {
    uint8_t pin;
    struct gpio_dt_spec gpio;
} epg_zephyr_pin_t;

/** A pin that a component drives, and its level while nothing is to move. */
typedef struct epg_zephyr_output {
    uint8_t pin;
    bool high;
} epg_zephyr_output_t;

/** A UART with interrupts; `instance` is that of its epg_port_uart_t.  Its baud rate is set by the devicetree. */
typedef struct epg_zephyr_uart {
    uint8_t instance;
    const struct device *device;
} epg_zephyr_uart_t;

/** The devices of the target in this image; generated from the node `epg,target` of the devicetree. */
typedef struct epg_zephyr_hardware {
    size_t decoder_count;
    const epg_zephyr_decoder_t *decoders;
    size_t pwm_count;
    const epg_zephyr_pwm_t *pwms;
    size_t pin_count;
    const epg_zephyr_pin_t *pins;
    size_t output_count;
    const epg_zephyr_output_t *outputs;
    size_t group_count;
    const epg_output_group_t *groups; /**< of `outputs`: what of them belongs to one component */
    size_t uart_count;
    const epg_zephyr_uart_t *uarts;
} epg_zephyr_hardware_t;

extern const epg_zephyr_hardware_t epg_zephyr_hardware;

/**
 * The tick.  On RP2040 and RP2350 the wrap of PWM slice `instance`; elsewhere the top of the counter `device`; neither is
 * used by a k_timer.  `prescaler * (top + 1)` clocks of `clock` Hz are one control period.
 */
typedef struct epg_zephyr_tick {
    const struct device *device;
    uint32_t clock;
    uint32_t prescaler;
    uint32_t top;
    uint8_t instance;
} epg_zephyr_tick_t;

/** A target as its port layer runs it. */
typedef struct epg_zephyr_target {
    const epg_target_t *target;
    epg_zephyr_tick_t tick;
    const epg_transport_t *transport; /**< for the target's middleware; NULL: it needs none */
    const char *transport_title;
    const epg_transport_t *console_transport; /**< for the console beside it; NULL: there is none */
} epg_zephyr_target_t;

/** Why epg_zephyr_start() did not start, or epg_zephyr_stop() did not stop. */
typedef enum epg_zephyr_error {
    EPG_ZEPHYR_OK = 0,
    EPG_ZEPHYR_ERROR_RUNNING, /**< it runs already */
    EPG_ZEPHYR_ERROR_DEVICE,  /**< a device of the devicetree is not ready, or refused what was asked of it */
    EPG_ZEPHYR_ERROR_TICK,    /**< the tick's clock is not what the generator computed its period for */
    EPG_ZEPHYR_ERROR_CALLER   /**< epg_zephyr_stop() was called where it cannot wait */
} epg_zephyr_error_t;

/** What the port layer counts besides the statistics of the control cycle. */
typedef struct epg_zephyr_status {
    epg_zephyr_error_t error;    /**< of the newest start */
    uint32_t control_stack_size; /**< bytes of the control thread's stack, */
    uint32_t control_stack_used; /**< and how many of them have ever been used; 0 where Zephyr does not count */
    uint32_t communication_stack_size;
    uint32_t communication_stack_used;
    uint32_t transport_lost; /**< bytes that the middleware's transport has received and lost */
} epg_zephyr_status_t;

/**
 * The serial port of USB whose node in the devicetree is labelled epg_usb (a zephyr,cdc-acm-uart), as a transport; its
 * property label is the title,
 */
extern const epg_transport_t epg_zephyr_usb;
/** and the one labelled epg_usb_second: the console's, beside another middleware on epg_usb. */
extern const epg_transport_t epg_zephyr_usb_second;

/**
 * Starts the control loop and communication.  From a thread.  False, with all outputs safe, when that is impossible:
 * epg_zephyr_status() says why.
 */
bool epg_zephyr_start(const epg_zephyr_target_t *zephyr);

/**
 * Ends communication and control; outputs are safe when this returns true.  epg_zephyr_start() may follow.  Call it from a
 * thread of lower priority than control's.
 *
 * False, and everything goes on, in an interrupt and in the threads of communication and control: these cannot wait for
 * the end of a thread.
 */
bool epg_zephyr_stop(void);

void epg_zephyr_status(epg_zephyr_status_t *status);

/** Makes all outputs safe for good: for fault handlers; only a reset leads out of it. */
void epg_zephyr_safe_state(void);

#ifdef __cplusplus
}
#endif

#endif
