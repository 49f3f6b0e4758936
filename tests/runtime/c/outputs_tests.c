/**
 * @file
 * H-bridges whose outputs refuse writes: all sets of failing pins, all their levels, and all changes of duty.
 */
#include <math.h>

#include "check.h"
#include "dual_pwm_h_bridge.h"
#include "epg/outputs.h"
#include "fake_port.h"
#include "pwm_h_bridge.h"

enum { PINS = 3, FIRST = 4, TOP = 999, COMPONENT = 7 };

/* Copies from component.yaml of the kinds; test_builtin_catalog.py compares them. */
static const epg_safe_state_t single_states[] = {{.low = 1}, {.low = 6}, {.high = 6}};
static const epg_safe_state_t dual_states[] = {{.low = 3}, {.high = 3}};

static const epg_output_group_t single_group = {
    .component = COMPONENT, .first = FIRST, .count = 3, .state_count = 3, .states = single_states};
static const epg_output_group_t dual_group = {
    .component = COMPONENT, .first = FIRST, .count = 2, .state_count = 2, .states = dual_states};

/** A duty that means a call of safe(). */
#define SAFE 2.0
static const double duties[] = {-1.0, -0.5, 0.0, 0.5, 1.0, NAN, SAFE};
enum { DUTIES = sizeof duties / sizeof duties[0] };

/** The configuration of the bridge, and the state of its driver. */
static struct {
    bool is_dual;
    epg_pwm_h_bridge_config_t single_config;
    epg_pwm_h_bridge_t single;
    epg_dual_pwm_h_bridge_config_t dual_config;
    epg_dual_pwm_h_bridge_t dual;
} motor;

static epg_outputs_t outputs;
static uint32_t refuses_take_over; /* pins, one bit each */
static uint32_t taken;             /* pins that are plain pins, one bit each */
static double taken_levels[PINS];
static double stuck[PINS]; /* share of the period for which a refusing pin is high; NAN: as before */
static unsigned int take_overs;

/** The share of the period for which a pin is high. */
static double share(unsigned int i)
{
    const unsigned int pin = FIRST + i;
    if ((taken >> pin & 1U) != 0U) {
        return taken_levels[i];
    }
    if ((fake_port.refused >> pin & 1U) != 0U && !isnan(stuck[i])) {
        return stuck[i];
    }
    const bool is_pwm = motor.is_dual || i == 0U;
    return is_pwm ? (double)fake_port.levels[i] / (TOP + 1) : fake_port.outputs[pin] ? 1.0 : 0.0;
}

/** The mean voltage by the kinds' truth tables; more than 0 is forwards. */
static double drive(void)
{
    return motor.is_dual ? share(0) - share(1) : share(0) * (share(1) - share(2));
}

static int sign(double value)
{
    return (value > 0.0) - (value < 0.0);
}

/* While pins refuse, the motor is only driven in the direction before the change, or in that after it. */
static bool watching;
static int allowed[3];

static void watch(void)
{
    const int now = sign(drive());
    CHECK(!watching || now == 0 || now == allowed[0] || now == allowed[1] || now == allowed[2]);
}

static bool take_over(size_t row, bool high)
{
    CHECK(row >= FIRST && row < FIRST + PINS);
    take_overs++;
    if ((refuses_take_over >> row & 1U) != 0U) {
        fake_port.refused |= 1U << row;
        taken &= ~(1U << row);
        return false;
    }
    taken |= 1U << row;
    taken_levels[row - FIRST] = high ? 1.0 : 0.0;
    watch();
    return true;
}

static void command(double duty)
{
    if (duty == SAFE && motor.is_dual) {
        epg_dual_pwm_h_bridge_safe(&motor.dual, &motor.dual_config);
    } else if (duty == SAFE) {
        epg_pwm_h_bridge_safe(&motor.single, &motor.single_config);
    } else if (motor.is_dual) {
        (void)epg_dual_pwm_h_bridge_command(&motor.dual, &motor.dual_config, duty);
        epg_dual_pwm_h_bridge_set(&motor.dual, &motor.dual_config);
    } else {
        (void)epg_pwm_h_bridge_command(&motor.single, &motor.single_config, duty);
        epg_pwm_h_bridge_apply(&motor.single, &motor.single_config);
    }
}

