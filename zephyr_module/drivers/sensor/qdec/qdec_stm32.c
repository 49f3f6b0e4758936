/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief Quadrature decoders on STM32 timers
 *
 * In its encoder mode the timer itself counts every edge of both phases. Most timers have only 16
 * bits, so their wraps must not be missed.
 *
 * Each read sets the compare values of channels 3 and 4: the present count plus and minus a quarter
 * of the counter's range. When the shaft has moved so far, a channel matches and interrupts. The
 * interrupt reads the counter, and so sets both compare values again. The count must be read before
 * it has moved by half of the range. The interrupt may therefore be late by another quarter of the
 * range: 16384 counts with 16 bits. A shaft that trembles in one place causes no interrupts.
 */

#define DT_DRV_COMPAT epg_stm32_qdec

#include <errno.h>

#include <zephyr/device.h>
#include <zephyr/drivers/clock_control.h>
#include <zephyr/drivers/clock_control/stm32_clock_control.h>
#include <zephyr/drivers/pinctrl.h>
#include <zephyr/drivers/reset.h>
#include <zephyr/irq.h>
#include <zephyr/logging/log.h>
#include <zephyr/pm/device.h>

#include <stm32_ll_tim.h>

#include "qdec_common.h"

LOG_MODULE_REGISTER(epg_qdec_stm32, CONFIG_SENSOR_LOG_LEVEL);

/* Some series have only 16-bit timers, and do not define this macro. */
#ifndef IS_TIM_32B_COUNTER_INSTANCE
#define IS_TIM_32B_COUNTER_INSTANCE(instance) (0)
#endif

struct qdec_stm32_config {
	struct qdec_common_config common;
	TIM_TypeDef *timer;
	const struct pinctrl_dev_config *pincfg;
	struct stm32_pclken pclken;
	struct reset_dt_spec reset;
	uint32_t input_filter;
	void (*irq_connect)(void);
	unsigned int irq;
};

struct qdec_stm32_data {
	struct qdec_common_data common;
};

/* The highest value of the counter. */
static uint32_t qdec_stm32_range(const struct qdec_stm32_config *config)
{
	return config->common.counter_bits == 32 ? UINT32_MAX : UINT16_MAX;
}

static int qdec_stm32_read(const struct device *dev, uint32_t *counter)
{
	const struct qdec_stm32_config *config = dev->config;
	const uint32_t range = qdec_stm32_range(config);
	const uint32_t quarter = range / 4 + 1;
	const uint32_t now = LL_TIM_GetCounter(config->timer);

	LL_TIM_OC_SetCompareCH3(config->timer, (now + quarter) & range);
	LL_TIM_OC_SetCompareCH4(config->timer, (now - quarter) & range);
	*counter = now;

	return 0;
}

static void qdec_stm32_isr(const struct device *dev)
{
	const struct qdec_stm32_config *config = dev->config;

	/* The flags are cleared before the read, so that a match after the read interrupts again. */
	LL_TIM_ClearFlag_CC3(config->timer);
	LL_TIM_ClearFlag_CC4(config->timer);

	(void)qdec_common_update(dev);
}

static void qdec_stm32_set_up_input(TIM_TypeDef *timer, uint32_t channel, uint32_t filter)
{
	LL_TIM_IC_SetActiveInput(timer, channel, LL_TIM_ACTIVEINPUT_DIRECTTI);
	LL_TIM_IC_SetFilter(timer, channel, filter);
	LL_TIM_IC_SetPolarity(timer, channel, LL_TIM_IC_POLARITY_RISING);
	/* LL_TIM_ENCODER_Init() enables the input channels, too. */
	LL_TIM_CC_EnableChannel(timer, channel);
}

static void qdec_stm32_set_up_compare(TIM_TypeDef *timer, uint32_t channel)
{
	LL_TIM_OC_SetMode(timer, channel, LL_TIM_OCMODE_FROZEN);
	LL_TIM_OC_DisablePreload(timer, channel);
}

