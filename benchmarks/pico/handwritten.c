/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * JIWY's control cycle as an engineer would write it for this one robot with the Pico SDK, without a generator.
 *
 * It has the same functions as the generated target: encoders with a reset, H-bridges with a direction, motion guards,
 * tests for values that are not finite, faults that are latched, a disabled state with safe outputs, statistics of the
 * cycle and of its lateness, a watchdog that also watches communication, and wait-free exchanges between the cores.
 * Left out are functions that no cycle of this robot uses: changes of parameters, capture, moving by hand, the
 * measurement of stacks, and setpoints with a timeout or a rate limit.
 *
 * Everything is made for this robot and this chip: numbers are constants, the model's arrays are used directly, and
 * times are in clocks of the processor, so that 32 bits are enough for them.
 */
#include "handwritten.h"

#include <stdatomic.h>
#include <string.h>

#include "../runtime/guard.h"
#include "epg/pico_quadrature.h"
#include "hardware/pwm.h"
#include "hardware/structs/systick.h"
#include "hardware/watchdog.h"
#include "pico/stdlib.h"
#include "xxsubmod.h"

#define PWM_TOP (SYS_CLK_HZ / 20000u - 1u) /* 20 kHz */
#define PERIOD_CLOCKS (PERIOD_US * CLOCKS_PER_US)
#define SYSTICK_MASK 0xFFFFFFu
#define SYSTICK_RUNNING 0x5u /* enabled, at the clock of the processor */
#define OVERRUN_LIMIT 10u
#define WATCHDOG_MS 100u
#define SILENCE_LIMIT 500u /* cycles without a turn of communication, after which the watchdog is not fed */

typedef struct axis {
    uint8_t encoder_a;
    uint8_t slice;
    uint8_t direction_a;
    uint8_t direction_b;
    double rad_per_count;
    double homing_travel; /* rad */
} axis_t;

static const axis_t axes[AXES] = {
    {.encoder_a = 10,
     .slice = 1,
     .direction_a = 7,
     .direction_b = 8,
     .rad_per_count = 0.002825173249631109, /* 180 degrees in 1112 counts */
     .homing_travel = 3.490658503988659},   /* 200 degrees */
    {.encoder_a = 12,
     .slice = 2,
     .direction_a = 5,
     .direction_b = 6,
     .rad_per_count = 0.007107675686854735, /* 90 degrees in 221 counts */
     .homing_travel = 1.9198621771937625},  /* 110 degrees */
};

/* Control side. */
static epg_pico_quadrature_t encoders[AXES];
static bool reset_levels[AXES];
static int8_t directions[AXES];
static double duties[AXES]; /* as applied */
static guard_t guards[AXES];
static bool initialise, model_valid;
static double u[INPUTS], y[OUTPUTS];
static status_t status;
static uint32_t overruns_in_a_row, request_seen, turn_seen, silence;

/*
 * Shared by the cores.  The setpoints and the report pass through four buffers each, after H. Simpson: the writer never
 * writes to the buffer that the reader uses, and neither side waits.
 */
typedef struct exchange {
    atomic_uint latest;
    atomic_uint reading;
    atomic_uint newest[2];
    atomic_bool written;
} exchange_t;

static exchange_t setpoint_exchange, report_exchange;
static double setpoint_buffers[4][AXES];
static report_t report_buffers[4];
static atomic_uint request, dropped, turn;

/* Communication side. */
static double received[AXES];

static unsigned int write_begin(exchange_t *exchange)
{
    const unsigned int pair = 1u - atomic_load(&exchange->reading);
    return 2u * pair + 1u - atomic_load(&exchange->newest[pair]);
}

static void write_end(exchange_t *exchange, unsigned int buffer)
{
    atomic_store(&exchange->newest[buffer / 2u], buffer % 2u);
    atomic_store(&exchange->latest, buffer / 2u);
    atomic_store(&exchange->written, true);
}

static int read_begin(exchange_t *exchange)
{
    if (!atomic_load(&exchange->written)) {
        return -1;
    }
    const unsigned int pair = atomic_load(&exchange->latest);
    atomic_store(&exchange->reading, pair);
    return (int)(2u * pair + atomic_load(&exchange->newest[pair]));
}

static bool is_finite(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (bits >> 52 & 0x7FFu) != 0x7FFu;
}

static bool all_finite(const double *values, size_t count)
{
    for (size_t n = 0; n < count; n++) {
        if (!is_finite(values[n])) {
            return false;
        }
    }
    return true;
}

static void latch(fault_t fault, size_t axis)
{
    if (status.fault == FAULT_NONE) {
        status.fault = (uint8_t)fault;
        status.axis = (uint8_t)axis;
        status.statistics.faults++;
    }
    status.enabled = false;
}

/* Motion guards */

static fault_t homes(guard_t *guard, double travel, double angle, double duty)
{
    const double travelled = angle - guard->homing_origin;
    if (travelled > travel || travelled < -travel) {
        return FAULT_HOMING_TRAVEL;
    }
    if (duty != 0.0) {
        guard->driven++;
    }
    return guard->driven > HOMING_CYCLES ? FAULT_HOMING_TIME : FAULT_NONE;
}