static void begin(bool is_dual, epg_bridge_config_t config, bool slow_decay)
{
    fake_port_reset();
    taken = 0;
    take_overs = 0;
    watching = false;
    motor.is_dual = is_dual;
    motor.single_config = (epg_pwm_h_bridge_config_t){
        .pwm = {.pin = FIRST, .slot = 0, .top = TOP}, .pin_a = FIRST + 1, .pin_b = FIRST + 2, .bridge = config};
    motor.dual_config = (epg_dual_pwm_h_bridge_config_t){.forwards = {.pin = FIRST, .slot = 0, .top = TOP},
                                                         .backwards = {.pin = FIRST + 1, .slot = 1, .top = TOP},
                                                         .slow_decay = slow_decay,
                                                         .bridge = config};
    epg_outputs_start(&outputs, is_dual ? &dual_group : &single_group, 1);
    fake_port.guarded = &outputs;
    fake_port.take_over = take_over;
    fake_port.on_write = watch;
    if (is_dual) {
        epg_dual_pwm_h_bridge_start(&motor.dual, &motor.dual_config);
    } else {
        epg_pwm_h_bridge_start(&motor.single, &motor.single_config);
    }
}

/** True if the component is safe for every level of the pins that have refused and could not be taken over. */
static bool is_safe_at_any_level(void)
{
    static const double levels[] = {0.0, 0.5, 1.0};
    const unsigned int count = motor.is_dual ? 2U : 3U;
    const double saved[PINS] = {stuck[0], stuck[1], stuck[2]};
    bool safe = true;
    for (unsigned int combination = 0; combination < 27U; combination++) {
        unsigned int rest = combination;
        for (unsigned int i = 0; i < count; i++, rest /= 3U) {
            stuck[i] = levels[rest % 3U];
        }
        safe = safe && drive() == 0.0;
    }
    memcpy(stuck, saved, sizeof stuck);
    return safe;
}

/** One case: a duty, then another one while pins refuse, then all duties again. */
static void fail(uint32_t refuses, uint32_t refuses_too, double from, double to)
{
    command(0.0);
    command(from);
    const int driven = motor.is_dual ? (motor.dual.bridge.driven == EPG_BRIDGE_BACKWARDS ? -1 : 1)
                                     : (motor.single.bridge.driven == EPG_BRIDGE_BACKWARDS ? -1 : 1);
    allowed[0] = sign(drive());
    allowed[1] = to == SAFE || isnan(to) ? 0 : sign(to);
    allowed[2] = driven;
    stuck[0] = stuck[1] = stuck[2] = (double)NAN;
    watching = true;
    fake_port.refuses = refuses << FIRST;
    refuses_take_over = refuses_too << FIRST;
    command(to);
    if (!outputs.refused) { /* the refusing pins were not written */
        CHECK_EQUAL(take_overs, 0);
        return;
    }
    CHECK_EQUAL(outputs.component, COMPONENT);
    CHECK(outputs.unsafe != is_safe_at_any_level());
    const double left = drive();
    const unsigned int done = take_overs;
    for (int i = 0; i < DUTIES; i++) {
        command(duties[i]);
        CHECK_EQUAL(drive(), left); /* no further write */
    }
    CHECK_EQUAL(take_overs, done);
}

typedef struct counts {
    unsigned int safe;
    unsigned int unsafe;
} counts_t;

