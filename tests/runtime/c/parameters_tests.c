/**
 * @file
 * Parameters: changed between cycles, kept when the target is enabled, stored.
 */
#include "epg/parameters.h"

#include <math.h>

#include "check.h"
#include "epg/store.h"
#include "fake_application.h"
#include "fake_port.h"

enum { COUNT = 10, MODEL = 140 /* offset of the model's name in a store */ };

static double model[COUNT]; /* the model's parameters */
static unsigned int sets;   /* calls of set() */
static unsigned int steps_at_set;

static void set(const double *new_values, const bool *which)
{
    for (size_t i = 0; i < COUNT; i++) {
        model[i] = which[i] ? new_values[i] : model[i];
    }
    sets++;
    steps_at_set = fake.steps;
}

static const epg_parameter_t table[COUNT] = {
    {"PID\\kp", "", 2.6}, {"PID\\tauD", "s", 0.05}, {"a", "", 0.0}, {"b", "", 0.0}, {"c", "", 0.0},
    {"d", "", 0.0},       {"e", "", 0.0},           {"f", "", 0.0}, {"g", "", 0.0}, {"h", "", 0.0},
};
static double values[COUNT];
static double applied[COUNT];
static bool wanted[COUNT];
static epg_parameter_limits_t limits[COUNT];
static bool changed[COUNT];
static unsigned char bytes[EPG_STORE_SIZE(COUNT)];
static epg_parameters_t parameters;
static epg_store_t store;

static void make(uint64_t model_id)
{
    sets = 0;
    for (size_t i = 0; i < COUNT; i++) {
        model[i] = table[i].value;
    }
    parameters = (epg_parameters_t){.count = COUNT,
                                    .table = table,
                                    .model = model_id,
                                    .set = set,
                                    .values = values,
                                    .wanted = wanted,
                                    .applied = applied,
                                    .changed = changed};
    store = (epg_store_t){.bytes = bytes, .parameters = &parameters};
    epg_store_load(&store);
}

static void begin(void)
{
    fake_reset();
    make(1);
    fake.application.parameters = &parameters;
    fake_start();
}

static bool change(size_t index, double value)
{
    const epg_parameter_change_t one = {index, value};
    return epg_parameters_change(&parameters, &one, 1);
}

TEST(changes_act_between_two_steps_and_all_in_one_cycle)
{
    begin();
    fake_cycles(3);
    CHECK(change(0, 3.5));
    CHECK(!epg_parameters_idle(&parameters));
    CHECK_EQUAL(model[0], 2.6);
    fake_cycle();
    CHECK(epg_parameters_idle(&parameters));
    CHECK_EQUAL(model[0], 3.5);
    CHECK_EQUAL(steps_at_set, 3);

    epg_parameter_change_t all[COUNT];
    for (size_t i = 0; i < COUNT; i++) {
        all[i] = (epg_parameter_change_t){i, 100.0 + (double)i};
    }
    CHECK(epg_parameters_change(&parameters, all, COUNT));
    fake_cycle();
    for (size_t i = 0; i < COUNT; i++) {
        CHECK_EQUAL(model[i], 100.0 + (double)i);
        CHECK_EQUAL(epg_parameters_value(&parameters, i), 100.0 + (double)i);
    }
    CHECK_EQUAL(sets, 2); /* the model derives its values once per request */
    fake_cycles(5);
    CHECK_EQUAL(sets, 2);
}

TEST(all_changes_or_none)
{
    begin();
    fake_cycle();
    const epg_parameter_change_t with_nan[2] = {{0, 1.0}, {1, NAN}};
    const epg_parameter_change_t with_infinity[2] = {{0, 1.0}, {1, -INFINITY}};
    const epg_parameter_change_t unknown[2] = {{0, 1.0}, {COUNT, 1.0}};
    const epg_parameter_change_t none[1] = {{0, 1.0}};
    CHECK(!epg_parameters_change(&parameters, with_nan, 2));
    CHECK(!epg_parameters_change(&parameters, with_infinity, 2));
    CHECK(!epg_parameters_change(&parameters, unknown, 2));
    CHECK(!epg_parameters_change(&parameters, none, 0));
    fake_cycles(2);
    CHECK_EQUAL(model[0], 2.6);
    CHECK_EQUAL(epg_parameters_value(&parameters, 0), 2.6);
    CHECK_EQUAL(sets, 0);
}

