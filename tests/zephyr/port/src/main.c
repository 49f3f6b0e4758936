/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief A target of one motor, and a program that disturbs it as the test requests
 *
 * It echoes the bytes that arrive over USB and over the serial line.
 */

#include <zephyr/irq.h>
#include <zephyr/kernel.h>

#include <string.h>

#include "epg/port.h"
#include "epg/port_uart.h"
#include "epg/zephyr.h"

#define NODE DT_NODELABEL(epg_port)

/* A period of 1 ms at 125 MHz, and of 50 us for the motor. */
#define CLOCK        125000000U
#define PRESCALER    2U
#define TOP          62499U
#define MOTOR_TOP    6249U
#define TICK_SLICE   6U
#define MOTOR_PIN    2U
#define FORWARD_PIN  3U
#define HALF_LEVEL   3125U
#define OVERRUN_LIMIT 5U

/* An interrupt of SPI0, which this image does not use. */
#define SPARE_IRQ 18U

enum request {
	REQUEST_NONE,
	REQUEST_STOP,
	REQUEST_START,
	REQUEST_PANIC,
	REQUEST_HANG,
	REQUEST_LOCK_INTERRUPTS,
	REQUEST_DISABLE_SPARE_IRQ,
	REQUEST_SUSPEND,
	REQUEST_RESUME,
};

/* Written by the test, which then waits until the request is 0 again. */
volatile uint32_t request;
volatile uint32_t started;
volatile uint32_t error;
volatile uint32_t spare_enabled;

/* Makes the next control cycle disable SPARE_IRQ. */
static volatile bool disable_spare;

static const epg_zephyr_decoder_t decoders[] = {
	{.instance = 0, .slot = 0, .device = DEVICE_DT_GET(DT_PHANDLE_BY_IDX(NODE, decoders, 0))},
};
static const epg_zephyr_pwm_t pwms[] = {
	{.instance = 1,
	 .slot = 0,
	 .device = DEVICE_DT_GET(DT_PWMS_CTLR_BY_IDX(NODE, 0)),
	 .channel = DT_PWMS_CHANNEL_BY_IDX(NODE, 0)},
};
static const epg_zephyr_pin_t pins[] = {
	{.pin = MOTOR_PIN, .gpio = GPIO_DT_SPEC_GET_BY_IDX(NODE, gpios, 0)},
	{.pin = FORWARD_PIN, .gpio = GPIO_DT_SPEC_GET_BY_IDX(NODE, gpios, 1)},
};
static const epg_zephyr_output_t outputs[] = {
	{.pin = MOTOR_PIN, .high = false},
	{.pin = FORWARD_PIN, .high = false},
};
static const epg_zephyr_uart_t uarts[] = {
	{.instance = 1, .device = DEVICE_DT_GET(DT_PHANDLE_BY_IDX(NODE, uarts, 0))},
};
const epg_zephyr_hardware_t epg_zephyr_hardware = {
	.decoder_count = ARRAY_SIZE(decoders),
	.decoders = decoders,
	.pwm_count = ARRAY_SIZE(pwms),
	.pwms = pwms,
	.pin_count = ARRAY_SIZE(pins),
	.pins = pins,
	.output_count = ARRAY_SIZE(outputs),
	.outputs = outputs,
	.uart_count = ARRAY_SIZE(uarts),
	.uarts = uarts,
};

static const epg_port_quadrature_t encoder = {.pin_a = 10, .pin_b = 11, .instance = 0, .slot = 0};
static const epg_port_pwm_t motor = {
	.pin = MOTOR_PIN, .instance = 1, .slot = 0, .prescaler = 1, .top = MOTOR_TOP};
static epg_control_t control;
volatile uint32_t count;

static void start_peripherals(void)
{
	epg_port_quadrature_start(&encoder);
	epg_port_pwm_start(&motor);
	epg_port_output_start(FORWARD_PIN, false);
}

static void sample(void)
{
	if (disable_spare) {
		irq_disable(SPARE_IRQ);
		disable_spare = false;
	}
	count = epg_port_quadrature_count(&encoder);
}

static void nothing(void)
{
}

static bool yes(void)
{
	return true;
}

static void drive(void)
{
	epg_port_pwm_write(&motor, HALF_LEVEL);
	epg_port_output_write(FORWARD_PIN, true);
}

static void be_safe(void)
{
	epg_port_pwm_write(&motor, 0);
	epg_port_output_write(FORWARD_PIN, false);
}

