/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief Quadrature decoders on the PIO of RP2040 and RP2350
 *
 * A PIO block has four state machines: small processors that run a program on the pins without the
 * cores. A state machine here counts every edge. It pushes its 32-bit count into its FIFO whenever
 * the pins do not change, or after 90 cycles at the latest. A read discards the old counts in the
 * FIFO, and waits for the next one.
 *
 * A timer reads the count even if the application does not. Its period is the time of a quarter of
 * the count's range at the highest rate of edges: 85 s at 125 MHz.
 */

#define DT_DRV_COMPAT epg_pico_pio_qdec

#include <errno.h>

#include <zephyr/device.h>
#include <zephyr/drivers/misc/pio_rpi_pico/pio_rpi_pico.h>
#include <zephyr/drivers/pinctrl.h>
#include <zephyr/kernel.h>
#include <zephyr/logging/log.h>
#include <zephyr/pm/device.h>

#include <hardware/clocks.h>
#include <hardware/pio.h>

#include <epg/pico_quadrature_program.h>

#include "qdec_common.h"

LOG_MODULE_REGISTER(epg_qdec_pico_pio, CONFIG_SENSOR_LOG_LEVEL);

/* Polling the FIFO this number of times takes longer than the longest time between two pushes. */
#define QDEC_PICO_PIO_POLLS 32U

struct qdec_pico_pio_config {
	struct qdec_common_config common;
	const struct device *piodev;
	const struct pinctrl_dev_config *pincfg;
	uint8_t lower_pin;
};

struct qdec_pico_pio_data {
	struct qdec_common_data common;
	struct k_timer timer;
	const struct device *dev;
	PIO pio;
	size_t sm;
};

static const struct pio_program qdec_pico_pio_program = {
	.instructions = epg_pico_quadrature_count_program,
	.length = EPG_PICO_QUADRATURE_COUNT_LENGTH,
	.origin = EPG_PICO_QUADRATURE_ORIGIN,
};

/*
 * One bit for each PIO block whose instruction memory has the program. The program has a fixed
 * place, and all decoders of a block share it.
 */
static uint32_t qdec_pico_pio_loaded;

static int qdec_pico_pio_read(const struct device *dev, uint32_t *counter)
{
	struct qdec_pico_pio_data *data = dev->data;
	const uint32_t empty = 1U << (PIO_FSTAT_RXEMPTY_LSB + data->sm);
	const uint32_t skipped = 1U << (EPG_PICO_QUADRATURE_SKIPPED_FLAG + data->sm);
	uint32_t stale = pio_sm_get_rx_fifo_level(data->pio, data->sm);

	if ((data->pio->irq & skipped) != 0) {
		data->pio->irq = skipped; /* writing a 1 clears the flag */
		data->common.skipped++;
	}

	for (; stale > 0; stale--) {
		(void)data->pio->rxf[data->sm];
	}

	for (uint32_t poll = 0; poll < QDEC_PICO_PIO_POLLS; poll++) {
		if ((data->pio->fstat & empty) == 0) {
			*counter = data->pio->rxf[data->sm];
			return 0;
		}
	}

	return -EIO; /* the state machine was stopped by other code */
}

static void qdec_pico_pio_expired(struct k_timer *timer)
{
	const struct qdec_pico_pio_data *data =
		CONTAINER_OF(timer, struct qdec_pico_pio_data, timer);

	(void)qdec_common_update(data->dev);
}

/* The time of a quarter of the count's range at the highest rate of edges. */
static k_timeout_t qdec_pico_pio_period(void)
{
	return K_MSEC((1ULL << 30) * EPG_PICO_QUADRATURE_COUNT_EDGE_CYCLES * MSEC_PER_SEC /
		      clock_get_hz(clk_sys));
}

