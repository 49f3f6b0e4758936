/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

#include <errno.h>
#include <stdint.h>

#include <zephyr/device.h>
#include <zephyr/drivers/sensor.h>
#include <zephyr/kernel.h>
#include <zephyr/pm/device.h>
#include <zephyr/ztest.h>

#include <epg/zephyr/qdec.h>
#include <epg/zephyr/qdec_emul.h>

static const struct device *const qdec16 = DEVICE_DT_GET(DT_NODELABEL(qdec16));
static const struct device *const qdec32 = DEVICE_DT_GET(DT_NODELABEL(qdec32));
static const struct device *const inverted = DEVICE_DT_GET(DT_NODELABEL(inverted));
static const struct device *const odd = DEVICE_DT_GET(DT_NODELABEL(odd));
static const struct device *const fine = DEVICE_DT_GET(DT_NODELABEL(fine));

static void preset(const struct device *dev, int64_t count)
{
	zassert_ok(epg_qdec_set_count(dev, count));
}

static int64_t count_of(const struct device *dev)
{
	int64_t count = 0x5555555555555555;

	zassert_ok(epg_qdec_get_count(dev, &count));

	return count;
}

static void expect_angle(const struct device *dev, int32_t degrees, int32_t micro_degrees)
{
	struct sensor_value angle;

	zassert_ok(sensor_sample_fetch(dev));
	zassert_ok(sensor_channel_get(dev, SENSOR_CHAN_ROTATION, &angle));
	zexpect_equal(angle.val1, degrees, "%d degrees, not %d", angle.val1, degrees);
	zexpect_equal(angle.val2, micro_degrees, "%d micro-degrees, not %d", angle.val2,
		      micro_degrees);
}

static void before(void *fixture)
{
	const struct device *const all[] = {qdec16, qdec32, inverted, odd, fine};

	ARG_UNUSED(fixture);

	ARRAY_FOR_EACH(all, i) {
		zassert_true(device_is_ready(all[i]));
		epg_qdec_emul_set_error(all[i], 0);
		preset(all[i], 0);
	}
}

ZTEST(qdec_angle, test_fractions)
{
	expect_angle(qdec16, 0, 0);
	epg_qdec_emul_move(qdec16, 1);
	expect_angle(qdec16, 0, 180000);
	epg_qdec_emul_move(qdec16, 5);
	expect_angle(qdec16, 1, 80000);
}

ZTEST(qdec_angle, test_full_turns)
{
	epg_qdec_emul_move(qdec16, 2000);
	expect_angle(qdec16, 360, 0);
	epg_qdec_emul_move(qdec16, 2000 * 99 + 1);
	expect_angle(qdec16, 36000, 180000);
}

ZTEST(qdec_angle, test_negative_angles)
{
	epg_qdec_emul_move(qdec16, -1);
	expect_angle(qdec16, 0, -180000);
	epg_qdec_emul_move(qdec16, -2500);
	expect_angle(qdec16, -450, -180000);
	epg_qdec_emul_move(qdec16, 2502);
	expect_angle(qdec16, 0, 180000);
}

ZTEST(qdec_angle, test_thirds_are_cut_towards_zero)
{
	epg_qdec_emul_move(odd, 1);
	expect_angle(odd, 51, 428571);
	epg_qdec_emul_move(odd, -2);
	expect_angle(odd, -51, -428571);
	epg_qdec_emul_move(odd, 1 + 7 * 3 + 6);
	expect_angle(odd, 1388, 571428);
}

ZTEST(qdec_angle, test_no_intermediate_overflow)
{
	/* 360 * 10^6 times the count does not fit into 64 bits. */
	preset(fine, INT64_C(0x7fffffff) * 1000 + 0x7ffffffe);
	expect_angle(fine, 360359, 999999);
	preset(fine, -(INT64_C(0x7fffffff) * 1000 + 0x7ffffffe));
	expect_angle(fine, -360359, -999999);
}

ZTEST(qdec_angle, test_largest_angle)
{
	struct sensor_value angle;

	/* 2147483647 degrees are 5965232 turns and 127 degrees: 127 * 7 / 360 = 2.47 counts. */
	preset(odd, INT64_C(5965232) * 7 + 2);
	expect_angle(odd, 2147483622, 857142);
	preset(odd, -(INT64_C(5965232) * 7 + 2));
	expect_angle(odd, -2147483622, -857142);

	preset(odd, INT64_C(5965232) * 7 + 3);
	zassert_ok(sensor_sample_fetch(odd));
	zexpect_equal(sensor_channel_get(odd, SENSOR_CHAN_ROTATION, &angle), -ERANGE);
	preset(odd, INT64_MIN);
	zassert_ok(sensor_sample_fetch(odd));
	zexpect_equal(sensor_channel_get(odd, SENSOR_CHAN_ROTATION, &angle), -ERANGE);
}

