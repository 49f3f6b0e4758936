/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Time, and the table of the target's devices.
 */
#include "epg/port.h"

#include <zephyr/kernel.h>
#include <zephyr/logging/log.h>

#include "parts.h"

LOG_MODULE_DECLARE(epg, CONFIG_EPG_LOG_LEVEL);

BUILD_ASSERT(
    IS_ENABLED(CONFIG_TIMER_HAS_64BIT_CYCLE_COUNTER),
    "EPG needs a system clock with k_cycle_get_64(); for SysTick set CONFIG_CORTEX_M_SYSTICK_64BIT_CYCLE_COUNTER=y");

bool epg_zephyr_device_refused;

/* Time ----------------------------------------------------------------------------------------------------------- */

#define NS_PER_S 1000000000U
#define CLOCK CONFIG_SYS_CLOCK_HW_CYCLES_PER_SEC

/**
 * Converts clocks to nanoseconds.  If a clock is not a whole number of nanoseconds, the factor is scaled by 2^24.  The
 * result is then wrong by a few parts per thousand million, and no division of 64 bits is needed.
 */
static inline uint64_t clocks_to_ns(uint64_t clocks)
{
#if NS_PER_S % CLOCK == 0
    return clocks * (NS_PER_S / CLOCK);
#else
    const uint64_t scale = (((uint64_t)NS_PER_S << 24) + CLOCK / 2U) / CLOCK;
    BUILD_ASSERT(CLOCK > 4000000, "nanoseconds per clock, times 2^24, have 32 bits");
    return (((clocks >> 32) * scale) << 8) + (((clocks & UINT32_MAX) * scale) >> 24);
#endif
}

uint64_t epg_port_time_ns(void)
{
    return clocks_to_ns(k_cycle_get_64());
}

/** Time from the interrupt that ends a sleep until the thread runs, with other interrupts before it. */
#define WAKING_NS 50000

/**
 * Ticks of the system clock by which a sleep can be longer than requested.  One tick, because the tick that has begun
 * does not count.  One more, if a tick ends after the kernel has read the time and before it sets the timer
 * (z_add_timeout()).
 */
#define LONGER_TICKS 2

void epg_port_wait_until(uint64_t time_ns)
{
#ifdef CONFIG_ARCH_POSIX
    ARG_UNUSED(time_ns); /* time is simulated */
#else
    /* Sleep for most of the time, so that other threads can run.  The rest is too short for a sleep. */
    const int64_t left = (int64_t)(time_ns - epg_port_time_ns()) - WAKING_NS;
    const int64_t whole = left > 0 ? (int64_t)k_ns_to_ticks_floor32((uint32_t)MIN(left, UINT32_MAX)) : 0;
    if (whole > LONGER_TICKS) {
        (void)k_sleep(K_TICKS((k_ticks_t)(whole - LONGER_TICKS)));
    }
    while (epg_port_time_ns() < time_ns) {
        arch_nop();
    }
#endif
}

/*
 * All ---------------------------------------------------------------------------------------------------------------
 */

const epg_zephyr_pin_t *epg_zephyr_pin(uint8_t pin)
{
    for (size_t i = 0; i < epg_zephyr_hardware.pin_count; i++) {
        if (epg_zephyr_hardware.pins[i].pin == pin) {
            return &epg_zephyr_hardware.pins[i];
        }
    }
    return NULL;
}

bool epg_zephyr_ready(const struct device *device)
{
    const bool ready = device_is_ready(device);
    if (!ready) {
        LOG_ERR("%s is not ready", device == NULL ? "a device" : device->name);
    }
    return ready;
}

bool epg_zephyr_devices_ready(void)
{
    const epg_zephyr_hardware_t *hardware = &epg_zephyr_hardware;
    bool ready = true;
    for (size_t i = 0; i < hardware->decoder_count; i++) {
        ready = epg_zephyr_ready(hardware->decoders[i].device) && ready;
    }
    for (size_t i = 0; i < hardware->pwm_count; i++) {
        ready = epg_zephyr_ready(hardware->pwms[i].device) && ready;
    }
    for (size_t i = 0; i < hardware->pin_count; i++) {
        ready = epg_zephyr_ready(hardware->pins[i].gpio.port) && ready;
    }
    return ready;
}
