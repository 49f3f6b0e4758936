/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Zephyr: starting, stopping and monitoring a target.
 *
 * **Threads.**  The control cycle runs in a meta-IRQ thread.  Zephyr runs such a thread before all others, cooperative
 * ones too; only interrupts can delay it.  The communication side is a preemptible thread.
 *
 * **Tick.**  A timer of the hardware repeats by itself and raises an interrupt once per control period.  The interrupt
 * releases the control thread.  Emulated boards have no such timer; a k_timer makes their tick.
 *
 * **Devices.**  Encoders, PWM outputs, pins and UARTs are devices of Zephyr's drivers.  The target's overlay adds a
 * devicetree node with the compatible `epg,target`, which lists them.  The generated tables below connect the numbers
 * of the portable code (pin, instance, slot) with these devices.
 *
 * An image contains one target.  The generated `<name>_start()` and `<name>_stop()` call the functions below:
 *
 *     #include "jiwy.h"
 *     #include "epg/zephyr.h"
 *
 *     if (!jiwy_start()) {
 *         epg_zephyr_status_t status;
 *         epg_zephyr_status(&status);
 *         printk("not started: error %d\n", (int)status.error);
 *     }
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

/** A quadrature decoder: a device of the sensor API whose driver also reports its count (epg/zephyr/qdec.h). */
typedef struct epg_zephyr_decoder {
    uint8_t instance; /**< that of its epg_port_quadrature_t */
    uint8_t slot;     /**< that of its epg_port_quadrature_t */
    const struct device *device;
} epg_zephyr_decoder_t;

/** A channel of a PWM device. */
typedef struct epg_zephyr_pwm {
    uint8_t instance; /**< that of its epg_port_pwm_t */
    uint8_t slot;     /**< that of its epg_port_pwm_t */
    const struct device *device;
    uint32_t channel; /**< of the device */
    /**
     * 0 for a device that EPG's overlay sets up: it divides the clock so that a level of the portable code is the same
     * number of the device's clocks.  Else the PWM period, in ns, of a device that the application's own devicetree
     * sets up; a level is then converted to the same share of this period.
     */
    uint32_t period_ns;
    pwm_flags_t flags;
} epg_zephyr_pwm_t;

/**
 * A pin that a component reads or writes, or on which it has a PWM output.  The code that makes outputs safe may
 * configure it as a plain output at any time, also if it was a PWM output.
 */
typedef struct epg_zephyr_pin {
    uint8_t pin; /**< number of the pin in the portable code */
    struct gpio_dt_spec gpio;
} epg_zephyr_pin_t;

/** A pin that a component drives. */
typedef struct epg_zephyr_output {
    uint8_t pin; /**< number of the pin in the portable code */
    bool high;   /**< safe level of the pin */
} epg_zephyr_output_t;

/** A UART whose driver has the interrupt-driven API.  The devicetree sets its baud rate. */
typedef struct epg_zephyr_uart {
    uint8_t instance; /**< that of its epg_port_uart_t */
    const struct device *device;
} epg_zephyr_uart_t;

/** The devices of the target in this image; generated from the devicetree node with the compatible `epg,target`. */
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
    const epg_output_group_t *groups; /**< one group per component: its part of `outputs`, and its safe states */
    size_t uart_count;
    const epg_zephyr_uart_t *uarts;
} epg_zephyr_hardware_t;

extern const epg_zephyr_hardware_t epg_zephyr_hardware;

/**
 * The timer that makes the tick.  One control period is `prescaler * (top + 1)` periods of a clock of `clock` Hz.
 *
 * On RP2040 and RP2350 the tick is the wrap of a PWM slice.  On other chips it is the top value of a counter device.
 * On emulated boards it is a k_timer, which uses none of these members.
 */
typedef struct epg_zephyr_tick {
    const struct device *device; /**< counter device; NULL for a PWM slice */
    uint32_t clock;              /**< Hz, before the prescaler */
    uint32_t prescaler;
    uint32_t top;     /**< largest value of the counter */
    uint8_t instance; /**< number of the PWM slice */
} epg_zephyr_tick_t;

/** A target with its tick and transports; generated. */
typedef struct epg_zephyr_target {
    const epg_target_t *target;
    epg_zephyr_tick_t tick;
    const epg_transport_t *transport;         /**< of the target's middleware; NULL if it needs none */
    const char *transport_title;              /**< name of the transport for the user, for example "EPG ROS 2" */
    const epg_transport_t *console_transport; /**< of a console beside another middleware; NULL if there is none */
} epg_zephyr_target_t;

/** The reason why epg_zephyr_start() or epg_zephyr_stop() failed. */
typedef enum epg_zephyr_error {
    EPG_ZEPHYR_OK = 0,
    EPG_ZEPHYR_ERROR_RUNNING, /**< a target is running already */
    EPG_ZEPHYR_ERROR_DEVICE,  /**< a device is not ready, or its driver returned an error */
    EPG_ZEPHYR_ERROR_TICK,    /**< the tick's clock has another frequency than `clocks` of the `.tcf`: see the log */
    EPG_ZEPHYR_ERROR_CALLER   /**< epg_zephyr_stop() was called where it cannot wait */
} epg_zephyr_error_t;

/** Measurements of the port layer.  The statistics of the control cycle are reported elsewhere (`epg/statistics.h`). */
typedef struct epg_zephyr_status {
    epg_zephyr_error_t error;          /**< the newest error; EPG_ZEPHYR_OK after a successful start */
    uint32_t control_stack_size;       /**< bytes of the control thread's stack */
    uint32_t control_stack_used;       /**< the largest number in use so far; 0 if Zephyr does not measure it */
    uint32_t communication_stack_size; /**< bytes of the communication thread's stack */
    uint32_t communication_stack_used; /**< the largest number in use so far; 0 if Zephyr does not measure it */
    uint32_t transport_lost;           /**< bytes that the middleware's transport has received and lost */
} epg_zephyr_status_t;

/**
 * The transport `usb`: the serial port on USB whose devicetree node has the label epg_usb (compatible
 * zephyr,cdc-acm-uart).  The node's property `label` is the title of the port.
 */
extern const epg_transport_t epg_zephyr_usb;
/** The serial port whose node has the label epg_usb_second.  The console uses it if another middleware uses epg_usb. */
extern const epg_transport_t epg_zephyr_usb_second;

/**
 * Starts the control side and the communication side.  Must be called from a thread.
 *
 * Returns false, with all outputs safe, if the target cannot start; epg_zephyr_status() then reports the reason.
 */
bool epg_zephyr_start(const epg_zephyr_target_t *zephyr);

/**
 * Stops the communication side and the control side.  When this returns true, all outputs are safe, and
 * epg_zephyr_start() may be called again.  Returns true, too, if no target is running.
 *
 * Must be called from a thread of a lower priority than the control thread's.  It waits for the end of both threads.
 * Interrupts and these two threads cannot wait for this: for them it returns false, and the target goes on.
 */
bool epg_zephyr_stop(void);

/** Fills `status`. */
void epg_zephyr_status(epg_zephyr_status_t *status);

/**
 * Makes all outputs safe and locks interrupts, both until the next reset.  For fault handlers.  Each pin becomes a plain
 * output at its safe level, whatever its PWM does.
 */
void epg_zephyr_safe_state(void);

#ifdef __cplusplus
}
#endif

#endif