ZTEST(qdec_angle, test_get_shows_the_last_fetch)
{
	struct sensor_value angle;

	zassert_ok(sensor_sample_fetch(qdec16));
	epg_qdec_emul_move(qdec16, 100);
	zassert_ok(sensor_channel_get(qdec16, SENSOR_CHAN_ROTATION, &angle));
	zexpect_equal(angle.val1, 0);
	zassert_equal(count_of(qdec16), 100);
	zassert_ok(sensor_channel_get(qdec16, SENSOR_CHAN_ROTATION, &angle));
	zexpect_equal(angle.val1, 0);
	zassert_ok(sensor_sample_fetch_chan(qdec16, SENSOR_CHAN_ROTATION));
	zassert_ok(sensor_channel_get(qdec16, SENSOR_CHAN_ROTATION, &angle));
	zexpect_equal(angle.val1, 18);
}

ZTEST(qdec_angle, test_other_channels_are_refused)
{
	struct sensor_value value = {0};

	zexpect_equal(sensor_sample_fetch_chan(qdec16, SENSOR_CHAN_RPM), -ENOTSUP);
	zexpect_equal(sensor_channel_get(qdec16, SENSOR_CHAN_RPM, &value), -ENOTSUP);
	zexpect_equal(sensor_channel_get(qdec16, SENSOR_CHAN_ALL, &value), -ENOTSUP);
	zexpect_equal(sensor_attr_get(qdec16, SENSOR_CHAN_RPM,
				      (enum sensor_attribute)SENSOR_ATTR_EPG_QDEC_SKIPPED, &value),
		      -ENOTSUP);
	zexpect_equal(sensor_attr_get(qdec16, SENSOR_CHAN_ROTATION, SENSOR_ATTR_OFFSET, &value),
		      -ENOTSUP);
	zexpect_equal(sensor_attr_set(qdec16, SENSOR_CHAN_ROTATION,
				      (enum sensor_attribute)SENSOR_ATTR_EPG_QDEC_SKIPPED, &value),
		      -ENOSYS);
}

ZTEST(qdec_angle, test_other_devices_have_no_count)
{
	static const struct device other = {.name = "other"};
	int64_t count = 7;

	zexpect_equal(epg_qdec_get_count(&other, &count), -ENOTSUP);
	zexpect_equal(epg_qdec_set_count(&other, 0), -ENOTSUP);
	zexpect_equal(count, 7);
}

ZTEST(qdec_count, test_every_wrap_is_counted_when_nobody_reads)
{
	const uint32_t interrupts = epg_qdec_emul_interrupts(qdec16);

	epg_qdec_emul_move(qdec16, 10000001);
	zexpect_equal(count_of(qdec16), 10000001);
	epg_qdec_emul_move(qdec16, -30000003);
	zexpect_equal(count_of(qdec16), -20000002);
	/* An interrupt after a quarter of 65536 counts each. */
	zexpect_equal(epg_qdec_emul_interrupts(qdec16) - interrupts, 40000004 / 16384);
}

ZTEST(qdec_count, test_wraps_of_32_bits)
{
	epg_qdec_emul_move(qdec32, INT64_C(3) << 32);
	zexpect_equal(count_of(qdec32), INT64_C(3) << 32);
	epg_qdec_emul_move(qdec32, -(INT64_C(7) << 32) - 5);
	zexpect_equal(count_of(qdec32), -(INT64_C(4) << 32) - 5);
}

ZTEST(qdec_count, test_trembling_at_a_wrap_does_not_interrupt)
{
	const uint32_t interrupts = epg_qdec_emul_interrupts(qdec16);

	for (int i = 0; i < 1000; i++) {
		epg_qdec_emul_move(qdec16, 1);
		epg_qdec_emul_move(qdec16, -2);
		epg_qdec_emul_move(qdec16, 1);
	}
	zexpect_equal(epg_qdec_emul_interrupts(qdec16), interrupts);
	zexpect_equal(count_of(qdec16), 0);
}

ZTEST(qdec_count, test_random_walk)
{
	uint32_t random = 1;
	int64_t truth = 0;

	for (int i = 0; i < 100000; i++) {
		/* The generator of Numerical Recipes; its upper bits are random enough. */
		random = random * 1664525U + 1013904223U;
		const int32_t step = (int32_t)random >> 14;

		epg_qdec_emul_move(qdec16, step);
		truth += step;
		if ((random & 0x700) == 0) {
			zassert_equal(count_of(qdec16), truth);
		}
	}
	zassert_equal(count_of(qdec16), truth);
}

ZTEST(qdec_count, test_presets)
{
	const int64_t counts[] = {0, 1, -1, 123456789, INT64_C(1) << 32, -(INT64_C(1) << 32),
				  INT64_C(0x123456789abcdef0), INT64_MAX - 1, INT64_MIN + 1};

	ARRAY_FOR_EACH(counts, i) {
		preset(qdec16, counts[i]);
		zexpect_equal(count_of(qdec16), counts[i]);
		epg_qdec_emul_move(qdec16, 1);
		zexpect_equal(count_of(qdec16), counts[i] + 1);
		epg_qdec_emul_move(qdec16, -2);
		zexpect_equal(count_of(qdec16), counts[i] - 1);
	}
}

