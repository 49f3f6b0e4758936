/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Writing to flash while a target runs: only while it is disabled, with core 1 waiting in RAM.
 *
 * While flash is erased or written nothing can be read from it.  The control cycle lies in RAM, but what a user has
 * added to it may not.  So flash_safe_execute() of the SDK asks this first (get_flash_safety_helper() is its hook for
 * programs that share core 1 in their own way): when outputs are not safe, it returns PICO_ERROR_NOT_PERMITTED.
 */
#include "flash.h"

#include "parts.h"

static uint32_t interrupts;

static bool core_init_deinit(bool init)
{
    (void)init;
    return true;
}

static int enter(uint32_t timeout_ms)
{
    if (get_core_num() != 0U || !epg_pico_control_hold(timeout_ms * 1000U)) {
        return PICO_ERROR_NOT_PERMITTED;
    }
    interrupts = save_and_disable_interrupts();
    return PICO_OK;
}

static int leave(uint32_t timeout_ms)
{
    (void)timeout_ms;
    restore_interrupts(interrupts);
    epg_pico_control_release();
    return PICO_OK;
}

flash_safety_helper_t *get_flash_safety_helper(void)
{
    static flash_safety_helper_t helper = {
        .core_init_deinit = core_init_deinit,
        .enter_safe_zone_timeout_ms = enter,
        .exit_safe_zone_timeout_ms = leave,
    };
    return &helper;
}
