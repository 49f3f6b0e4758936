/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The control loop at the ticks of a timer, with a clock, a console on UART 0, an agent on UART 1, and axes that move.
 *
 * UART 2 takes orders from the test, one letter each, and answers each of them by a line of numbers: time in us, cycles, missed ticks, overruns, fault, largest lateness in ns, jiwy_alive() after the newest cycle,
 * outputs that are not safe, the result of the order.
 *
 * | order | effect                                                                                      |
 * |-------|---------------------------------------------------------------------------------------------|
 * | `?`   | none                                                                                        |
 * | `d`   | doubles the timer's period                                                                  |
 * | `o`   | makes the next 15 cycles 1.5 ms long                                                        |
 * | `c`   | the correct period of the timer again                                                       |
 * | `k`   | does not call jiwy_communicate() for 1.5 s, and gives jiwy_alive() at their end              |
 * | `s`   | jiwy_stop()                                                                                 |
 * | `r`   | jiwy_start()                                                                                |
 * | `h`   | executes an undefined instruction: hard_fault_handler() calls jiwy_safe(), and answers      |
 */
#include <stdatomic.h>

#include "board.h"
#include "jiwy_firmware.h"
#include "line.h"
#include "program.h"

enum { CONSOLE = 0, AGENT = 1, TEST = 2 };

#define PERIOD (BOARD_HZ / 1000U) /* clocks of a control period */

static volatile uint32_t long_cycles; /* number of cycles that are too long */
static volatile bool alive;

/* Clock -------------------------------------------------------------------------------------------------------- */

static volatile uint32_t wraps; /* of the clock's timer; written by its interrupt */

void timer1_handler(void);

void timer1_handler(void)
{
    TIMER1->interrupt = 1U;
    wraps++;
}

/** Clocks since the start.  The interrupt of the clock cannot interrupt the one of the cycle, which looks for it. */
static uint64_t clocks(void)
{
    uint32_t before;
    uint32_t value;
    bool pending;
    do {
        before = wraps;
        pending = (TIMER1->interrupt & 1U) != 0U;
        value = TIMER1->value;
    } while (before != wraps || pending != ((TIMER1->interrupt & 1U) != 0U));
    return ((uint64_t)(before + pending) << 32) + (UINT32_MAX - value);
}

uint64_t jiwy_time_ns(void)
{
    return clocks() * (1000000000U / BOARD_HZ);
}

/* Motors and encoders ------------------------------------------------------------------------------------------ */

/** An axis between two end stops.  Its speed is proportional to the duty; a small duty does not move it. */
typedef struct axis {
    double counts_per_cycle; /**< at a duty of 1 */
    double last;             /**< count of the upper end stop; the lower one is at 0 */
    double count;
    uint32_t level;
    bool a, b;
} axis_t;

static axis_t pan = {.counts_per_cycle = 10.0, .last = 1112.0, .count = 100.0};
static axis_t tilt = {.counts_per_cycle = 4.0, .last = 221.0, .count = 60.0};

static double move(axis_t *axis)
{
    const double duty =
        (double)axis->level / (JIWY_PWM_PAN_TOP + 1.0) * ((axis->a ? 1.0 : 0.0) - (axis->b ? 1.0 : 0.0));
    if (duty > 0.02 || duty < -0.02) {
        axis->count += duty * axis->counts_per_cycle;
    }
    axis->count = axis->count < 0.0 ? 0.0 : axis->count > axis->last ? axis->last : axis->count;
    return axis->count;
}

static bool unsafe(const axis_t *axis)
{
    return axis->level != 0U || axis->a || axis->b;
}

PAN_COUNT_T jiwy_encoder_pan_count(void)
{
    if (long_cycles > 0U) {
        long_cycles--;
        const uint64_t end = clocks() + BOARD_HZ * 3ULL / 2000U;
        while (clocks() < end) {
        }
    }
    return (PAN_COUNT_T)move(&pan);
}

TILT_COUNT_T jiwy_encoder_tilt_count(void)
{
    return (TILT_COUNT_T)move(&tilt);
}

void jiwy_pwm_pan_write(uint32_t level)
{
    pan.level = level;
}

void jiwy_pwm_tilt_write(uint32_t level)
{
    tilt.level = level;
}