/** All sets of failing pins, all subsets of these that cannot be taken over, and all changes of duty. */
static counts_t fail_all(bool is_dual)
{
    static const epg_bridge_state_t rests[] = {EPG_BRIDGE_COAST, EPG_BRIDGE_BRAKE};
    const uint32_t all = is_dual ? 3U : 7U;
    counts_t counts = {0};
    for (unsigned int configuration = 0; configuration < 8U; configuration++) {
        const epg_bridge_config_t config = {
            .max_duty = 1.0, .zero = rests[configuration & 1U], .safe = rests[configuration >> 1 & 1U]};
        for (uint32_t refuses = 1; refuses <= all; refuses++) {
            for (uint32_t refuses_too = 0; refuses_too <= all; refuses_too++) {
                for (int from = 0; (refuses_too & ~refuses) == 0U && from < DUTIES * DUTIES; from++) {
                    begin(is_dual, config, configuration >> 2 != 0U);
                    fail(refuses, refuses_too, duties[from / DUTIES], duties[from % DUTIES]);
                    counts.unsafe += outputs.unsafe ? 1U : 0U;
                    counts.safe += outputs.refused && !outputs.unsafe ? 1U : 0U;
                }
            }
        }
    }
    return counts;
}

TEST(one_pwm_and_two_direction_pins)
{
    const counts_t counts = fail_all(false);
    CHECK(counts.safe > 5000);
    CHECK(counts.unsafe > 100);
}

TEST(two_pwm_pins)
{
    const counts_t counts = fail_all(true);
    CHECK(counts.safe > 500);
    CHECK(counts.unsafe > 500);
}

/* The behaviour of a bridge with a pin that could not be taken over. */

static void fail_one(bool is_dual, unsigned int pin, double from, double to)
{
    begin(is_dual, (epg_bridge_config_t){.max_duty = 1.0}, false);
    fail(1U << pin, 1U << pin, from, to);
}

TEST(the_other_input_of_a_bridge_is_no_way_out)
{
    fail_one(true, 0, 0.5, -0.5);
    CHECK(outputs.unsafe);
    CHECK_EQUAL(fake_port.levels[0], 500); /* it drives forwards until the watchdog resets */
    CHECK_EQUAL(fake_port.levels[1], 0);
    CHECK_EQUAL(taken, 0);
}

TEST(direction_pins_make_up_for_a_pwm)
{
    fail_one(false, 0, 0.5, 0.25);
    CHECK(outputs.refused && !outputs.unsafe);
    CHECK_EQUAL(share(1), 0.0);
    CHECK_EQUAL(share(2), 0.0);
}

TEST(a_pwm_makes_up_for_direction_pins)
{
    fail_one(false, 1, 0.5, -0.5);
    CHECK(outputs.refused && !outputs.unsafe);
    CHECK_EQUAL(share(0), 0.0);
}

TEST(an_output_of_no_component_cannot_be_made_safe)
{
    epg_outputs_start(&outputs, &dual_group, 1);
    epg_outputs_refused(&outputs, EPG_OUTPUTS_ROWS, take_over);
    CHECK(outputs.refused && outputs.unsafe);
    CHECK_EQUAL(outputs.component, UINT16_MAX);
}

static unsigned int taken_rows; /* one bit each */

static bool note_take_over(size_t row, bool high)
{
    CHECK(!high);
    taken_rows |= 1U << row;
    return true;
}

TEST(only_the_component_whose_output_refused_is_given_up)
{
    static const epg_output_group_t groups[] = {
        {.component = 3, .first = 2, .count = 3, .state_count = 3, .states = single_states},
        {.component = 4, .first = 5, .count = 2, .state_count = 2, .states = dual_states},
        {.component = 5, .first = 7, .count = 2, .state_count = 2, .states = dual_states}};
    for (size_t row = 5; row < 7; row++) {
        taken_rows = 0;
        epg_outputs_start(&outputs, groups, 3);
        epg_outputs_refused(&outputs, row, note_take_over);
        CHECK_EQUAL(outputs.component, 4);
        CHECK(outputs.refused && !outputs.unsafe);
        CHECK_EQUAL(taken_rows, 1U << row); /* the other output was low since the start */
        for (size_t other = 2; other < 9; other++) {
            CHECK(epg_outputs_may_write(&outputs, other) == (other < 5 || other > 6));
        }
    }
}

RUN()