static int qdec_stm32_resume(const struct device *dev)
{
	const struct qdec_stm32_config *config = dev->config;
	const struct device *const clk = DEVICE_DT_GET(STM32_CLOCK_CONTROL_NODE);
	TIM_TypeDef *timer = config->timer;
	int ret;

	ret = clock_control_on(clk, (clock_control_subsys_t)&config->pclken);
	if (ret < 0) {
		LOG_ERR("%s: could not enable the clock (%d)", dev->name, ret);
		return ret;
	}

	ret = reset_line_toggle_dt(&config->reset);
	if (ret < 0) {
		LOG_ERR("%s: could not reset the timer (%d)", dev->name, ret);
		goto clock_off;
	}

	ret = pinctrl_apply_state(config->pincfg, PINCTRL_STATE_DEFAULT);
	if (ret < 0) {
		LOG_ERR("%s: could not set up the pins (%d)", dev->name, ret);
		goto clock_off;
	}

	LL_TIM_SetPrescaler(timer, 0);
	LL_TIM_SetAutoReload(timer, qdec_stm32_range(config));
	qdec_stm32_set_up_input(timer, LL_TIM_CHANNEL_CH1, config->input_filter);
	qdec_stm32_set_up_input(timer, LL_TIM_CHANNEL_CH2, config->input_filter);
	qdec_stm32_set_up_compare(timer, LL_TIM_CHANNEL_CH3);
	qdec_stm32_set_up_compare(timer, LL_TIM_CHANNEL_CH4);
	LL_TIM_SetEncoderMode(timer, LL_TIM_ENCODERMODE_X4_TI12);
	/* The update event activates the prescaler, and sets the counter to 0. */
	LL_TIM_GenerateEvent_UPDATE(timer);

	ret = qdec_common_start(dev);
	if (ret < 0) {
		goto clock_off;
	}

	LL_TIM_ClearFlag_CC3(timer);
	LL_TIM_ClearFlag_CC4(timer);
	LL_TIM_EnableIT_CC3(timer);
	LL_TIM_EnableIT_CC4(timer);
	LL_TIM_EnableCounter(timer);
	irq_enable(config->irq);

	return 0;

clock_off:
	(void)clock_control_off(clk, (clock_control_subsys_t)&config->pclken);

	return ret;
}

static int qdec_stm32_suspend(const struct device *dev)
{
	const struct qdec_stm32_config *config = dev->config;
	const struct device *const clk = DEVICE_DT_GET(STM32_CLOCK_CONTROL_NODE);
	int ret;

	LL_TIM_DisableCounter(config->timer);
	LL_TIM_DisableIT_CC3(config->timer);
	LL_TIM_DisableIT_CC4(config->timer);
	irq_disable(config->irq);
	qdec_common_stop(dev);

	ret = clock_control_off(clk, (clock_control_subsys_t)&config->pclken);
	if (ret < 0) {
		return ret;
	}

	ret = pinctrl_apply_state(config->pincfg, PINCTRL_STATE_SLEEP);

	return ret == -ENOENT ? 0 : ret;
}

static int qdec_stm32_pm_action(const struct device *dev, enum pm_device_action action)
{
	switch (action) {
	case PM_DEVICE_ACTION_RESUME:
		return qdec_stm32_resume(dev);
	case PM_DEVICE_ACTION_SUSPEND:
		return qdec_stm32_suspend(dev);
	default:
		return -ENOTSUP;
	}
}

static int qdec_stm32_init(const struct device *dev)
{
	const struct qdec_stm32_config *config = dev->config;

	if (!device_is_ready(DEVICE_DT_GET(STM32_CLOCK_CONTROL_NODE))) {
		LOG_ERR("%s: clock control device not ready", dev->name);
		return -ENODEV;
	}

	if (!device_is_ready(config->reset.dev)) {
		LOG_ERR("%s: reset controller not ready", dev->name);
		return -ENODEV;
	}

	config->irq_connect();

	return pm_device_driver_init(dev, qdec_stm32_pm_action);
}

#define QDEC_STM32_TIMER(n) ((TIM_TypeDef *)DT_REG_ADDR(DT_INST_PARENT(n)))

