/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/* A whole target in Zephyr: JIWY's controller.  On emulated encoders, the test turns the shafts. */

#include <stdint.h>

#include <zephyr/kernel.h>
#include <zephyr/ztest.h>

#include "epg/target.h"
#include "jiwy.h"
#include "worn.h"

#define SECONDS 3
#define CYCLES_PER_SECOND 1000

static epg_status_t status_after(k_timeout_t time)
{
	epg_status_t status = {0};

	k_sleep(time);
	zassert_true(jiwy_status(&status), "there was no cycle");

	return status;
}

/* The period of JIWY is 1 ms: there is one cycle per millisecond, each at its tick. */
ZTEST(jiwy, test_cycles)
{
	const epg_status_t first = status_after(K_MSEC(10));
	const epg_status_t second = status_after(K_SECONDS(SECONDS));

	zassert_within(second.statistics.cycles - first.statistics.cycles,
		       SECONDS * CYCLES_PER_SECOND, 1);
	zassert_equal(second.statistics.missed, 0);
	zassert_equal(second.statistics.overruns, 0);
	zassert_true(second.enabled, "disabled by fault %d of component %d", second.fault,
		     second.fault_component);
}

#define RUN 50

static void run_worn(double *outputs)
{
	worn_t *model = worn_instance(0);
	worn_inputs_t in = {0};
	worn_outputs_t out;

	worn_init(model, &in, &out);
	for (int k = 0; k < RUN; k++) {
		worn_step(model, &in, &out);
		outputs[k] = out.worn;
	}
}

/* The model never resets its variables, which Zephyr's linker script places: EPG does. */
ZTEST(jiwy, test_a_model_starts_again)
{
	static double first[RUN], second[RUN];

	run_worn(first);
	zassert_true(first[0] > 0.0 && first[0] < first[RUN - 1]);
	for (int turn = 0; turn < 2; turn++) {
		run_worn(second);
		zassert_mem_equal(first, second, sizeof(first));
	}
}

#if DT_HAS_COMPAT_STATUS_OKAY(epg_qdec_emul)

#include <math.h>

#include <zephyr/drivers/gpio.h>
#include <zephyr/drivers/gpio/gpio_emul.h>

#include <epg/zephyr/pwm_emul.h>
#include <epg/zephyr/qdec_emul.h>

#define TARGET      DT_NODELABEL(epg_jiwy)
/* In the order of the components' names: encoder_pan and pwm_pan are the first of their kind. */
#define ENCODER_PAN DEVICE_DT_GET(DT_PHANDLE_BY_IDX(TARGET, decoders, 0))
#define PWM_PAN     DEVICE_DT_GET(DT_PWMS_CTLR_BY_IDX(TARGET, 0))
#define CHANNEL_PAN DT_PWMS_CHANNEL_BY_IDX(TARGET, 0)

#define RAD_PER_COUNT (3.14159265358979323846 / 1112)

static uint32_t high_time(void)
{
	uint32_t period = 0;
	uint32_t high = 0;

	zassert_ok(epg_pwm_emul_get(PWM_PAN, CHANNEL_PAN, &period, &high));
	zassert_equal(period, 6250, "20 kHz of 125 MHz are 6250 clocks, not %u", period);

	return high;
}

/* The target's direction pins that are high now. */
static unsigned int pins_high(void)
{
	static const struct gpio_dt_spec pins[] = {
		DT_FOREACH_PROP_ELEM_SEP(TARGET, gpios, GPIO_DT_SPEC_GET_BY_IDX, (,))};
	unsigned int count = 0;

	ARRAY_FOR_EACH(pins, i) {
		count += gpio_emul_output_get(pins[i].port, pins[i].pin) > 0 ? 1 : 0;
	}

	return count;
}

static double position_pan(void)
{
	double value = 0.0;

	(void)jiwy_get_position_pan(&value); /* the first call requests the values of the next cycle */
	(void)status_after(K_MSEC(3));
	zassert_true(jiwy_get_position_pan(&value));

	return value;
}

ZTEST(jiwy, test_encoder)
{
	const double before = position_pan();

	epg_qdec_emul_move(ENCODER_PAN, 100);
	zassert_true(fabs(position_pan() - before - 100 * RAD_PER_COUNT) < 1e-9);
	epg_qdec_emul_move(ENCODER_PAN, -150);
	zassert_true(fabs(position_pan() - before + 50 * RAD_PER_COUNT) < 1e-9);
}

/* Homing drives both axes.  While the target is disabled, no output is driven. */
ZTEST(jiwy, test_outputs)
{
	zassert_true(status_after(K_MSEC(3)).enabled);
	zexpect_within(high_time(), 6250 / 20, 5);
	zexpect_equal(pins_high(), 2);
	jiwy_enable(false);
	zassert_false(status_after(K_MSEC(3)).enabled);
	zexpect_equal(high_time(), 0);
	zexpect_equal(pins_high(), 0);
	jiwy_enable(true);
	zassert_true(status_after(K_MSEC(3)).enabled);
	zexpect_not_equal(high_time(), 0);
}

