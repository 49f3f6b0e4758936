/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief What quadrature decoders have in common: counts of 64 bits out of a narrower counter
 *
 * A driver gives a function that reads the hardware's counter, and sees to it that somebody calls
 * qdec_common_update() before the counter has moved by half its range.
 */

#ifndef EPG_ZEPHYR_DRIVERS_SENSOR_QDEC_COMMON_H_
#define EPG_ZEPHYR_DRIVERS_SENSOR_QDEC_COMMON_H_

#include <stdbool.h>
#include <stdint.h>

#include <zephyr/device.h>
#include <zephyr/devicetree.h>
#include <zephyr/drivers/sensor.h>
#include <zephyr/spinlock.h>
#include <zephyr/sys/util.h>

/** First member of a driver's configuration. */
struct qdec_common_config {
	/**
	 * Reads the counter, with its unused upper bits as they are, and counts up
	 * qdec_common_data.skipped. Called with the lock held and while the device runs only.
	 */
	int (*read)(const struct device *dev, uint32_t *counter);
	uint32_t counts_per_revolution;
	/** Width of the counter: 16 or 32. */
	uint8_t counter_bits;
	bool invert;
	/** Whether the hardware notices that both phases change at once. */
	bool notices_skips;
};

/** First member of a driver's data. */
struct qdec_common_data {
	struct k_spinlock lock;
	/** Count at the last update. */
	int64_t count;
	/** Count at the last fetch. */
	int64_t fetched;
	/** The hardware's counter at the last update. */
	uint32_t counter;
	uint32_t skipped;
	bool running;
};

#define QDEC_COMMON_CONFIG_DT_INST(inst, read_fn, bits, skips)                                     \
	{                                                                                          \
		.read = read_fn,                                                                   \
		.counts_per_revolution = DT_INST_PROP(inst, counts_per_revolution),                \
		.counter_bits = bits, .invert = DT_INST_PROP(inst, invert),                        \
		.notices_skips = skips,                                                            \
	}

#define QDEC_COMMON_ASSERT_DT_INST(inst)                                                           \
	BUILD_ASSERT(DT_INST_PROP(inst, counts_per_revolution) >= 1 &&                             \
			     DT_INST_PROP(inst, counts_per_revolution) <= INT32_MAX,               \
		     "counts-per-revolution must be 1 or more")

/** Follows the counter; for drivers' interrupts and timers. */
int qdec_common_update(const struct device *dev);

/** The hardware counts from now on, from what its counter shows; the count goes on where it was. */
int qdec_common_start(const struct device *dev);

/**
 * Follows the counter a last time. Until qdec_common_start() the hardware is not touched, and reads
 * are errors.
 */
void qdec_common_stop(const struct device *dev);

/** The API of all decoders: by it epg_qdec_get_count() knows that a device is one. */
extern const struct sensor_driver_api qdec_common_driver_api;

#endif /* EPG_ZEPHYR_DRIVERS_SENSOR_QDEC_COMMON_H_ */
