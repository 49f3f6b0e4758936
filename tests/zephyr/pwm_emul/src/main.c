/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

#include <errno.h>
#include <stdint.h>

#include <zephyr/device.h>
#include <zephyr/drivers/pwm.h>
#include <zephyr/ztest.h>

#include <epg/zephyr/pwm_emul.h>

static const struct device *const narrow = DEVICE_DT_GET(DT_NODELABEL(narrow));
static const struct device *const wide = DEVICE_DT_GET(DT_NODELABEL(wide));
static const struct pwm_dt_spec motor = PWM_DT_SPEC_GET(DT_CHILD(DT_NODELABEL(user), motor));

static void expect_output(const struct device *dev, uint32_t channel, uint32_t period,
			  uint32_t high)
{
	uint32_t period_found = 0x55555555;
	uint32_t high_found = 0x55555555;

	zassert_ok(epg_pwm_emul_get(dev, channel, &period_found, &high_found));
	zexpect_equal(period_found, period, "a period of %u, not %u", period_found, period);
	zexpect_equal(high_found, high, "high for %u, not %u", high_found, high);
}

static void before(void *fixture)
{
	ARG_UNUSED(fixture);

	zassert_true(device_is_ready(narrow));
	zassert_true(device_is_ready(wide));
	epg_pwm_emul_set_error(narrow, 0);
}

/* The name makes this test run first. */
ZTEST(pwm_emul, test_a_nothing_is_set_at_the_start)
{
	expect_output(narrow, 0, 0, 0);
	expect_output(narrow, 1, 0, 0);
	zexpect_equal(epg_pwm_emul_writes(narrow, 0), 0);
}

ZTEST(pwm_emul, test_remembers_each_channel)
{
	const uint32_t writes = epg_pwm_emul_writes(narrow, 0);

	zassert_ok(pwm_set_cycles(narrow, 0, 6250, 1563, 0));
	zassert_ok(pwm_set_cycles(narrow, 1, 1000, 1000, PWM_POLARITY_NORMAL));
	expect_output(narrow, 0, 6250, 1563);
	expect_output(narrow, 1, 1000, 1000);
	zassert_ok(pwm_set_cycles(narrow, 0, 6250, 0, 0));
	expect_output(narrow, 0, 6250, 0);
	expect_output(narrow, 1, 1000, 1000);
	zexpect_equal(epg_pwm_emul_writes(narrow, 0), writes + 2);
}

ZTEST(pwm_emul, test_polarity)
{
	zassert_ok(pwm_set_cycles(narrow, 0, 100, 30, PWM_POLARITY_INVERTED));
	expect_output(narrow, 0, 100, 70);
}

/* 50 us of a clock of 125 MHz, from the devicetree. */
ZTEST(pwm_emul, test_specifier)
{
	zassert_true(pwm_is_ready_dt(&motor));
	zassert_ok(pwm_set_pulse_dt(&motor, PWM_USEC(10)));
	expect_output(narrow, 1, 6250, 5000);
}

ZTEST(pwm_emul, test_clock)
{
	uint64_t cycles = 0;

	zassert_ok(pwm_get_cycles_per_sec(wide, 0, &cycles));
	zexpect_equal(cycles, 1000000);
	zexpect_equal(pwm_get_cycles_per_sec(wide, 1, &cycles), -EINVAL);
}

ZTEST(pwm_emul, test_range_of_the_counter)
{
	zassert_ok(pwm_set_cycles(narrow, 0, 65536, 65536, 0));
	expect_output(narrow, 0, 65536, 65536);
	zexpect_equal(pwm_set_cycles(narrow, 0, 65537, 1, 0), -EINVAL);
	expect_output(narrow, 0, 65536, 65536);
	zassert_ok(pwm_set_cycles(wide, 0, UINT32_MAX, 65537, 0));
	expect_output(wide, 0, UINT32_MAX, 65537);
}

ZTEST(pwm_emul, test_no_such_channel)
{
	uint32_t period;
	uint32_t high;

	zexpect_equal(pwm_set_cycles(narrow, 2, 100, 1, 0), -EINVAL);
	zexpect_equal(epg_pwm_emul_get(narrow, 2, &period, &high), -EINVAL);
	zexpect_equal(epg_pwm_emul_writes(narrow, 2), 0);
}

ZTEST(pwm_emul, test_errors)
{
	zassert_ok(pwm_set_cycles(narrow, 0, 100, 30, 0));
	epg_pwm_emul_set_error(narrow, -EIO);
	zexpect_equal(pwm_set_cycles(narrow, 0, 100, 50, 0), -EIO);
	expect_output(narrow, 0, 100, 30);
}

ZTEST_SUITE(pwm_emul, NULL, NULL, before, NULL, NULL);
