/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

#define DT_DRV_COMPAT epg_pwm_emul

#include <errno.h>

#include <zephyr/drivers/pwm.h>
#include <zephyr/spinlock.h>
#include <zephyr/sys/util.h>

#include <epg/zephyr/pwm_emul.h>

struct pwm_emul_channel {
	uint32_t period;
	uint32_t high;
	uint32_t writes;
};

struct pwm_emul_config {
	uint32_t clock_frequency;
	uint32_t period_max;
	uint32_t channel_count;
	struct pwm_emul_channel *channels;
};

struct pwm_emul_data {
	struct k_spinlock lock;
	int error;
};

static int pwm_emul_set_cycles(const struct device *dev, uint32_t channel, uint32_t period,
			       uint32_t pulse, pwm_flags_t flags)
{
	const struct pwm_emul_config *config = dev->config;
	struct pwm_emul_data *data = dev->data;
	int error = 0;

	if (channel >= config->channel_count || period > config->period_max) {
		return -EINVAL;
	}

	K_SPINLOCK(&data->lock) {
		error = data->error;
		if (error == 0) {
			struct pwm_emul_channel *output = &config->channels[channel];

			output->period = period;
			output->high = (flags & PWM_POLARITY_INVERTED) != 0 ? period - pulse : pulse;
			output->writes++;
		}
	}

	return error;
}

static int pwm_emul_get_cycles_per_sec(const struct device *dev, uint32_t channel, uint64_t *cycles)
{
	const struct pwm_emul_config *config = dev->config;

	if (channel >= config->channel_count) {
		return -EINVAL;
	}

	*cycles = config->clock_frequency;

	return 0;
}

int epg_pwm_emul_get(const struct device *dev, uint32_t channel, uint32_t *period, uint32_t *high)
{
	const struct pwm_emul_config *config = dev->config;
	struct pwm_emul_data *data = dev->data;

	if (channel >= config->channel_count) {
		return -EINVAL;
	}

	K_SPINLOCK(&data->lock) {
		*period = config->channels[channel].period;
		*high = config->channels[channel].high;
	}

	return 0;
}

uint32_t epg_pwm_emul_writes(const struct device *dev, uint32_t channel)
{
	const struct pwm_emul_config *config = dev->config;

	return channel < config->channel_count ? config->channels[channel].writes : 0;
}

void epg_pwm_emul_set_error(const struct device *dev, int error)
{
	struct pwm_emul_data *data = dev->data;

	data->error = error;
}

static DEVICE_API(pwm, pwm_emul_driver_api) = {
	.set_cycles = pwm_emul_set_cycles,
	.get_cycles_per_sec = pwm_emul_get_cycles_per_sec,
};

#define PWM_EMUL_INIT(n)                                                                           \
	BUILD_ASSERT(DT_INST_PROP(n, channels) >= 1, "channels must be 1 or more");                \
	BUILD_ASSERT(DT_INST_PROP(n, clock_frequency) >= 1, "clock-frequency must be 1 or more");  \
	static struct pwm_emul_channel pwm_emul_channels_##n[DT_INST_PROP(n, channels)];           \
	static const struct pwm_emul_config pwm_emul_config_##n = {                                \
		.clock_frequency = DT_INST_PROP(n, clock_frequency),                               \
		.period_max = (uint32_t)MIN(BIT64(DT_INST_PROP(n, counter_bits)), UINT32_MAX),     \
		.channel_count = DT_INST_PROP(n, channels),                                        \
		.channels = pwm_emul_channels_##n,                                                 \
	};                                                                                         \
	static struct pwm_emul_data pwm_emul_data_##n;                                             \
	DEVICE_DT_INST_DEFINE(n, NULL, NULL, &pwm_emul_data_##n, &pwm_emul_config_##n,             \
			      POST_KERNEL, CONFIG_PWM_INIT_PRIORITY, &pwm_emul_driver_api);

DT_INST_FOREACH_STATUS_OKAY(PWM_EMUL_INIT)
