/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

#include <inttypes.h>
#include <stdint.h>
#include <stdlib.h>

#include <zephyr/device.h>
#include <zephyr/drivers/sensor.h>
#include <zephyr/kernel.h>
#include <zephyr/sys/printk.h>

#include <epg/zephyr/qdec.h>

#define PERIOD K_MSEC(100)

static const struct device *const qdec = DEVICE_DT_GET(DT_ALIAS(qdec0));

#if DT_NODE_HAS_COMPAT(DT_ALIAS(qdec0), epg_qdec_emul)
#include <epg/zephyr/qdec_emul.h>

/* The emulated shaft turns backwards: three counts per millisecond. */
static void turn(struct k_timer *timer)
{
	ARG_UNUSED(timer);

	epg_qdec_emul_move(qdec, -3);
}

static K_TIMER_DEFINE(shaft, turn, NULL);
#endif

static int show(void)
{
	struct sensor_value angle;
	int64_t count;
	int ret;

	ret = epg_qdec_get_count(qdec, &count);
	if (ret < 0) {
		return ret;
	}

	ret = sensor_sample_fetch(qdec);
	if (ret < 0) {
		return ret;
	}

	ret = sensor_channel_get(qdec, SENSOR_CHAN_ROTATION, &angle);
	if (ret < 0) {
		return ret;
	}

	/* val1 and val2 both have the sign of the angle: print the sign once. */
	printk("count %" PRId64 ", angle %s%d.%06d degrees\n", count,
	       angle.val1 < 0 || angle.val2 < 0 ? "-" : "", abs(angle.val1), abs(angle.val2));

	return 0;
}

int main(void)
{
	int ret;

	if (!device_is_ready(qdec)) {
		printk("%s is not ready\n", qdec->name);
		return 0;
	}

	/* The present position of the shaft becomes 0. */
	ret = epg_qdec_set_count(qdec, 0);
	if (ret < 0) {
		printk("%s cannot be preset (%d)\n", qdec->name, ret);
		return 0;
	}

#if DT_NODE_HAS_COMPAT(DT_ALIAS(qdec0), epg_qdec_emul)
	k_timer_start(&shaft, K_MSEC(1), K_MSEC(1));
#endif

	while (true) {
		ret = show();
		if (ret < 0) {
			printk("%s cannot be read (%d)\n", qdec->name, ret);
		}
		k_sleep(PERIOD);
	}

	return 0;
}
