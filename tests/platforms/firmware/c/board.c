/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The drivers of docs/any-firmware.md, on this computer.  A user types on stdin at 1 character per millisecond, and reads
 * stdout.
 *
 * Time passes while the program reads the board, so that all runs are equal.  Interrupts come before and after each of
 * these reads.  The counter of microseconds wraps 20 ms after the start.  Each turn of the encoder's counter of 16 bits
 * takes 66 ms.  The program ends half a second after the last character.
 */
#define _POSIX_C_SOURCE 200809L
#include "board.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#define MILLISECOND 1000000U

static uint64_t now_ns = (0x100000000U - 20000U) * 1000ULL;
static uint64_t tick_ns;
static uint64_t byte_ns;
static uint64_t last_ns; /* of the last character */
static bool tick_on;
static bool in_tick;
static bool in_uart;
static bool calls_when_ready;
static bool received;
static unsigned char character;
static unsigned int fed;
static uint32_t pwm_top;
static uint32_t pwm_compare;
static uint32_t pwm_largest;

static void end(void)
{
    fflush(stdout);
    fprintf(stderr, "watchdog=%s top=%u compare=%u largest=%u\n", fed > 0 ? "fed" : "hungry", (unsigned int)pwm_top,
            (unsigned int)pwm_compare, (unsigned int)pwm_largest);
    exit(0);
}

static void type(void)
{
    if (now_ns < byte_ns || received) {
        return;
    }
    byte_ns = now_ns + MILLISECOND;
    if (read(STDIN_FILENO, &character, 1) == 1) {
        received = true;
        last_ns = now_ns;
    } else if (now_ns > last_ns + 500U * MILLISECOND) {
        end();
    }
}

static void interrupts(void)
{
    if (tick_on && !in_tick && now_ns >= tick_ns) {
        tick_ns += MILLISECOND;
        in_tick = true;
        board_tick();
        in_tick = false;
    }
    if (!in_tick && !in_uart) { /* the tick has the higher priority */
        in_uart = true;
        type();
        if (received || calls_when_ready) {
            board_uart();
        }
        in_uart = false;
    }
}

static void pass(void)
{
    now_ns += 900U;
    interrupts();
}

void board_start(void)
{
}

void board_start_tick(void)
{
    tick_on = true;
    tick_ns = now_ns + MILLISECOND;
}

void board_start_watchdog(void)
{
}

void board_feed_watchdog(void)
{
    fed++;
}

uint32_t board_microseconds(void)
{
    pass();
    const uint32_t counter = (uint32_t)(now_ns / 1000U);
    pass();
    return counter;
}

uint16_t board_encoder(void)
{
    return (uint16_t)(now_ns / 1000U);
}

void board_start_pwm(uint32_t prescaler, uint32_t top)
{
    (void)prescaler;
    pwm_top = top;
}

void board_pwm(uint32_t compare)
{
    pwm_compare = compare;
    pwm_largest = compare > pwm_largest ? compare : pwm_largest;
}

void board_direction_a(bool high)
{
    (void)high;
}

void board_direction_b(bool high)
{
    (void)high;
}

uint32_t board_random(void)
{
    return 1U; /* all runs are equal */
}

bool board_emergency_stop(void)
{
    return false; /* the contact is closed */
}

bool board_uart_received(unsigned char *byte)
{
    const bool there = received;
    *byte = character;
    received = false;
    return there;
}

bool board_uart_ready(void)
{
    return true;
}

void board_uart_send(unsigned char byte)
{
    putchar(byte);
}

void board_uart_call_when_ready(bool on)
{
    calls_when_ready = on;
    pass();
}