static void check_motion(size_t n)
{
    guard_t *guard = &guards[n];
    const double angle = u[POSITION + n];
    fault_t fault = FAULT_NONE;
    if (!status.enabled) {
        guard->armed = false;
        return;
    }
    if (!guard->armed || guard->moved) {
        guard->homing = !guard->armed;
        if (guard->homing) {
            guard->homing_origin = angle;
            guard->driven = 0;
        }
        guard->armed = true;
        guard->moved = false;
        guard_begin(guard, angle);
    }
    if (runs_away(guard, angle, duties[n])) {
        fault = FAULT_RUNAWAY;
    } else if (guard->homing) {
        fault = homes(guard, axes[n].homing_travel, angle, duties[n]);
    } else if (stalls(guard, angle, duties[n])) {
        fault = FAULT_STALL;
    }
    if (fault != FAULT_NONE) {
        latch(fault, n);
    }
}

/* Outputs */

static void bridge_off(size_t n)
{
    pwm_set_chan_level(axes[n].slice, PWM_CHAN_A, 0);
    gpio_put(axes[n].direction_a, false);
    gpio_put(axes[n].direction_b, false);
    directions[n] = 0;
    duties[n] = 0.0;
}

static void bridge_write(size_t n, double duty)
{
    double size = duty < 0.0 ? -duty : duty;
    if (size > 1.0) {
        size = 1.0;
        status.statistics.clamped++;
    }
    const uint32_t level = (uint32_t)(size * (PWM_TOP + 1.0) + 0.5);
    const int8_t direction = level == 0 ? 0 : duty < 0.0 ? -1 : 1;
    if (direction != directions[n]) {
        bridge_off(n);
        gpio_put(axes[n].direction_a, direction > 0);
        gpio_put(axes[n].direction_b, direction < 0);
        directions[n] = direction;
    }
    duties[n] = direction == 0 ? 0.0 : direction < 0 ? -size : size;
    pwm_set_chan_level(axes[n].slice, PWM_CHAN_A, (uint16_t)level);
}

static void encoder_reset(size_t n, double signal)
{
    const bool level = signal > 0.5;
    if (level && !reset_levels[n]) {
        epg_pico_quadrature_preset(&encoders[n], 0);
        guards[n].moved = true;
    }
    reset_levels[n] = level;
}

/* Not inlined, so that the benchmark can measure the parts of a cycle separately. */
#define PART __attribute__((noinline))

static PART void write_outputs(bool drive)
{
    for (size_t n = 0; n < AXES; n++) {
        if (drive) {
            encoder_reset(n, y[RESET + n]);
            bridge_write(n, y[DUTY + n]);
        } else {
            reset_levels[n] = false;
            bridge_off(n);
        }
    }
}

/* Inputs */

static void take_request(void)
{
    const unsigned int newest = atomic_load(&request);
    if (newest == request_seen) {
        return;
    }
    request_seen = newest;
    if ((newest & 1u) == 0u) {
        status.enabled = false;
    } else if (!status.enabled) {
        status.fault = FAULT_NONE;
        status.enabled = true;
        initialise = true;
        overruns_in_a_row = 0;
    }
}

static PART bool read_inputs(void)
{
    for (size_t n = 0; n < AXES; n++) {
        int64_t counts;
        if (epg_pico_quadrature_read(&encoders[n], &counts) != EPG_PICO_QUADRATURE_OK) {
            latch(FAULT_SENSOR, n);
        }
        u[POSITION + n] = (double)counts * axes[n].rad_per_count;
    }
    const int buffer = read_begin(&setpoint_exchange);
    if (buffer >= 0) {
        memcpy(&u[SETPOINT], setpoint_buffers[buffer], sizeof setpoint_buffers[buffer]);
    }
    take_request();
    for (size_t n = 0; n < AXES; n++) {
        check_motion(n);
    }
    if (!all_finite(u, INPUTS)) {
        initialise = false;
        model_valid = false;
        latch(FAULT_NOT_FINITE, AXES);
        return false;
    }
    return true;
}

/* Model */

static void start_model(void)
{
    memset(xx_V, 0, xx_variables_size * sizeof xx_V[0]);
    memset(xx_s, 0, xx_states_size * sizeof xx_s[0]);
    memset(xx_R, 0, xx_states_size * sizeof xx_R[0]);
    xx_time = 0.0;
    xx_steps = 0;
    xx_stop_simulation = 0;
    XXInitializeSubmodel(u, y, 0.0);
    initialise = false;
    model_valid = true;
}