static int qdec_pico_pio_resume(const struct device *dev)
{
	const struct qdec_pico_pio_config *config = dev->config;
	struct qdec_pico_pio_data *data = dev->data;
	pio_sm_config sm_config = pio_get_default_sm_config();
	int ret;

	ret = pinctrl_apply_state(config->pincfg, PINCTRL_STATE_DEFAULT);
	if (ret < 0) {
		LOG_ERR("%s: could not set up the pins (%d)", dev->name, ret);
		return ret;
	}

	pio_sm_set_consecutive_pindirs(data->pio, data->sm, config->lower_pin, 2, false);

	sm_config_set_in_pins(&sm_config, config->lower_pin);
	sm_config_set_in_shift(&sm_config, false, false, 32);
	sm_config_set_out_shift(&sm_config, true, false, 32);
	sm_config_set_wrap(&sm_config, EPG_PICO_QUADRATURE_COUNT_WRAP_TARGET,
			   EPG_PICO_QUADRATURE_COUNT_WRAP);
	pio_sm_init(data->pio, data->sm, EPG_PICO_QUADRATURE_COUNT_START, &sm_config);

	/*
	 * Register Y is the count. OSR is the last sample of the pins: it gets their present levels,
	 * so that the first sample is not counted as an edge.
	 */
	pio_sm_exec(data->pio, data->sm, pio_encode_set(pio_y, 0));
	pio_sm_exec(data->pio, data->sm, pio_encode_mov(pio_isr, pio_null));
	pio_sm_exec(data->pio, data->sm, pio_encode_in(pio_pins, 2));
	pio_sm_exec(data->pio, data->sm, pio_encode_mov(pio_osr, pio_isr));
	data->pio->irq = 1U << (EPG_PICO_QUADRATURE_SKIPPED_FLAG + data->sm);

	pio_sm_set_enabled(data->pio, data->sm, true);

	ret = qdec_common_start(dev);
	if (ret < 0) {
		LOG_ERR("%s: the state machine does not run (%d)", dev->name, ret);
		pio_sm_set_enabled(data->pio, data->sm, false);
		return ret;
	}

	k_timer_start(&data->timer, qdec_pico_pio_period(), qdec_pico_pio_period());

	return 0;
}

static int qdec_pico_pio_suspend(const struct device *dev)
{
	const struct qdec_pico_pio_config *config = dev->config;
	struct qdec_pico_pio_data *data = dev->data;
	int ret;

	k_timer_stop(&data->timer);
	qdec_common_stop(dev);
	pio_sm_set_enabled(data->pio, data->sm, false);

	ret = pinctrl_apply_state(config->pincfg, PINCTRL_STATE_SLEEP);

	return ret == -ENOENT ? 0 : ret;
}

static int qdec_pico_pio_pm_action(const struct device *dev, enum pm_device_action action)
{
	switch (action) {
	case PM_DEVICE_ACTION_RESUME:
		return qdec_pico_pio_resume(dev);
	case PM_DEVICE_ACTION_SUSPEND:
		return qdec_pico_pio_suspend(dev);
	default:
		return -ENOTSUP;
	}
}

static int qdec_pico_pio_load(const struct device *dev, PIO pio)
{
	const uint32_t block = 1U << pio_get_index(pio);

	if ((qdec_pico_pio_loaded & block) != 0) {
		return 0;
	}

	if (!pio_can_add_program_at_offset(pio, &qdec_pico_pio_program,
					   EPG_PICO_QUADRATURE_ORIGIN)) {
		LOG_ERR("%s: another program is in instructions 0 to %u of the PIO block", dev->name,
			EPG_PICO_QUADRATURE_COUNT_LENGTH - 1U);
		return -EBUSY;
	}

	pio_add_program_at_offset(pio, &qdec_pico_pio_program, EPG_PICO_QUADRATURE_ORIGIN);
	qdec_pico_pio_loaded |= block;

	return 0;
}

static int qdec_pico_pio_init(const struct device *dev)
{
	const struct qdec_pico_pio_config *config = dev->config;
	struct qdec_pico_pio_data *data = dev->data;
	int ret;

	if (!device_is_ready(config->piodev)) {
		LOG_ERR("%s: PIO device not ready", dev->name);
		return -ENODEV;
	}

	data->dev = dev;
	data->pio = pio_rpi_pico_get_pio(config->piodev);
	k_timer_init(&data->timer, qdec_pico_pio_expired, NULL);

	ret = qdec_pico_pio_load(dev, data->pio);
	if (ret < 0) {
		return ret;
	}

	ret = pio_rpi_pico_allocate_sm(config->piodev, &data->sm);
	if (ret < 0) {
		LOG_ERR("%s: all state machines are in use", dev->name);
		return ret;
	}

	return pm_device_driver_init(dev, qdec_pico_pio_pm_action);
}

#define QDEC_PICO_PIO_PINS(n) DT_CHILD(DT_INST_PINCTRL_BY_NAME(n, default, 0), ab_pins)
#define QDEC_PICO_PIO_PIN(n, idx)                                                                  \
	RP2_GET_PIN_NUM(DT_PROP_BY_IDX(QDEC_PICO_PIO_PINS(n), pinmux, idx))
#define QDEC_PICO_PIO_FUNC(n, idx)                                                                 \
	RP2_GET_PIN_ALT_FUNC(DT_PROP_BY_IDX(QDEC_PICO_PIO_PINS(n), pinmux, idx))

