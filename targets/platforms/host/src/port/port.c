/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The port layer with simulated peripherals: decoder counts, PWM levels and pin levels.
 *
 * The generator numbers the host's peripherals of each class from 0, all in instance 0.  `slot` or `pin` is therefore
 * enough to identify one.
 *
 * Each value is a relaxed atomic, because in real time a second thread may set an input or read an output while the
 * control thread runs.  The order of changes of two signals is not defined, as with real pins.
 */
#include <stdatomic.h>

#include "epg/plant.h"
#include "epg/port.h"

enum { UNITS = UINT8_MAX + 1, PINS = UINT8_MAX + 1 };

static struct {
    _Atomic int64_t signal; /* position of the shaft in counts, set by the plant */
    _Atomic int64_t origin; /* value of `signal` when the decoder was started */
    atomic_bool failed;
} decoders[UNITS];

static struct {
    _Atomic uint32_t top;
    _Atomic uint32_t level;
} pwms[UNITS];

/* The drivers of the input pins, of type epg_plant_force_t: `forced` replaces `driven`.  At the start both are 0. */
static _Atomic uint8_t driven[PINS];
static _Atomic uint8_t forced[PINS];
static _Atomic uint8_t pulls[PINS];
static atomic_bool outputs[PINS];

#define GET(object) atomic_load_explicit(&(object), memory_order_relaxed)
#define SET(object, value) atomic_store_explicit(&(object), (value), memory_order_relaxed)

/* Quadrature decoders ----------------------------------------------------------------------------------------- */

/** A decoder counts from 0 at any position of the shaft: an incremental encoder does not know the position. */
void epg_port_quadrature_start(const epg_port_quadrature_t *decoder)
{
    SET(decoders[decoder->slot].origin, GET(decoders[decoder->slot].signal));
}

uint32_t epg_port_quadrature_count(const epg_port_quadrature_t *decoder)
{
    const uint64_t signal = (uint64_t)GET(decoders[decoder->slot].signal);
    const uint64_t origin = (uint64_t)GET(decoders[decoder->slot].origin);
    return (uint32_t)((signal - origin) & UINT32_MAX);
}

bool epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder)
{
    return !GET(decoders[decoder->slot].failed);
}

void epg_plant_quadrature_fail(uint8_t slot, bool failed)
{
    SET(decoders[slot].failed, failed);
}

void epg_plant_quadrature_set(uint8_t slot, int64_t count)
{
    SET(decoders[slot].signal, count);
}

/* PWM ---------------------------------------------------------------------------------------------------------- */

void epg_port_pwm_start(const epg_port_pwm_t *pwm)
{
    SET(pwms[pwm->slot].level, 0);
    SET(pwms[pwm->slot].top, pwm->top);
}

void epg_port_pwm_write(const epg_port_pwm_t *pwm, uint32_t level)
{
    SET(pwms[pwm->slot].level, level);
}

double epg_plant_pwm_duty(uint8_t slot)
{
    const uint32_t level = GET(pwms[slot].level);
    const uint32_t clocks = GET(pwms[slot].top) + 1U;
    return level >= clocks ? 1.0 : (double)level / (double)clocks;
}

/* Pins --------------------------------------------------------------------------------------------------------- */

void epg_port_output_start(uint8_t pin, bool level)
{
    SET(outputs[pin], level);
}

void epg_port_output_write(uint8_t pin, bool level)
{
    SET(outputs[pin], level);
}

bool epg_plant_output(uint8_t pin)
{
    return GET(outputs[pin]);
}

void epg_port_input_start(uint8_t pin, epg_port_pull_t pull)
{
    SET(pulls[pin], (uint8_t)pull);
}

bool epg_port_input_read(uint8_t pin)
{
    const uint8_t force = GET(forced[pin]);
    const uint8_t driver = force == EPG_PLANT_FORCE_NONE ? GET(driven[pin]) : force;
    return driver == EPG_PLANT_FORCE_HIGH || (driver != EPG_PLANT_FORCE_LOW && GET(pulls[pin]) == EPG_PULL_UP);
}

void epg_plant_input_set(uint8_t pin, bool level)
{
    SET(driven[pin], level ? EPG_PLANT_FORCE_HIGH : EPG_PLANT_FORCE_LOW);
}

void epg_plant_input_force(uint8_t pin, epg_plant_force_t force)
{
    SET(forced[pin], (uint8_t)force);
}
