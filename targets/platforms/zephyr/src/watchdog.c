/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The watchdog, which is the device with the devicetree alias watchdog0.
 *
 * It resets the board if it is not fed in time.  It is fed after each control cycle, but only while the communication
 * side is alive.  It therefore resets the board if one of the two sides stops.
 */
#include <zephyr/drivers/hwinfo.h>
#include <zephyr/drivers/watchdog.h>
#include <zephyr/kernel.h>
#include <zephyr/logging/log.h>

#ifdef CONFIG_SOC_FAMILY_RPI_PICO
#include <hardware/structs/watchdog.h>
#endif

#include "parts.h"

LOG_MODULE_DECLARE(epg, CONFIG_EPG_LOG_LEVEL);

/** Timeout while flash is written, which can make the processor wait.  The longest one of RP2040 is 8.3 s. */
#define RELAXED_MS 8000U
/** Some watchdogs cannot be stopped.  After the target has stopped, a timer feeds them this often per timeout. */
#define FEEDINGS 4U

static const struct device *const device = DEVICE_DT_GET(DT_ALIAS(watchdog0));

static struct {
    int channel;
    uint32_t timeout_ms;
    uint32_t silence_limit; /* control cycles without a turn of the communication side */
    bool running;
} state;

static void feed(struct k_timer *timer)
{
    ARG_UNUSED(timer);
    (void)wdt_feed(device, state.channel);
}

static K_TIMER_DEFINE(feeder, feed, NULL);

static int set_up(uint32_t timeout_ms)
{
    const struct wdt_timeout_cfg config = {.flags = WDT_FLAG_RESET_SOC, .window = {.min = 0, .max = timeout_ms}};
    const int channel = wdt_install_timeout(device, &config);
    if (channel < 0) {
        return channel;
    }
    state.channel = channel;
    const int error = wdt_setup(device, WDT_OPT_PAUSE_HALTED_BY_DBG);
    return error == -ENOTSUP ? wdt_setup(device, 0) : error;
}

epg_zephyr_error_t epg_zephyr_watchdog_start(uint64_t period_ns)
{
    const uint32_t periods_ms = (uint32_t)(4U * period_ns / 1000000U);
    const uint64_t silence = (uint64_t)CONFIG_EPG_WATCHDOG_SILENCE_MS * 1000000U / period_ns;
    state.timeout_ms = MAX(periods_ms, CONFIG_EPG_WATCHDOG_TIMEOUT_MS);
    state.silence_limit = (uint32_t)MAX(silence, 4U);
    k_timer_stop(&feeder);
    if (!epg_zephyr_ready(device)) {
        return EPG_ZEPHYR_ERROR_DEVICE;
    }
    const int error = set_up(state.timeout_ms);
    if (error < 0) {
        LOG_ERR("%s: cannot set a timeout of %u ms (%d)", device->name, (unsigned)state.timeout_ms, error);
        return EPG_ZEPHYR_ERROR_DEVICE;
    }
    state.running = true;
    return EPG_ZEPHYR_OK;
}

void epg_zephyr_watchdog_stop(void)
{
    if (epg_zephyr_outputs_unsafe()) {
        return; /* the watchdog must reset the board */
    }
    if (state.running && wdt_disable(device) < 0) {
        k_timer_start(&feeder, K_NO_WAIT, K_MSEC(state.timeout_ms / FEEDINGS));
    }
    state.running = false;
}

void epg_zephyr_watchdog_feed(uint32_t silence)
{
    if (silence < state.silence_limit && !epg_zephyr_outputs_unsafe()) {
        (void)wdt_feed(device, state.channel);
    }
}

void epg_zephyr_watchdog_relax(bool relaxed)
{
    if (state.running && !epg_zephyr_outputs_unsafe()) {
        (void)set_up(relaxed ? MAX(RELAXED_MS, state.timeout_ms) : state.timeout_ms);
    }
}

bool epg_zephyr_watchdog_has_reset(void)
{
#ifdef CONFIG_SOC_FAMILY_RPI_PICO
    return (watchdog_hw->reason & WATCHDOG_REASON_TIMER_BITS) != 0U;
#else
    uint32_t cause = 0;
    if (hwinfo_get_reset_cause(&cause) < 0 || (cause & RESET_WATCHDOG) == 0U) {
        return false;
    }
    (void)hwinfo_clear_reset_cause(); /* some chips keep the recorded causes across later resets */
    return true;
#endif
}
