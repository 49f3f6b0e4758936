/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Pins (RM0433, 11), and their safe levels before main() and after faults.
 */
#include "epg/port.h"

#include "parts.h"

/** Values of MODER, two bits per pin (RM0433, 11.4.1). */
#define MODE_INPUT 0U
#define MODE_OUTPUT 1U
#define MODE_FUNCTION 2U

static inline uint32_t bit_of(uint8_t pin)
{
    return pin & 15U;
}

GPIO_TypeDef *EPG_STM32_CYCLE(epg_stm32_port)(uint8_t pin)
{
    return (GPIO_TypeDef *)(GPIOA_BASE + (GPIOB_BASE - GPIOA_BASE) * (uint32_t)(pin >> 4));
}

/** Sets the two bits of `pin` in a register of its port. */
static void EPG_STM32_CYCLE(set_pair)(volatile uint32_t *word, uint8_t pin, uint32_t value)
{
    const uint32_t before = epg_stm32_enter();
    *word = (*word & ~(3U << (2U * bit_of(pin)))) | value << (2U * bit_of(pin));
    epg_stm32_leave(before);
}

static void EPG_STM32_CYCLE(write)(uint8_t pin, bool level)
{
    epg_stm32_port(pin)->BSRR = level ? 1U << bit_of(pin) : 1U << (bit_of(pin) + 16U);
}

static void EPG_STM32_CYCLE(push_pull)(GPIO_TypeDef *port, uint8_t pin)
{
    const uint32_t before = epg_stm32_enter();
    port->OTYPER &= ~(1U << bit_of(pin));
    epg_stm32_leave(before);
}

/** Makes `pin` an output at `level`; it has this level from the first moment. */
static void EPG_STM32_CYCLE(drive)(uint8_t pin, bool level)
{
    GPIO_TypeDef *port = epg_stm32_port(pin);
    write(pin, level);
    push_pull(port, pin);
    set_pair(&port->MODER, pin, MODE_OUTPUT);
}

static void set_pull(uint8_t pin, epg_port_pull_t pull)
{
    /* PUPDR, 11.4.4: 1 up, 2 down */
    set_pair(&epg_stm32_port(pin)->PUPDR, pin, pull == EPG_PULL_UP ? 1U : pull == EPG_PULL_DOWN ? 2U : 0U);
}

void epg_stm32_connect_function(uint8_t pin, uint32_t function, epg_port_pull_t pull)
{
    epg_stm32_enable_port(pin >> 4);
    GPIO_TypeDef *port = epg_stm32_port(pin);
    volatile uint32_t *word = &port->AFR[bit_of(pin) >> 3];
    const uint32_t shift = 4U * (bit_of(pin) & 7U);
    const uint32_t before = epg_stm32_enter();
    *word = (*word & ~(15U << shift)) | function << shift;
    epg_stm32_leave(before);
    push_pull(port, pin);
    set_pull(pin, pull);
    set_pair(&port->OSPEEDR, pin, 1U); /* medium: enough for PWM and for 3 Mbit/s (DS12110, I/O port characteristics) */
    set_pair(&port->MODER, pin, MODE_FUNCTION);
}

void epg_stm32_connect(uint8_t pin, epg_port_pull_t pull)
{
    const epg_stm32_hardware_t *hardware = &epg_stm32_hardware;
    uint32_t function = 0U;
    for (size_t i = 0; i < hardware->function_count; i++) {
        if (hardware->functions[i].pin == pin) {
            function = hardware->functions[i].function;
        }
    }
    epg_stm32_connect_function(pin, function, pull);
}

void epg_port_output_start(uint8_t pin, bool level)
{
    epg_stm32_enable_port(pin >> 4);
    drive(pin, level);
}

void EPG_STM32_CYCLE(epg_port_output_write)(uint8_t pin, bool level)
{
    write(pin, level);
}

void epg_port_input_start(uint8_t pin, epg_port_pull_t pull)
{
    epg_stm32_enable_port(pin >> 4);
    set_pull(pin, pull);
    set_pair(&epg_stm32_port(pin)->MODER, pin, MODE_INPUT);
}

bool EPG_STM32_CYCLE(epg_port_input_read)(uint8_t pin)
{
    return (epg_stm32_port(pin)->IDR >> bit_of(pin) & 1U) != 0U;
}

/* Safe levels ---------------------------------------------------------------------------------------------------- */

void EPG_STM32_CYCLE(epg_one_core_outputs_safe)(void)
{
    const epg_stm32_hardware_t *hardware = &epg_stm32_hardware;
    for (size_t i = 0; i < hardware->output_count; i++) {
        drive(hardware->outputs[i].pin, hardware->outputs[i].high);
    }
}

/** Runs before main(), before the constructors of the user. */
static void __attribute__((constructor(101))) make_outputs_safe(void)
{
    for (size_t i = 0; i < epg_stm32_hardware.output_count; i++) {
        epg_stm32_enable_port(epg_stm32_hardware.outputs[i].pin >> 4);
    }
    epg_one_core_outputs_safe();
}
