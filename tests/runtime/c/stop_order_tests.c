/**
 * @file
 * The order of the loads and stores in the latch of stops: at each of them, other contexts run.
 *
 * stop.c is compiled into this file, with a hook in each atomic access.  A test calls one of its functions, runs other
 * calls at one access, as an interrupt or another core would, and repeats this for each access.
 */

/* Beside the functions of the same names in the library. */
#define epg_stop hooked_stop
#define epg_gate_poll hooked_gate_poll
#define epg_gate_is_open hooked_gate_is_open
#define epg_gate_open hooked_gate_open
#define epg_gate_close hooked_gate_close
#define epg_gate_enable hooked_gate_enable
#define epg_gate_move hooked_gate_move
#define epg_gate_end_move hooked_gate_end_move
#define epg_control_enable hooked_control_enable
#define epg_stop_take hooked_stop_take
#define epg_stop_cancel hooked_stop_cancel
#define epg_stop_count hooked_stop_count

#include "check.h"
#include "epg/control.h"

static void hook(void);

#undef atomic_load
#undef atomic_store
#define atomic_load(object) (hook(), atomic_load_explicit(object, memory_order_seq_cst))
#define atomic_store(object, value) (hook(), atomic_store_explicit(object, value, memory_order_seq_cst))

#include "../../../targets/runtime/src/control/stop.c"

static epg_control_t control;
static unsigned int enablings;

/** Runs `run` once, before the access with number `at`. */
static struct {
    unsigned int at;
    void (*run)(void);
} interruption;

static void hook(void)
{
    if (interruption.run != NULL && interruption.at-- == 0U) {
        void (*const run)(void) = interruption.run;
        interruption.run = NULL;
        run();
    }
}

/* The calls ------------------------------------------------------------------------------------------------------ */

static bool clean;
static bool may_move;

/**
 * For each access of `call`: begins with a target that is `enabled` or not, calls `before` and `call`, runs `run` before
 * that access, and calls `after`.
 */
static void try_all(bool enabled, void (*before)(void), void (*call)(void), void (*run)(void), void (*after)(void))
{
    for (unsigned int at = 0;; at++) {
        memset(&control, 0, sizeof control);
        control.enabled = enabled;
        enablings = 0;
        before();
        interruption.at = at;
        interruption.run = run;
        call();
        if (interruption.run != NULL) { /* all accesses have been tried */
            interruption.run = NULL;
            CHECK(at > 0);
            return;
        }
        after();
    }
}

static void nothing(void)
{
}

static void cycle(void)
{
    unsigned int request = 0;
    if (control.enabled && atomic_load(&control.latch.pending) == 0U) {
        return;
    }
    if (epg_stop_take(&control, &request)) {
        control.enabled = false;
    } else if (request != 0U) {
        control.enabled = true;
        enablings++;
    }
}

static void cycles(void)
{
    for (int i = 0; i < 5; i++) {
        cycle();
    }
}

static void stop(void)
{
    epg_stop(&control, EPG_STOP_PROGRAM);
}

static void fault(void)
{
    epg_stop_count(&control, EPG_STOP_FAULT);
    control.enabled = false;
}

static void enable(void)
{
    epg_control_enable(&control, EPG_ENABLE_ANY);
}

static void stop_and_enable(void)
{
    stop();
    enable();
}

static void enable_and_stop(void)
{
    enable();
    stop();
}

static void stop_enable_and_cycles(void)
{
    stop_and_enable();
    cycles();
}

static void enable_and_cycles(void)
{
    enable();
    cycles();
}

static void poll_console(void)
{
    clean = epg_gate_poll(&control, EPG_GATE_CONSOLE);
}

static void open_edge(void)
{
    epg_gate_open(&control, EPG_GATE_EDGE);
}

static void move(void)
{
    may_move = epg_gate_move(&control);
}

static void check_disabled_cycle(void)
{
    cycle();
    CHECK(!control.enabled);
}