/* After a stop, outputs are safe and no cycle runs.  A later start is like the first start. */
ZTEST(jiwy, test_stop_and_start)
{
	(void)status_after(K_MSEC(3));
	for (int turn = 0; turn < 20; turn++) {
		epg_status_t status;

		zassert_true(jiwy_stop());
		zassert_true(jiwy_stop(), "there is nothing to stop");
		zexpect_equal(high_time(), 0);
		zexpect_equal(pins_high(), 0);
		const uint32_t cycles = status_after(K_NO_WAIT).statistics.cycles;

		zexpect_equal(status_after(K_MSEC(5)).statistics.cycles, cycles);
		zassert_true(jiwy_start());
		zassert_false(jiwy_start(), "it runs already");
		jiwy_enable(true);
		status = status_after(K_USEC(3000 + 370 * turn));
		zexpect_true(status.enabled);
		zexpect_equal(status.fault, EPG_FAULT_NONE);
		zexpect_equal(status.statistics.missed, 0);
		zexpect_within(status.statistics.cycles, 3 + 370 * turn / 1000, 1);
		zexpect_not_equal(high_time(), 0);
	}
}

static bool stopped_in_interrupt;

static void stop_in_interrupt(struct k_timer *timer)
{
	ARG_UNUSED(timer);
	stopped_in_interrupt = jiwy_stop();
}

/* An interrupt cannot wait for the end of a thread: the call fails, and the target continues. */
ZTEST(jiwy, test_stop_in_an_interrupt_is_refused)
{
	static K_TIMER_DEFINE(timer, stop_in_interrupt, NULL);

	stopped_in_interrupt = true;
	k_timer_start(&timer, K_MSEC(1), K_NO_WAIT);
	const uint32_t cycles = status_after(K_MSEC(5)).statistics.cycles;

	zassert_false(stopped_in_interrupt);
	zexpect_true(status_after(K_MSEC(5)).enabled);
	zexpect_within(status_after(K_NO_WAIT).statistics.cycles, cycles + 5, 1);
	zassert_false(jiwy_start(), "it runs still");
}

/* A decoder that reports that it has stopped disables the target; the fault is latched. */
ZTEST(jiwy, test_decoder_fails)
{
	epg_status_t status;

	epg_qdec_emul_set_error(ENCODER_PAN, -EIO);
	status = status_after(K_MSEC(3));
	zexpect_false(status.enabled);
	zexpect_str_equal(epg_target_fault(&jiwy_target, status.fault), "sensor");
	zexpect_equal(high_time(), 0);
	epg_qdec_emul_set_error(ENCODER_PAN, 0);
	zexpect_false(status_after(K_MSEC(3)).enabled);
	jiwy_enable(true);
	zexpect_true(status_after(K_MSEC(3)).enabled);
}

/* A PWM that refuses a write disables the target until a reset: its pins are then plain pins. */
ZTEST(jiwy_refused, test_output_fails)
{
	static const struct gpio_dt_spec pan = GPIO_DT_SPEC_GET_BY_IDX(TARGET, gpios, 0);
	gpio_flags_t flags = 0;
	epg_status_t status;

	zassert_true(jiwy_start());
	zassert_true(status_after(K_MSEC(3)).enabled);
	zassert_not_equal(high_time(), 0);
	zassert_ok(gpio_emul_flags_get(pan.port, pan.pin, &flags));
	epg_pwm_emul_set_error(PWM_PAN, -EIO);
	status = status_after(K_MSEC(3));
	zexpect_false(status.enabled);
	zexpect_equal(status.fault, EPG_FAULT_OUTPUT);
	zexpect_not_equal(status.fault_component, EPG_NO_COMPONENT);
	zexpect_ok(gpio_emul_flags_get(pan.port, pan.pin, &flags));
	zexpect_equal(flags & (GPIO_OUTPUT | GPIO_OUTPUT_INIT_LOW),
		      GPIO_OUTPUT | GPIO_OUTPUT_INIT_LOW);
	zexpect_equal(pins_high(), 0);
	epg_pwm_emul_set_error(PWM_PAN, 0);
	jiwy_enable(true);
	for (int i = 0; i < 5; i++) {
		status = status_after(K_MSEC(1));
		zexpect_false(status.enabled);
		zexpect_equal(status.fault, EPG_FAULT_OUTPUT);
	}
	zexpect_equal(pins_high(), 0);
	jiwy_stop();
	zexpect_false(jiwy_start());
}

ZTEST_SUITE(jiwy_refused, NULL, NULL, NULL, NULL, NULL);

#endif

/* Each test begins with a target that was just started. */
static void before(void *fixture)
{
	ARG_UNUSED(fixture);

	zassert_true(jiwy_start());
}

static void after(void *fixture)
{
	ARG_UNUSED(fixture);

	jiwy_stop();
}

ZTEST_SUITE(jiwy, NULL, NULL, before, after, NULL);