static const epg_application_t application = {
	.name = "port",
	.period_ns = 1000000,
	.step_divider = 1,
	.overrun_limit = OVERRUN_LIMIT,
	.enable_at_start = true,
	.start = start_peripherals,
	.sample = sample,
	.read = nothing,
	.inputs_finite = yes,
	.model_init = nothing,
	.model_step = nothing,
	.model_finite = yes,
	.write = drive,
	.safe = be_safe,
};

static unsigned char line_received[256];
static unsigned char line_sent[256];
static epg_port_uart_lines_t lines = {
	.received = {.bytes = line_received, .size = sizeof(line_received)},
	.sent = {.bytes = line_sent, .size = sizeof(line_sent)},
};
static const epg_port_uart_t line = {.pin_tx = 8, .pin_rx = 9, .instance = 1, .lines = &lines};
static const epg_stream_t *usb;

static void echo_start(const epg_target_t *target, const epg_stream_t *stream)
{
	ARG_UNUSED(target);
	usb = stream;
	(void)epg_port_uart_start(&line);
}

static void echo_poll(uint64_t now_ns)
{
	unsigned char piece[64];
	const size_t room = usb->writable(usb->context);
	size_t size = usb->read(usb->context, piece, MIN(room, sizeof(piece)));

	ARG_UNUSED(now_ns);
	while (size > 0) {
		(void)usb->write(usb->context, piece, size);
		size = usb->read(usb->context, piece,
				 MIN(usb->writable(usb->context), sizeof(piece)));
	}

	size = epg_ring_read(&lines.received, piece,
			     MIN(epg_ring_room(&lines.sent), sizeof(piece)));
	if (size > 0) {
		(void)epg_ring_write(&lines.sent, piece, size);
		epg_port_uart_send(&line);
	}
}

static const epg_middleware_t echo = {.start = echo_start, .poll = echo_poll};
static const char *const components[] = {"encoder"};
static const epg_target_t target = {
	.control = &control,
	.application = &application,
	.node = "port",
	.name_space = "",
	.domain = EPG_DOMAIN_DEFAULT,
	.communication_period_ns = 10000000,
	.component_count = ARRAY_SIZE(components),
	.components = components,
	.version = "0",
	.hash = "0",
	.middleware = &echo,
};
epg_zephyr_target_t zephyr = { /* the test changes the clock of its tick */
	.target = &target,
	.tick = {.clock = CLOCK, .prescaler = PRESCALER, .top = TOP, .instance = TICK_SLICE},
	.transport = &epg_zephyr_usb,
	.transport_title = "EPG test",
};

static void start(void)
{
	epg_zephyr_status_t status;

	started = epg_zephyr_start(&zephyr) ? 1 : 0;
	epg_zephyr_status(&status);
	error = status.error;
}

static void nobody(const void *argument)
{
	ARG_UNUSED(argument);
}

static void find_control(const struct k_thread *thread, void *found)
{
	if (strcmp(k_thread_name_get((k_tid_t)thread), "epg_control") == 0) {
		*(k_tid_t *)found = (k_tid_t)thread;
	}
}

static k_tid_t control_thread(void)
{
	k_tid_t found = NULL;

	k_thread_foreach(find_control, &found);
	return found;
}

static void handle(uint32_t wanted)
{
	unsigned int key;

	switch (wanted) {
	case REQUEST_STOP:
		epg_zephyr_stop();
		break;
	case REQUEST_START:
		start();
		break;
	case REQUEST_PANIC:
		k_panic();
		break;
	case REQUEST_HANG:
		k_sched_lock(); /* from here on no preemptible thread runs */
		for (;;) {
		}
	case REQUEST_LOCK_INTERRUPTS:
		key = irq_lock();
		k_busy_wait(3500);
		irq_unlock(key);
		break;
	case REQUEST_DISABLE_SPARE_IRQ:
		irq_enable(SPARE_IRQ);
		disable_spare = true;
		k_msleep(5);
		spare_enabled = irq_is_enabled(SPARE_IRQ) ? 1 : 0;
		break;
	case REQUEST_SUSPEND:
		k_thread_suspend(control_thread());
		break;
	case REQUEST_RESUME:
		k_thread_resume(control_thread());
		break;
	default:
		break;
	}
}

int main(void)
{
	IRQ_CONNECT(SPARE_IRQ, 3, nobody, NULL, 0);
	spare_enabled = 2; /* not read yet */
	start();
	for (;;) {
		handle(request);
		request = REQUEST_NONE;
		k_msleep(2);
	}
	return 0;
}