/* Advanced timers have a separate interrupt line for the channels; other timers have one line. */
#define QDEC_STM32_IRQ(n, cell)                                                                    \
	COND_CODE_1(DT_IRQ_HAS_NAME(DT_INST_PARENT(n), cc),                                        \
		    (DT_IRQ_BY_NAME(DT_INST_PARENT(n), cc, cell)),                                 \
		    (DT_IRQ(DT_INST_PARENT(n), cell)))

#define QDEC_STM32_ASSERT(n)                                                                       \
	QDEC_COMMON_ASSERT_DT_INST(n);                                                             \
	BUILD_ASSERT(DT_NODE_HAS_COMPAT(DT_INST_PARENT(n), st_stm32_timers),                       \
		     "epg,stm32-qdec must be a child of a timer (st,stm32-timers)");               \
	BUILD_ASSERT(DT_NODE_HAS_STATUS_OKAY(DT_INST_PARENT(n)),                                   \
		     "the timer of an epg,stm32-qdec is not enabled: status = \"okay\"");          \
	BUILD_ASSERT(DT_CHILD_NUM_STATUS_OKAY(DT_INST_PARENT(n)) == 1,                             \
		     "the timer of an epg,stm32-qdec must not have another function");             \
	BUILD_ASSERT(DT_IRQ_HAS_IDX(DT_INST_PARENT(n), 0),                                         \
		     "the timer of an epg,stm32-qdec has no interrupts");                          \
	BUILD_ASSERT(IS_TIM_ENCODER_INTERFACE_INSTANCE(QDEC_STM32_TIMER(n)),                       \
		     "the timer of an epg,stm32-qdec has no encoder mode");                        \
	BUILD_ASSERT(IS_TIM_CC4_INSTANCE(QDEC_STM32_TIMER(n)),                                     \
		     "the timer of an epg,stm32-qdec must have four channels")

#define QDEC_STM32_INIT(n)                                                                         \
	QDEC_STM32_ASSERT(n);                                                                      \
	PINCTRL_DT_INST_DEFINE(n);                                                                 \
	static void qdec_stm32_irq_connect_##n(void)                                               \
	{                                                                                          \
		IRQ_CONNECT(QDEC_STM32_IRQ(n, irq), QDEC_STM32_IRQ(n, priority), qdec_stm32_isr,   \
			    DEVICE_DT_INST_GET(n), 0);                                             \
	}                                                                                          \
	static const struct qdec_stm32_config qdec_stm32_config_##n = {                            \
		.common = QDEC_COMMON_CONFIG_DT_INST(                                              \
			n, qdec_stm32_read,                                                        \
			IS_TIM_32B_COUNTER_INSTANCE(QDEC_STM32_TIMER(n)) ? 32 : 16, false),        \
		.timer = QDEC_STM32_TIMER(n),                                                      \
		.pincfg = PINCTRL_DT_INST_DEV_CONFIG_GET(n),                                       \
		.pclken = {.bus = DT_CLOCKS_CELL(DT_INST_PARENT(n), bus),                          \
			   .enr = DT_CLOCKS_CELL(DT_INST_PARENT(n), bits)},                        \
		.reset = RESET_DT_SPEC_GET(DT_INST_PARENT(n)),                                     \
		.input_filter = DT_INST_PROP(n, input_filter_level) * LL_TIM_IC_FILTER_FDIV1_N2,   \
		.irq_connect = qdec_stm32_irq_connect_##n,                                         \
		.irq = QDEC_STM32_IRQ(n, irq),                                                     \
	};                                                                                         \
	static struct qdec_stm32_data qdec_stm32_data_##n;                                         \
	PM_DEVICE_DT_INST_DEFINE(n, qdec_stm32_pm_action);                                         \
	SENSOR_DEVICE_DT_INST_DEFINE(n, qdec_stm32_init, PM_DEVICE_DT_INST_GET(n),                 \
				     &qdec_stm32_data_##n, &qdec_stm32_config_##n, POST_KERNEL,    \
				     CONFIG_SENSOR_INIT_PRIORITY, &qdec_common_driver_api);

DT_INST_FOREACH_STATUS_OKAY(QDEC_STM32_INIT)