/* The state machine takes the lower pin as phase A. If that is B, it counts in reverse. */
#define QDEC_PICO_PIO_REVERSED(n) (QDEC_PICO_PIO_PIN(n, 0) > QDEC_PICO_PIO_PIN(n, 1))
#define QDEC_PICO_PIO_LOWER(n)    MIN(QDEC_PICO_PIO_PIN(n, 0), QDEC_PICO_PIO_PIN(n, 1))
#define QDEC_PICO_PIO_UPPER(n)    MAX(QDEC_PICO_PIO_PIN(n, 0), QDEC_PICO_PIO_PIN(n, 1))

#define QDEC_PICO_PIO_BLOCK(n)                                                                     \
	((DT_REG_ADDR(DT_INST_PARENT(n)) - PIO0_BASE) / (PIO1_BASE - PIO0_BASE))
#define QDEC_PICO_PIO_FUNC_IS_OF_BLOCK(n, idx)                                                     \
	(QDEC_PICO_PIO_FUNC(n, idx) == RP2_PINCTRL_GPIO_FUNC_PIO0 + QDEC_PICO_PIO_BLOCK(n))

#define QDEC_PICO_PIO_ASSERT(n)                                                                    \
	QDEC_COMMON_ASSERT_DT_INST(n);                                                             \
	BUILD_ASSERT(DT_NODE_HAS_COMPAT(DT_INST_PARENT(n), raspberrypi_pico_pio),                  \
		     "epg,pico-pio-qdec must be a child of a PIO block (raspberrypi,pico-pio)");   \
	BUILD_ASSERT(DT_CHILD_NUM_STATUS_OKAY(DT_INST_PARENT(n)) <= NUM_PIO_STATE_MACHINES,        \
		     "a PIO block has four state machines, for at most four decoders");            \
	BUILD_ASSERT(DT_NODE_EXISTS(QDEC_PICO_PIO_PINS(n)),                                        \
		     "the pins of an epg,pico-pio-qdec must be in a group ab_pins");               \
	BUILD_ASSERT(DT_PROP_LEN(QDEC_PICO_PIO_PINS(n), pinmux) == 2,                              \
		     "the group ab_pins must have two pins: A, then B");                           \
	BUILD_ASSERT(QDEC_PICO_PIO_UPPER(n) - QDEC_PICO_PIO_LOWER(n) == 1,                         \
		     "A and B of an epg,pico-pio-qdec must be adjacent pins");                     \
	BUILD_ASSERT(QDEC_PICO_PIO_FUNC_IS_OF_BLOCK(n, 0) && QDEC_PICO_PIO_FUNC_IS_OF_BLOCK(n, 1), \
		     "the function of pins in ab_pins must be that of the decoder's PIO block");   \
	BUILD_ASSERT(DT_PROP(QDEC_PICO_PIO_PINS(n), input_enable),                                 \
		     "the group ab_pins must have input-enable");                                  \
	BUILD_ASSERT(!IS_ENABLED(CONFIG_SOC_SERIES_RP2350) ||                                      \
			     !DT_PROP(QDEC_PICO_PIO_PINS(n), bias_pull_down),                      \
		     "inputs of RP2350 must not have bias-pull-down (erratum RP2350-E9)")

#define QDEC_PICO_PIO_INIT(n)                                                                      \
	QDEC_PICO_PIO_ASSERT(n);                                                                   \
	PINCTRL_DT_INST_DEFINE(n);                                                                 \
	static const struct qdec_pico_pio_config qdec_pico_pio_config_##n = {                      \
		.common =                                                                          \
			{                                                                          \
				.read = qdec_pico_pio_read,                                        \
				.counts_per_revolution = DT_INST_PROP(n, counts_per_revolution),   \
				.counter_bits = 32,                                                \
				.invert = DT_INST_PROP(n, invert) != QDEC_PICO_PIO_REVERSED(n),    \
				.notices_skips = true,                                             \
			},                                                                         \
		.piodev = DEVICE_DT_GET(DT_INST_PARENT(n)),                                        \
		.pincfg = PINCTRL_DT_INST_DEV_CONFIG_GET(n),                                       \
		.lower_pin = QDEC_PICO_PIO_LOWER(n),                                               \
	};                                                                                         \
	static struct qdec_pico_pio_data qdec_pico_pio_data_##n;                                   \
	PM_DEVICE_DT_INST_DEFINE(n, qdec_pico_pio_pm_action);                                      \
	SENSOR_DEVICE_DT_INST_DEFINE(n, qdec_pico_pio_init, PM_DEVICE_DT_INST_GET(n),              \
				     &qdec_pico_pio_data_##n, &qdec_pico_pio_config_##n,           \
				     POST_KERNEL, CONFIG_SENSOR_INIT_PRIORITY,                     \
				     &qdec_common_driver_api);

DT_INST_FOREACH_STATUS_OKAY(QDEC_PICO_PIO_INIT)