TEST(limits_are_possible_values_and_others_are_refused)
{
    begin();
    for (size_t i = 0; i < COUNT; i++) {
        limits[i] = (epg_parameter_limits_t){-INFINITY, INFINITY};
    }
    limits[1] = (epg_parameter_limits_t){0.0, 2.0};
    parameters.limits = limits;
    const epg_parameter_change_t with_high[2] = {{0, 1.0}, {1, nextafter(2.0, 3.0)}};
    CHECK(!epg_parameters_change(&parameters, with_high, 2));
    CHECK(!change(1, -1e-300));
    CHECK(change(1, 2.0));
    fake_cycle();
    CHECK(change(1, 0.0));
    fake_cycle();
    CHECK(change(0, -1e300));
    fake_cycle();
    CHECK_EQUAL(sets, 3);
    CHECK_EQUAL(model[0], -1e300);
    CHECK(!epg_parameters_can_be(&parameters, COUNT, 1.0));
}

TEST(a_change_waits_for_the_one_before)
{
    begin();
    fake_cycle();
    CHECK(change(0, 1.0));
    CHECK(!change(0, 2.0));
    CHECK_EQUAL(epg_parameters_value(&parameters, 0), 1.0);
    fake_cycle();
    CHECK_EQUAL(model[0], 1.0);
    CHECK(change(0, 2.0));
    fake_cycle();
    CHECK_EQUAL(model[0], 2.0);
}

/** model_init() of a real model sets its parameters to the generated values. */
static void forget(void)
{
    for (size_t i = 0; i < COUNT; i++) {
        model[i] = table[i].value;
    }
}

TEST(changes_outlive_enabling)
{
    begin();
    fake_cycle();
    CHECK(change(1, 0.07));
    fake_cycle();
    epg_stop(&fake.control, EPG_STOP_PROGRAM);
    fake_cycles(2);
    CHECK(change(2, 5.0)); /* while disabled: the model keeps running */
    fake_cycle();
    CHECK_EQUAL(model[2], 5.0);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    forget();
    const unsigned int inits = fake.inits;
    fake_cycle();
    CHECK_EQUAL(fake.inits, inits + 1);
    CHECK_EQUAL(model[1], 0.07);
    CHECK_EQUAL(model[2], 5.0);
    CHECK_EQUAL(model[0], 2.6);
}

TEST(a_model_that_rests_is_not_touched_until_it_is_initialised)
{
    begin();
    fake_cycle();
    fake.output_error = NAN;
    fake_cycle();
    CHECK(!fake_status().enabled);
    fake.output_error = 0.0;
    CHECK(change(0, 9.0));
    fake_cycle();
    CHECK(epg_parameters_idle(&parameters));
    CHECK_EQUAL(sets, 0);
    epg_control_enable(&fake.control, EPG_ENABLE_ANY);
    fake_cycle();
    CHECK_EQUAL(model[0], 9.0);
}

TEST(stored_values_are_back_after_a_restart)
{
    size_t stored = 99;
    begin();
    CHECK(parameters.stored == EPG_STORED_NOTHING);
    fake_cycle();
    CHECK(change(0, 0.1));
    fake_cycle();
    CHECK(change(9, -1e-300));
    fake_cycle();
    CHECK(epg_store_save(&store, &stored) == NULL);
    CHECK_EQUAL(stored, 2);

    make(1); /* the next start: the store is unchanged */
    CHECK(parameters.stored == EPG_STORED_LOADED);
    CHECK_EQUAL(epg_parameters_value(&parameters, 0), 0.1);
    CHECK_EQUAL(epg_parameters_value(&parameters, 1), 0.05);
    CHECK_EQUAL(epg_parameters_value(&parameters, 9), -1e-300);
    epg_control_start(&fake.control, &fake.application);
    fake_cycle();
    CHECK_EQUAL(model[0], 0.1); /* from the first cycle on */
    CHECK_EQUAL(model[9], -1e-300);
    CHECK_EQUAL(sets, 1);
}

