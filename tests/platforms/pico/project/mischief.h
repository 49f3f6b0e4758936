/**
 * @file
 * Orders of a test to core 0, written to `order`.  TARGET is the target that core 0 starts.
 */
#ifndef MISCHIEF_H
#define MISCHIEF_H

#include <stdbool.h>
#include <stdint.h>

#include "hardware/flash.h"
#include "hardware/sync.h"
#include "pico.h"
#include "pico/flash.h"

#include TARGET_HEADER

/* CALL(start)() is <target>_start(). */
#define JOIN_(one, two) one##_##two
#define JOIN(one, two) JOIN_(one, two)
#define CALL(function) JOIN(TARGET, function)

enum {
    ORDER_NONE,
    ORDER_FAULT,
    ORDER_PANIC,
    ORDER_STUCK,
    ORDER_ENABLE,
    ORDER_DISABLE,
    ORDER_FLASH,
    ORDER_STOP,
    ORDER_START,
    ORDER_STOP_WITHIN,
    ORDER_OVERFLOW
};

volatile uint32_t order;
volatile int32_t answer = 1000;
volatile uint32_t turns;
volatile bool stops_within;
epg_status_t status;

static void write_flash(void *argument)
{
    (void)argument;
    answer = 0;
}

static uint32_t deeper(uint32_t depth)
{
    volatile uint32_t space[24] = {depth};
    return depth == 0U ? 0U : deeper(depth - 1U) + space[0];
}

static void obey(void)
{
    const uint32_t now = order;
    if (now != ORDER_NONE) {
        order = ORDER_NONE; /* only then: the test may have written a new order meanwhile */
    }
    turns++;
    (void)CALL(status)(&status);
    switch (now) {
    case ORDER_FAULT:
        *(volatile uint32_t *)0xF0000000U = 0;
        break;
    case ORDER_PANIC:
        panic("asked to");
    case ORDER_STUCK:
        (void)save_and_disable_interrupts();
        for (;;) {
            tight_loop_contents();
        }
    case ORDER_ENABLE:
        CALL(enable)(true);
        break;
    case ORDER_DISABLE:
        CALL(enable)(false);
        break;
    case ORDER_FLASH:
        answer = flash_safe_execute(write_flash, NULL, 10);
        break;
    case ORDER_STOP:
        answer = CALL(stop)() ? 1 : 0;
        break;
    case ORDER_START:
        answer = CALL(start)() ? 1 : 0;
        break;
    case ORDER_STOP_WITHIN:
        stops_within = true;
        break;
    case ORDER_OVERFLOW:
        (void)deeper(1000U);
        break;
    default:
        break;
    }
}

/** TinyUSB calls this when a serial port has received bytes, within EPG's communication. */
void tud_cdc_rx_cb(uint8_t number);
void tud_cdc_rx_cb(uint8_t number)
{
    (void)number;
    if (stops_within) {
        stops_within = false;
        answer = CALL(stop)() ? 1 : 0;
    }
}

#endif
