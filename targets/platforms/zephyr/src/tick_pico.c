/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The tick of RP2040 and RP2350: the wrap interrupt of a reserved PWM slice.
 *
 * A PWM slice is a counter that counts from 0 to TOP, and then wraps.  A new level of an output takes effect at the
 * next wrap of its slice (RP2040 data sheet 4.5.2.6: TOP and CC are taken over at the wrap).
 *
 * Zephyr's PWM driver starts all slices, one after the other, and does not use their interrupts.  Here the slice of the
 * tick and the slices of the target's outputs are stopped, and started together with one write.  If the control period
 * is a whole number of PWM periods, each tick then comes at a wrap of the outputs' slices.
 */
#include <zephyr/drivers/clock_control.h>
#include <zephyr/irq.h>
#include <zephyr/kernel.h>

#include <hardware/structs/pwm.h>

#include "epg/port.h"
#include "parts.h"

#define PWM_NODE DT_NODELABEL(pwm)
BUILD_ASSERT(DT_NODE_HAS_STATUS_OKAY(PWM_NODE), "the tick is made by the PWM: its node must have status \"okay\"");

#if DT_IRQ_HAS_NAME(PWM_NODE, pwm_irq_wrap_1)
/* RP2350 has two wrap interrupts.  The SDK's pwm_set_irq_enabled(), and so most programs, use number 0. */
#define WRAP_IRQ DT_IRQ_BY_NAME(PWM_NODE, pwm_irq_wrap_1, irq)
#define WRAP_ENABLE (&pwm_hw->irq_ctrl[1].inte)
#else
#define WRAP_IRQ DT_IRQN(PWM_NODE)
#define WRAP_ENABLE (&pwm_hw->inte)
#endif

/**
 * The highest priority that Zephyr may mask.  An interrupt above it must not call the kernel.  The drivers of this chip
 * use lower priorities.
 */
#define WRAP_PRIORITY 0

#define NS_PER_S 1000000000U

static struct {
    uint32_t slice;
    uint64_t ns_per_count; /* times 2^24 */
} state;

static void on_wrap(const void *argument)
{
    ARG_UNUSED(argument);
    pwm_hw->intr = 1U << state.slice;
    epg_zephyr_control_tick();
}

/** The PWM slices that drive outputs of the target, one bit per slice. */
static uint32_t output_slices(void)
{
    uint32_t slices = 0;
    for (size_t i = 0; i < epg_zephyr_hardware.pwm_count; i++) {
        const epg_zephyr_pwm_t *pwm = &epg_zephyr_hardware.pwms[i];
        if (pwm->device == DEVICE_DT_GET(PWM_NODE)) {
            slices |= 1U << (pwm->channel / 2U);
        }
    }
    return slices;
}

static uint32_t clock_rate(void)
{
    const struct device *clocks = DEVICE_DT_GET(DT_CLOCKS_CTLR(PWM_NODE));
    uint32_t rate = 0;
    const int error = clock_control_get_rate(clocks, (clock_control_subsys_t)DT_CLOCKS_CELL(PWM_NODE, clk_id), &rate);
    return error == 0 ? rate : 0U;
}

epg_zephyr_error_t epg_zephyr_tick_start(const epg_zephyr_tick_t *tick, uint64_t period_ns)
{
    ARG_UNUSED(period_ns);
    if (!epg_zephyr_ready(DEVICE_DT_GET(PWM_NODE))) {
        return EPG_ZEPHYR_ERROR_DEVICE;
    }
    if (!epg_zephyr_check_clock("clk_sys", tick->clock, clock_rate())) {
        return EPG_ZEPHYR_ERROR_TICK;
    }
    const uint32_t bit = 1U << tick->instance;
    state.slice = tick->instance;
    state.ns_per_count = (((uint64_t)tick->prescaler * NS_PER_S) << 24) / tick->clock;

    const uint32_t outputs = output_slices();
    if ((outputs & bit) != 0U) {
        return EPG_ZEPHYR_ERROR_DEVICE; /* an overlay of the user has moved an output to the slice of the tick */
    }
    pwm_slice_hw_t *slice = &pwm_hw->slice[tick->instance];
    slice->csr = 0;
    slice->div = tick->prescaler << PWM_CH0_DIV_INT_LSB;
    slice->top = tick->top;
    IRQ_CONNECT(WRAP_IRQ, WRAP_PRIORITY, on_wrap, NULL, 0);

    const unsigned int key = irq_lock();
    pwm_hw->en &= ~(outputs | bit);
    for (uint32_t i = 0; i < NUM_PWM_SLICES; i++) {
        if (((outputs | bit) >> i & 1U) != 0U) {
            pwm_hw->slice[i].ctr = 0;
        }
    }
    pwm_hw->intr = bit;
    *WRAP_ENABLE |= bit;
    irq_enable(WRAP_IRQ);
    pwm_hw->en |= outputs | bit;
    irq_unlock(key);
    return EPG_ZEPHYR_OK;
}

void epg_zephyr_tick_stop(void)
{
    const unsigned int key = irq_lock();
    *WRAP_ENABLE &= ~(1U << state.slice);
    irq_unlock(key);
}

uint64_t epg_zephyr_tick_newest_ns(uint64_t *now_ns)
{
    /*
     * The counter first, then the time.  Code from flash may take long between the two readings.  In this order the
     * tick then seems later than it was, never earlier.  Too early would be wrong: outputs are written at a time after
     * the tick, and a level that is written before a wrap takes effect at that wrap.
     */
    const unsigned int key = irq_lock();
    const uint32_t count = pwm_hw->slice[state.slice].ctr;
    *now_ns = epg_port_time_ns();
    irq_unlock(key);
    return *now_ns - (count * state.ns_per_count >> 24);
}