TEST(of_stored_values_only_those_outside_of_new_limits_are_refused)
{
    size_t stored;
    begin();
    CHECK(change(0, 5.0));
    fake_cycle();
    CHECK(change(1, 3.0));
    fake_cycle();
    CHECK(change(9, -7.0));
    fake_cycle();
    CHECK(epg_store_save(&store, &stored) == NULL);
    CHECK(parameters.stored == EPG_STORED_SAVED);
    make(1);
    for (size_t i = 0; i < COUNT; i++) {
        limits[i] = (epg_parameter_limits_t){-4.0, 4.0};
    }
    parameters.limits = limits;
    epg_store_load(&store);
    CHECK(parameters.stored == EPG_STORED_PARTLY);
    CHECK_EQUAL(epg_parameters_value(&parameters, 0), 2.6);
    CHECK_EQUAL(epg_parameters_value(&parameters, 1), 3.0);
    CHECK(changed[1] && !changed[0] && !changed[9]);
    CHECK(strcmp(epg_store_refused(&store, 0), table[0].name) == 0);
    CHECK(strcmp(epg_store_refused(&store, 1), table[9].name) == 0);
    CHECK(epg_store_refused(&store, 2) == NULL);
    CHECK(epg_store_save(&store, &stored) == NULL);
    CHECK_EQUAL(stored, 1);
    CHECK(epg_store_refused(&store, 0) == NULL);
}

TEST(a_value_that_is_as_generated_again_is_not_stored)
{
    size_t stored = 99;
    begin();
    CHECK(change(0, 0.1));
    fake_cycle();
    CHECK(change(0, 2.6));
    fake_cycle();
    CHECK(epg_store_save(&store, &stored) == NULL);
    CHECK_EQUAL(stored, 0);
    make(1);
    CHECK(parameters.stored == EPG_STORED_LOADED);
    CHECK(!changed[0]);
}

static void store_some(void)
{
    size_t stored;
    begin();
    fake_cycle();
    CHECK(change(0, 0.1));
    fake_cycle();
    CHECK(epg_store_save(&store, &stored) == NULL);
}

static void check_as_generated(epg_parameters_stored_t expected)
{
    CHECK(parameters.stored == expected);
    for (size_t i = 0; i < COUNT; i++) {
        CHECK_EQUAL(epg_parameters_value(&parameters, i), table[i].value);
        CHECK(!changed[i]);
    }
}

TEST(values_of_another_model_are_refused)
{
    store_some();
    make(2);
    check_as_generated(EPG_STORED_FOR_OTHER);
}

TEST(a_store_with_any_wrong_bit_is_refused)
{
    store_some();
    for (size_t bit = 0; bit < fake_port.store_size * 8U; bit++) {
        fake_port.store[bit / 8U] ^= (unsigned char)(1U << bit % 8U);
        make(1);
        check_as_generated(bit / 8U >= MODEL && bit / 8U < MODEL + 8U ? EPG_STORED_FOR_OTHER : EPG_STORED_DAMAGED);
        fake_port.store[bit / 8U] ^= (unsigned char)(1U << bit % 8U);
    }
    make(1);
    CHECK(parameters.stored == EPG_STORED_LOADED);
}

TEST(a_store_that_is_cut_off_is_refused)
{
    store_some();
    for (size_t size = 0; size < fake_port.store_size; size++) {
        const size_t whole = fake_port.store_size;
        fake_port.store_size = size;
        make(1);
        check_as_generated(size == 0 ? EPG_STORED_NOTHING : EPG_STORED_DAMAGED);
        fake_port.store_size = whole;
    }
}

TEST(random_bytes_are_no_store)
{
    fake_reset();
    srand(1);
    for (int i = 0; i < 20000; i++) {
        fake_port.store_size = (size_t)rand() % 340U;
        for (size_t k = 0; k < fake_port.store_size; k++) {
            fake_port.store[k] = (unsigned char)rand();
        }
        if (i % 2 == 0) { /* with a valid beginning */
            static const unsigned char head[8] = {'E', 'P', 'G', 'P', 2};
            static const unsigned char model_one[12] = {1};
            memcpy(fake_port.store, head, sizeof head);
            memcpy(fake_port.store + MODEL, model_one, sizeof model_one);
            fake_port.store[MODEL + 8] = (unsigned char)(rand() % 16);
        }
        make(1);
        check_as_generated(parameters.stored);
        CHECK(parameters.stored != EPG_STORED_LOADED);
    }
}

TEST(a_port_that_stores_nothing_says_so)
{
    size_t stored;
    begin();
    fake_port.store_refuses = true;
    CHECK(strcmp(epg_store_save(&store, &stored), "the fake memory is worn out") == 0);
    CHECK(parameters.stored == EPG_STORED_NOTHING);
}

TEST(a_change_that_a_stop_has_left_is_forgotten)
{
    begin();
    CHECK(change(0, 1.0));
    make(1);
    CHECK(epg_parameters_idle(&parameters));
    CHECK_EQUAL(epg_parameters_value(&parameters, 0), 2.6);
}

RUN()
