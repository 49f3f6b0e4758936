/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Safe outputs: before main(), and after a fatal error.
 */
#include <zephyr/cache.h>
#include <zephyr/drivers/pwm.h>
#include <zephyr/fatal.h>
#include <zephyr/init.h>
#include <zephyr/kernel.h>
#include <zephyr/logging/log.h>
#include <zephyr/logging/log_ctrl.h>

#include "parts.h"

LOG_MODULE_DECLARE(epg, CONFIG_EPG_LOG_LEVEL);

#define FAULT_MAGIC 0xEF4A17EDU

/** Records a fault across a reset: the start-up code does not clear this variable. */
static __noinit uint32_t fault_word;

static void remember(uint32_t value)
{
    fault_word = value;
    (void)sys_cache_data_flush_range(&fault_word, sizeof fault_word);
}

/** Makes each output's pin a plain output at its safe level, whatever its PWM does. */
static void make_pins_safe(void)
{
    for (size_t i = 0; i < epg_zephyr_hardware.output_count; i++) {
        const epg_zephyr_output_t *output = &epg_zephyr_hardware.outputs[i];
        const epg_zephyr_pin_t *row = epg_zephyr_pin(output->pin);
        if (row != NULL && device_is_ready(row->gpio.port)) {
            (void)gpio_pin_configure_dt(&row->gpio, output->high ? GPIO_OUTPUT_ACTIVE : GPIO_OUTPUT_INACTIVE);
        }
    }
}

void epg_zephyr_safe_state(void)
{
    (void)irq_lock(); /* until the reset: no tick and no other thread runs any more */
    make_pins_safe();
    remember(FAULT_MAGIC);
}

epg_fault_t epg_zephyr_fault_before_reset(void)
{
    static bool asked;
    static epg_fault_t fault;
    if (!asked) {
        const bool watchdog = epg_zephyr_watchdog_has_reset();
        fault = fault_word == FAULT_MAGIC ? EPG_FAULT_PROCESSOR : watchdog ? EPG_FAULT_WATCHDOG : EPG_FAULT_NONE;
        remember(0);
        asked = true;
    }
    return fault;
}

/** Runs after the drivers of the GPIOs have started, and before the PWM takes over its pins. */
static int start_outputs(void)
{
    make_pins_safe();
    return 0;
}

SYS_INIT(start_outputs, POST_KERNEL, CONFIG_EPG_OUTPUTS_INIT_PRIORITY);

#ifdef CONFIG_EPG_FATAL_ERROR_HANDLER
/* Replaces Zephyr's weak function. */
void k_sys_fatal_error_handler(unsigned int reason, const struct arch_esf *frame)
{
    ARG_UNUSED(frame);
    epg_zephyr_safe_state();
    LOG_PANIC();
    LOG_ERR("outputs are safe; halting");
    k_fatal_halt(reason);
}
#endif