void jiwy_pwm_pan_direction_a_set(bool high)
{
    pan.a = high;
}

void jiwy_pwm_pan_direction_b_set(bool high)
{
    pan.b = high;
}

void jiwy_pwm_tilt_direction_a_set(bool high)
{
    tilt.a = high;
}

void jiwy_pwm_tilt_direction_b_set(bool high)
{
    tilt.b = high;
}

/* Streams and store -------------------------------------------------------------------------------------------- */

size_t jiwy_console_receive(void *data, size_t size)
{
    return line_read(CONSOLE, data, size);
}

size_t jiwy_console_send(const void *data, size_t size)
{
    return line_write(CONSOLE, data, size);
}

size_t jiwy_xrce_receive(void *data, size_t size)
{
    return line_read(AGENT, data, size);
}

size_t jiwy_xrce_send(const void *data, size_t size)
{
    return line_write(AGENT, data, size);
}

/** QEMU has no random number; each run is one start. */
uint32_t jiwy_boot_id(void)
{
    return 1U;
}

size_t jiwy_store_load(void *data, size_t size)
{
    (void)data;
    (void)size;
    return 0;
}

bool jiwy_store_save(const void *data, size_t size)
{
    (void)data;
    (void)size;
    return false;
}

/* Contexts ----------------------------------------------------------------------------------------------------- */

void timer0_handler(void);

void timer0_handler(void)
{
    TIMER0->interrupt = 1U;
    jiwy_cycle();
    alive = jiwy_alive();
}

static void say(uint64_t number, char end)
{
    char text[21];
    unsigned int begin = sizeof text;
    text[--begin] = end;
    do {
        text[--begin] = (char)('0' + number % 10U);
        number /= 10U;
    } while (number > 0U);
    line_write_all(TEST, text + begin, sizeof text - begin);
}

static void answer(bool result)
{
    static epg_statistics_t none;
    epg_status_t status = {.statistics = none};
    (void)jiwy_status(&status);
    say(clocks() / (BOARD_HZ / 1000000U), ' ');
    say(status.statistics.cycles, ' ');
    say(status.statistics.missed, ' ');
    say(status.statistics.overruns, ' ');
    say(status.fault, ' ');
    say(status.statistics.lateness_max, ' ');
    say(alive, ' ');
    say((uint64_t)unsafe(&pan) + (uint64_t)unsafe(&tilt), ' ');
    say(result, '\n');
}

void hard_fault_handler(void);

void hard_fault_handler(void)
{
    jiwy_safe();
    answer(true);
    for (;;) {
    }
}

void program_start(void)
{
    line_start(CONSOLE);
    line_start(AGENT);
    line_start(TEST);
    TIMER1->reload = UINT32_MAX;
    TIMER1->value = BOARD_HZ / 5U; /* it wraps soon, as a free-running timer does after some minutes */
    TIMER1->ctrl = TIMER_ON | TIMER_INTERRUPT;
    board_interrupt_on(IRQ_TIMER1, PRIORITY_CLOCK);
    (void)jiwy_start();
    TIMER0->reload = PERIOD - 1U;
    TIMER0->value = PERIOD - 1U;
    TIMER0->ctrl = TIMER_ON | TIMER_INTERRUPT;
    board_interrupt_on(IRQ_TIMER0, PRIORITY_CYCLE);
}

static void obey(char order)
{
    bool result = true;
    switch (order) {
    case 'd':
        TIMER0->reload = 2U * PERIOD - 1U;
        break;
    case 'o':
        long_cycles = 15U;
        break;
    case 'c':
        TIMER0->reload = PERIOD - 1U;
        break;
    case 'k': {
        const uint64_t end = clocks() + BOARD_HZ * 3ULL / 2U;
        while (clocks() < end) {
            for (volatile unsigned int i = 0; i < 1000U; i++) { /* QEMU needs long to read a register */
            }
        }
        result = alive;
        break;
    }
    case 's':
        result = jiwy_stop();
        break;
    case 'r':
        result = jiwy_start();
        break;
    case 'h':
        __asm volatile("udf #0");
        break;
    default:
        break;
    }
    answer(result);
}

void program_turn(void)
{
    char order;
    jiwy_communicate();
    if (line_read(TEST, &order, 1) == 1U) {
        obey(order);
    }
}
