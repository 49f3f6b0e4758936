/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief Common part of the drivers of quadrature decoders: a count of 64 bits
 *
 * The hardware's counter has fewer bits and wraps. Each update reads it, and adds its movement
 * since the last update to the count. A driver must provide a function that reads the counter. It
 * must also call qdec_common_update() from an interrupt or a timer before the counter has moved by
 * half of its range, so that the direction of the movement is unambiguous.
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

/** Constants of one decoder. Must be the first member of the driver's configuration. */
struct qdec_common_config {
	/**
	 * Reads the counter. Its unused upper bits may have any value. If the hardware has noticed
	 * that both phases changed at once, it also adds 1 to qdec_common_data.skipped. It is
	 * called with the lock held, and only while the device runs. Returns 0, or a negative error
	 * number.
	 */
	int (*read)(const struct device *dev, uint32_t *counter);
	/** Edges of both phases in one revolution of the shaft, at least 1. */
	uint32_t counts_per_revolution;
	/** Width of the counter: 16 or 32. */
	uint8_t counter_bits;
	/** True if the count must fall while phase A leads phase B. */
	bool invert;
	/** True if the hardware notices that both phases change at once. */
	bool notices_skips;
};

/** State of one decoder. Must be the first member of the driver's data. */
struct qdec_common_data {
	/** Protects all members. */
	struct k_spinlock lock;
	/** Count at the last update. */
	int64_t count;
	/** Count at the last fetch. */
	int64_t fetched;
	/** The hardware's counter at the last update. */
	uint32_t counter;
	/** Number of times that both phases changed at once. */
	uint32_t skipped;
	/** False while the device is suspended. */
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

/**
 * Reads the counter and updates the count. A driver calls it from its interrupt or timer.
 *
 * Returns 0, or a negative error number.
 */
int qdec_common_update(const struct device *dev);

/**
 * Starts counting after the driver has started the hardware. The present value of the counter is
 * the beginning; the count is kept from before qdec_common_stop().
 *
 * Returns 0, or the error of the driver's read function.
 */
int qdec_common_start(const struct device *dev);

/**
 * Updates the count a last time, and stops. Until qdec_common_start() the hardware is not accessed,
 * and reads of the count return -EHOSTDOWN.
 */
void qdec_common_stop(const struct device *dev);

/** Sensor API of all decoders. epg_qdec_get_count() recognises a decoder by its address. */
extern const struct sensor_driver_api qdec_common_driver_api;

#endif /* EPG_ZEPHYR_DRIVERS_SENSOR_QDEC_COMMON_H_ */
