/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Arm's MPS2 boards: starting and stopping a target.  Pins, PWM outputs and encoders are variables.
 */
#ifndef EPG_MPS2_H
#define EPG_MPS2_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/mcu.h"
#include "epg/middleware.h"
#include "epg/target.h"
#include "epg/transport.h"

typedef struct epg_mps2_output {
    uint8_t pin;
    bool high; /**< safe level */
} epg_mps2_output_t;

typedef struct epg_mps2_outputs {
    size_t count;
    const epg_mps2_output_t *pins;
} epg_mps2_outputs_t;

/** Generated. */
extern const epg_mps2_outputs_t epg_mps2_outputs;

typedef struct epg_mps2_target {
    const epg_target_t *target;
    uint32_t top; /**< of TIMER0 */
    const epg_transport_t *transport;
    const char *transport_title;
    const epg_transport_t *console_transport;
} epg_mps2_target_t;

bool epg_mps2_start(const epg_mps2_target_t *mps2);
bool epg_mps2_stop(void);

/** A pin.  It shows the duty of its PWM output only while `by_pwm` is true. */
typedef struct mps2_pin {
    bool by_pwm;
    bool high;
    uint8_t output; /**< PWM output */
} mps2_pin_t;

#define MPS2_PINS 20U
#define MPS2_PWM_OUTPUTS 8U

extern volatile mps2_pin_t mps2_pins[MPS2_PINS];
extern volatile uint32_t mps2_levels[MPS2_PWM_OUTPUTS];

/** The duty of a pin, 0 to 1. */
double mps2_duty(uint8_t pin);

/** Brought by the program: the count of an encoder with these pins.  Called once per control cycle. */
uint32_t mps2_count(uint8_t pin_a);

#endif