static bool step_model(void)
{
    if (initialise) {
        start_model();
    }
    if (!model_valid) {
        return false; /* stopped after a fault, until the target is enabled */
    }
    XXCalculateSubmodel(u, y, xx_time);
    if (!all_finite(y, OUTPUTS) || !all_finite(xx_s, xx_states_size) || !all_finite(xx_R, xx_states_size)) {
        model_valid = false;
        latch(FAULT_NOT_FINITE, AXES);
        return false;
    }
    if (xx_stop_simulation) {
        model_valid = false;
        latch(FAULT_STOPPED, AXES);
    }
    return true;
}

/* Statistics */

static void count_cycle(uint32_t lateness, uint32_t computation, uint32_t missed)
{
    statistics_t *statistics = &status.statistics;
    statistics->cycles++;
    if (lateness > statistics->lateness_max) {
        statistics->lateness_max = lateness;
    }
    if (computation < statistics->computation_min || statistics->cycles == 1u) {
        statistics->computation_min = computation;
    }
    if (computation > statistics->computation_max) {
        statistics->computation_max = computation;
    }
    statistics->computation_total += computation;
    if (lateness + computation <= PERIOD_CLOCKS && missed == 0u) {
        overruns_in_a_row = 0;
        return;
    }
    statistics->overruns++;
    statistics->missed += missed;
    overruns_in_a_row++;
    if (overruns_in_a_row >= OVERRUN_LIMIT) {
        latch(FAULT_OVERRUN, AXES);
        write_outputs(false);
    }
}

/** Counts the cycles since the last turn of the communication side, and feeds the watchdog while there are turns. */
static void watch_communication(void)
{
    const unsigned int newest = atomic_load(&turn);
    if (newest != turn_seen) {
        turn_seen = newest;
        silence = 0;
    } else if (newest != 0u) {
        silence++;
        if (silence > status.statistics.silence_max) {
            status.statistics.silence_max = silence;
        }
    }
    if (silence < SILENCE_LIMIT) {
        watchdog_update();
    }
}

static void publish(uint32_t due_us)
{
    const unsigned int buffer = write_begin(&report_exchange);
    report_t *report = &report_buffers[buffer];
    status.statistics.dropped = atomic_load(&dropped);
    memcpy(report->inputs, u, sizeof u);
    memcpy(report->outputs, y, sizeof y);
    report->due_us = due_us;
    report->status = status;
    write_end(&report_exchange, buffer);
}

/* The compiler would inline this function, because it is called in one place only.  The benchmark needs its name. */
__attribute__((noinline)) void control_cycle(uint32_t due_us, uint32_t lateness, uint32_t missed)
{
    const uint32_t begin = systick_hw->cvr;
    const bool stepped = read_inputs() && step_model();
    if (stepped || !status.enabled) {
        write_outputs(status.enabled);
    }
    count_cycle(lateness, (begin - systick_hw->cvr) & SYSTICK_MASK, missed);
    watch_communication();
    publish(due_us);
}

void control_start(uint32_t more)
{
    uint32_t mask = more;
    for (size_t n = 0; n < AXES; n++) {
        const axis_t *axis = &axes[n];
        const epg_pico_quadrature_config_t config = {.pin_a = axis->encoder_a,
                                                     .pin_b = (uint8_t)(axis->encoder_a + 1u),
                                                     .block = 0,
                                                     .state_machine = EPG_PICO_QUADRATURE_ANY};
        if (epg_pico_quadrature_init(&encoders[n], &config) != EPG_PICO_QUADRATURE_OK) {
            panic("encoder");
        }
        gpio_init(axis->direction_a);
        gpio_init(axis->direction_b);
        gpio_set_dir(axis->direction_a, true);
        gpio_set_dir(axis->direction_b, true);
        pwm_set_wrap(axis->slice, PWM_TOP);
        bridge_off(n);
        gpio_set_function(2u * axis->slice, GPIO_FUNC_PWM);
        mask |= 1u << axis->slice;
    }
    systick_hw->rvr = SYSTICK_MASK;
    systick_hw->csr = SYSTICK_RUNNING;
    initialise = true;
    status.enabled = true;
    watchdog_enable(WATCHDOG_MS, true);
    hw_set_bits(&pwm_hw->en, mask);
}

/* Communication side */

void control_setpoint(uint32_t axis, double value)
{
    if (!is_finite(value)) {
        atomic_store(&dropped, atomic_load(&dropped) + 1u);
        return;
    }
    received[axis] = value;
    const unsigned int buffer = write_begin(&setpoint_exchange);
    memcpy(setpoint_buffers[buffer], received, sizeof received);
    write_end(&setpoint_exchange, buffer);
}

bool control_report(report_t *report)
{
    const int buffer = read_begin(&report_exchange);
    if (buffer >= 0) {
        *report = report_buffers[buffer];
    }
    return buffer >= 0;
}

void control_enable(bool enable)
{
    const unsigned int sequence = (atomic_load(&request) | 1u) + 1u;
    atomic_store(&request, sequence | (enable ? 1u : 0u));
}

void control_alive(void)
{
    const unsigned int next = atomic_load(&turn) + 1u;
    atomic_store(&turn, next == 0u ? 1u : next); /* 0 means never */
}
