/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * JIWY's control cycle as an engineer would write it for this one robot with the Pico SDK, without a generator.
 *
 * It has the same functions as the generated target: encoders with a reset, H-bridges with a direction, tests for
 * values that are not finite, a disabled state, a count of overruns, and values that are passed between the cores.  The
 * cores share values in the SDK's way, under a spin lock.  Parameters, capture, moving by hand, motion guards and the
 * measurement of stacks are left out.
 */
#include "handwritten.h"

#include <string.h>

#include "epg/pico_quadrature.h"
#include "hardware/pwm.h"
#include "pico/critical_section.h"
#include "pico/stdlib.h"
#include "xxsubmod.h"

#define PWM_TOP (SYS_CLK_HZ / 20000u - 1u) /* 20 kHz */
#define OVERRUN_LIMIT 10u

enum { POSITION, SETPOINT = 2, INPUTS = 4 };
enum { RESET, LOGGING_PAN = 2, DUTY = 3, LOGGING_TILT = 5, OUTPUTS = 6 };

typedef struct axis {
    uint8_t encoder_a;
    uint8_t slice;
    uint8_t direction_a;
    uint8_t direction_b;
    double rad_per_count;
} axis_t;

static const axis_t axes[AXES] = {
    {.encoder_a = 10, .slice = 1, .direction_a = 7, .direction_b = 8, .rad_per_count = 0.002825173249631109},
    {.encoder_a = 12, .slice = 2, .direction_a = 5, .direction_b = 6, .rad_per_count = 0.007107675686854735},
};

static epg_pico_quadrature_t encoders[AXES];
static bool reset_levels[AXES];
static int8_t directions[AXES];
static double u[INPUTS], y[OUTPUTS];
static bool model_valid;
static uint32_t overruns_in_a_row;

/* Shared by the cores; protected by the lock. */
static critical_section_t lock;
static double setpoints_given[AXES], positions_shown[AXES];
static statistics_t statistics;
static bool enable_asked, enabled;

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

static void bridge_off(size_t n)
{
    pwm_set_chan_level(axes[n].slice, PWM_CHAN_A, 0);
    gpio_put(axes[n].direction_a, false);
    gpio_put(axes[n].direction_b, false);
    directions[n] = 0;
}

static void bridge_write(size_t n, double duty)
{
    double size = duty < 0.0 ? -duty : duty;
    if (size > 1.0) {
        size = 1.0;
    }
    const uint32_t level = (uint32_t)(size * (PWM_TOP + 1.0) + 0.5);
    const int8_t direction = level == 0 ? 0 : duty < 0.0 ? -1 : 1;
    if (direction != directions[n]) {
        bridge_off(n);
        gpio_put(axes[n].direction_a, direction > 0);
        gpio_put(axes[n].direction_b, direction < 0);
        directions[n] = direction;
    }
    pwm_set_chan_level(axes[n].slice, PWM_CHAN_A, (uint16_t)level);
}

static void encoder_reset(size_t n, double signal)
{
    const bool level = signal > 0.5;
    if (level && !reset_levels[n]) {
        epg_pico_quadrature_preset(&encoders[n], 0);
    }
    reset_levels[n] = level;
}

/* Not inlined, so that the benchmark can measure the parts of a cycle separately. */
#define PART __attribute__((noinline))

static PART bool read_inputs(void)
{
    bool good = true;
    for (size_t n = 0; n < AXES; n++) {
        int64_t counts;
        good = epg_pico_quadrature_read(&encoders[n], &counts) == EPG_PICO_QUADRATURE_OK && good;
        u[POSITION + n] = (double)counts * axes[n].rad_per_count;
    }
    critical_section_enter_blocking(&lock);
    memcpy(&u[SETPOINT], setpoints_given, sizeof setpoints_given);
    if (enable_asked && !enabled) {
        model_valid = false;
    }
    enabled = enable_asked;
    critical_section_exit(&lock);
    return good && all_finite(u, INPUTS);
}

static PART bool step_model(void)
{
    if (!model_valid) {
        xx_time = 0.0;
        xx_initialize = 1;
        XXInitializeSubmodel(u, y, 0.0);
        model_valid = true;
    }
    XXCalculateSubmodel(u, y, xx_time);
    return all_finite(y, OUTPUTS) && all_finite(xx_s, xx_states_size) && all_finite(xx_R, xx_states_size);
}

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

static void count(uint32_t begin_us, uint32_t due_us)
{
    const uint32_t end_us = time_us_32();
    const bool overrun = end_us - due_us > PERIOD_US;
    overruns_in_a_row = overrun ? overruns_in_a_row + 1u : 0u;
    critical_section_enter_blocking(&lock);
    statistics.cycles++;
    statistics.overruns += overrun ? 1u : 0u;
    if (end_us - begin_us > statistics.computation_max_us) {
        statistics.computation_max_us = end_us - begin_us;
    }
    positions_shown[PAN] = y[LOGGING_PAN];
    positions_shown[TILT] = y[LOGGING_TILT];
    if (overruns_in_a_row >= OVERRUN_LIMIT) {
        enable_asked = false;
    }
    critical_section_exit(&lock);
}

/* The compiler would inline this function, because it is called in one place only.  The benchmark needs its name. */
__attribute__((noinline)) void control_cycle(uint32_t due_us)
{
    const uint32_t begin_us = time_us_32();
    const bool good = read_inputs() && step_model();
    if (!good) {
        enable_asked = false;
    }
    write_outputs(enabled && good);
    count(begin_us, due_us);
}

void control_start(uint32_t more)
{
    uint32_t mask = more;
    critical_section_init(&lock);
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
    enable_asked = true;
    enabled = true;
    hw_set_bits(&pwm_hw->en, mask);
}

void control_setpoints(const double setpoints[AXES])
{
    critical_section_enter_blocking(&lock);
    memcpy(setpoints_given, setpoints, sizeof setpoints_given);
    critical_section_exit(&lock);
}

void control_positions(double positions[AXES])
{
    critical_section_enter_blocking(&lock);
    memcpy(positions, positions_shown, sizeof positions_shown);
    critical_section_exit(&lock);
}

void control_statistics(statistics_t *copy)
{
    critical_section_enter_blocking(&lock);
    *copy = statistics;
    copy->enabled = enabled;
    critical_section_exit(&lock);
}

void control_enable(bool enable)
{
    critical_section_enter_blocking(&lock);
    enable_asked = enable;
    critical_section_exit(&lock);
}