static void check_never_enabled(void)
{
    for (int i = 0; i < 10; i++) {
        check_disabled_cycle();
    }
}

static void check_enabled_once_and_stopped(void)
{
    cycles();
    CHECK_EQUAL(enablings, 1);
    CHECK(!control.enabled);
}

/** The enable waits for a disabled cycle, and is not lost. */
static void check_enabled_after_a_disabled_cycle(void)
{
    CHECK_EQUAL(enablings, 0);
    check_disabled_cycle();
    cycles();
    CHECK(control.enabled);
    CHECK_EQUAL(enablings, 1);
}

/* A stop that is interrupted ------------------------------------------------------------------------------------- */

TEST(cycles_during_a_stop)
{
    /* The enable may act before the stop is complete, and not after it. */
    try_all(false, enable, stop, cycles, check_never_enabled);
}

TEST(another_stop_and_its_enable_during_a_stop)
{
    try_all(true, nothing, stop, stop_enable_and_cycles, check_disabled_cycle);
}

TEST(an_enable_and_another_stop_during_a_stop)
{
    try_all(true, nothing, stop, enable_and_stop, check_never_enabled);
}

TEST(an_enable_that_has_acted_during_a_stop_does_not_act_after_it)
{
    try_all(false, nothing, stop, enable_and_cycles, check_enabled_once_and_stopped);
}

/* A cycle that is interrupted ------------------------------------------------------------------------------------ */

TEST(a_stop_during_a_cycle_that_enables)
{
    try_all(false, enable, cycle, stop, check_never_enabled);
}

TEST(a_stop_during_an_enabled_cycle)
{
    try_all(true, nothing, cycle, stop, check_never_enabled);
}

TEST(a_stop_and_an_enable_during_a_cycle)
{
    try_all(false, nothing, cycle, stop_and_enable, check_enabled_after_a_disabled_cycle);
    try_all(true, nothing, cycle, stop_and_enable, check_enabled_after_a_disabled_cycle);
}

TEST(another_stop_and_an_enable_during_the_cycle_that_takes_a_stop)
{
    try_all(true, stop, cycle, stop_and_enable, check_enabled_after_a_disabled_cycle);
}

TEST(another_stop_during_the_cycle_that_takes_a_stop_cancels_the_enable_between_them)
{
    try_all(true, stop_and_enable, cycle, stop, check_never_enabled);
}

TEST(an_enable_and_a_stop_during_a_fault)
{
    try_all(true, enable, fault, enable_and_stop, check_never_enabled);
}

/* Gates ---------------------------------------------------------------------------------------------------------- */

static void request_at_a_closed_gate(void)
{
    epg_gate_close(&control, EPG_GATE_EDGE);
    epg_gate_enable(&control, EPG_GATE_EDGE, EPG_ENABLE_ANY);
}

TEST(a_cycle_during_the_opening_of_a_gate)
{
    try_all(false, request_at_a_closed_gate, open_edge, cycle, check_never_enabled);
}

TEST(the_opening_of_a_gate_during_a_cycle)
{
    try_all(false, request_at_a_closed_gate, cycle, open_edge, check_never_enabled);
}

/** What was read in this poll may move the target, unless the stop came first. */
static void enable_if_clean(void)
{
    if (clean) {
        epg_gate_enable(&control, EPG_GATE_CONSOLE, EPG_ENABLE_ANY);
    }
    check_never_enabled();
}

TEST(a_stop_during_a_poll_of_a_gate)
{
    try_all(false, nothing, poll_console, stop, enable_if_clean);
    CHECK(clean); /* without the stop */
}

static void check_no_movement(void)
{
    CHECK(!may_move || atomic_load_explicit(&control.latch.moves, memory_order_seq_cst) == 0U);
}

TEST(a_stop_during_the_permission_of_a_movement_by_hand)
{
    try_all(false, nothing, move, stop, check_no_movement);
    CHECK(may_move); /* without the stop */
}

RUN()
