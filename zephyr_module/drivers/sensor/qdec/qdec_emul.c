/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

#define DT_DRV_COMPAT epg_qdec_emul

#include <errno.h>

#include <zephyr/pm/device.h>

#include <epg/zephyr/qdec_emul.h>

#include "qdec_common.h"

struct qdec_emul_config {
	struct qdec_common_config common;
};

struct qdec_emul_data {
	struct qdec_common_data common;
	/* The emulated hardware: its counter, and the edges in each direction until it interrupts. */
	uint32_t register_value;
	int64_t to_upper_compare;
	int64_t to_lower_compare;
	uint32_t interrupts;
	bool powered;
	bool skipped_flag;
	int error;
};

static int qdec_emul_read(const struct device *dev, uint32_t *counter)
{
	const struct qdec_emul_config *config = dev->config;
	struct qdec_emul_data *data = dev->data;
	const int64_t quarter = 1LL << (config->common.counter_bits - 2);

	if (data->error < 0) {
		return data->error;
	}

	if (data->skipped_flag) {
		data->skipped_flag = false;
		data->common.skipped++;
	}

	*counter = data->register_value;
	data->to_upper_compare = quarter;
	data->to_lower_compare = quarter;

	return 0;
}

void epg_qdec_emul_move(const struct device *dev, int64_t edges)
{
	const struct qdec_emul_config *config = dev->config;
	struct qdec_emul_data *data = dev->data;
	const uint32_t mask = BIT64_MASK(config->common.counter_bits);

	while (edges != 0 && data->powered) {
		bool interrupt = false;

		K_SPINLOCK(&data->common.lock) {
			const int64_t step =
				CLAMP(edges, -data->to_lower_compare, data->to_upper_compare);

			data->register_value = (data->register_value + (uint32_t)step) & mask;
			data->to_upper_compare -= step;
			data->to_lower_compare += step;
			edges -= step;
			interrupt = data->to_upper_compare == 0 || data->to_lower_compare == 0;
			if (interrupt) {
				data->interrupts++;
			}
		}

		if (interrupt && qdec_common_update(dev) < 0) {
			/* The interrupt was not served: the next match is a whole range away. */
			data->to_upper_compare = data->to_lower_compare = mask;
		}
	}
}

void epg_qdec_emul_skip(const struct device *dev)
{
	struct qdec_emul_data *data = dev->data;

	data->skipped_flag = true;
}

void epg_qdec_emul_set_error(const struct device *dev, int error)
{
	struct qdec_emul_data *data = dev->data;

	data->error = error;
}

uint32_t epg_qdec_emul_interrupts(const struct device *dev)
{
	const struct qdec_emul_data *data = dev->data;

	return data->interrupts;
}

static int qdec_emul_pm_action(const struct device *dev, enum pm_device_action action)
{
	struct qdec_emul_data *data = dev->data;

	switch (action) {
	case PM_DEVICE_ACTION_RESUME:
		data->register_value = 0;
		data->powered = true;
		return qdec_common_start(dev);
	case PM_DEVICE_ACTION_SUSPEND:
		qdec_common_stop(dev);
		data->powered = false;
		return 0;
	default:
		return -ENOTSUP;
	}
}

static int qdec_emul_init(const struct device *dev)
{
	return pm_device_driver_init(dev, qdec_emul_pm_action);
}

#define QDEC_EMUL_INIT(n)                                                                          \
	QDEC_COMMON_ASSERT_DT_INST(n);                                                             \
	static const struct qdec_emul_config qdec_emul_config_##n = {                              \
		.common = QDEC_COMMON_CONFIG_DT_INST(n, qdec_emul_read,                            \
						     DT_INST_PROP(n, counter_bits), true),         \
	};                                                                                         \
	static struct qdec_emul_data qdec_emul_data_##n;                                           \
	PM_DEVICE_DT_INST_DEFINE(n, qdec_emul_pm_action);                                          \
	SENSOR_DEVICE_DT_INST_DEFINE(n, qdec_emul_init, PM_DEVICE_DT_INST_GET(n),                  \
				     &qdec_emul_data_##n, &qdec_emul_config_##n, POST_KERNEL,      \
				     CONFIG_SENSOR_INIT_PRIORITY, &qdec_common_driver_api);

DT_INST_FOREACH_STATUS_OKAY(QDEC_EMUL_INIT)