ZTEST(qdec_count, test_edges_before_a_preset_do_not_count_after_it)
{
	epg_qdec_emul_move(qdec16, 777);
	preset(qdec16, 5);
	zexpect_equal(count_of(qdec16), 5);
	epg_qdec_emul_move(qdec16, 70000);
	zexpect_equal(count_of(qdec16), 70005);
}

ZTEST(qdec_count, test_a_preset_leaves_the_fetched_sample)
{
	struct sensor_value angle;

	epg_qdec_emul_move(qdec16, 500);
	zassert_ok(sensor_sample_fetch(qdec16));
	preset(qdec16, 0);
	zassert_ok(sensor_channel_get(qdec16, SENSOR_CHAN_ROTATION, &angle));
	zexpect_equal(angle.val1, 90);
	expect_angle(qdec16, 0, 0);
}

ZTEST(qdec_count, test_invert)
{
	epg_qdec_emul_move(inverted, 100000);
	zexpect_equal(count_of(inverted), -100000);
	expect_angle(inverted, -18000, 0);
	preset(inverted, 10);
	epg_qdec_emul_move(inverted, -1);
	zexpect_equal(count_of(inverted), 11);
}

ZTEST(qdec_count, test_errors_of_the_hardware_are_reported)
{
	struct sensor_value angle;
	int64_t count = 4711;

	epg_qdec_emul_move(qdec16, 2000);
	zassert_ok(sensor_sample_fetch(qdec16));
	epg_qdec_emul_move(qdec16, 10);
	epg_qdec_emul_set_error(qdec16, -EIO);
	zexpect_equal(sensor_sample_fetch(qdec16), -EIO);
	zexpect_equal(epg_qdec_get_count(qdec16, &count), -EIO);
	zexpect_equal(count, 4711, "an error must not touch the caller's count");
	zexpect_equal(epg_qdec_set_count(qdec16, 0), -EIO);
	zassert_ok(sensor_channel_get(qdec16, SENSOR_CHAN_ROTATION, &angle));
	zexpect_equal(angle.val1, 360);

	epg_qdec_emul_set_error(qdec16, 0);
	zexpect_equal(count_of(qdec16), 2010);
}

ZTEST(qdec_count, test_skipped)
{
	struct sensor_value first;
	struct sensor_value then;
	const enum sensor_attribute skipped = (enum sensor_attribute)SENSOR_ATTR_EPG_QDEC_SKIPPED;

	zassert_ok(sensor_attr_get(qdec16, SENSOR_CHAN_ROTATION, skipped, &first));
	zassert_ok(sensor_attr_get(qdec16, SENSOR_CHAN_ROTATION, skipped, &then));
	zexpect_equal(then.val1, first.val1);
	epg_qdec_emul_skip(qdec16);
	zassert_ok(sensor_attr_get(qdec16, SENSOR_CHAN_ROTATION, skipped, &then));
	zexpect_equal(then.val1, first.val1 + 1);
	zexpect_equal(count_of(qdec16), 0);
}

static struct k_timer mover;
static int64_t moved;

static void move(struct k_timer *timer)
{
	ARG_UNUSED(timer);

	epg_qdec_emul_move(qdec16, 20011);
	moved += 20011;
}

ZTEST(qdec_count, test_edges_in_interrupts_beside_reads_in_a_thread)
{
	int64_t last = 0;

	moved = 0;
	k_timer_init(&mover, move, NULL);
	k_timer_start(&mover, K_MSEC(1), K_MSEC(1));
	for (int i = 0; i < 500; i++) {
		const int64_t count = count_of(qdec16);

		zassert_true(count >= last && count <= moved);
		last = count;
		k_busy_wait(777);
	}
	k_timer_stop(&mover);
	zexpect_true(moved > 20011 * 100);
	zexpect_equal(count_of(qdec16), moved);
}

#ifdef CONFIG_PM_DEVICE
ZTEST(qdec_pm, test_suspended_devices_do_not_count)
{
	int64_t count;

	epg_qdec_emul_move(qdec16, 1234);
	zassert_ok(pm_device_action_run(qdec16, PM_DEVICE_ACTION_SUSPEND));
	zexpect_equal(epg_qdec_get_count(qdec16, &count), -EHOSTDOWN);
	zexpect_equal(epg_qdec_set_count(qdec16, 0), -EHOSTDOWN);
	zexpect_equal(sensor_sample_fetch(qdec16), -EHOSTDOWN);
	epg_qdec_emul_move(qdec16, 5000);
	zassert_ok(pm_device_action_run(qdec16, PM_DEVICE_ACTION_RESUME));
	zexpect_equal(count_of(qdec16), 1234);
	epg_qdec_emul_move(qdec16, -70000);
	zexpect_equal(count_of(qdec16), 1234 - 70000);
}
#endif

ZTEST_SUITE(qdec_angle, NULL, NULL, before, NULL, NULL);
ZTEST_SUITE(qdec_count, NULL, NULL, before, NULL, NULL);
#ifdef CONFIG_PM_DEVICE
ZTEST_SUITE(qdec_pm, NULL, NULL, before, NULL, NULL);
#endif
