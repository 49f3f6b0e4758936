/**
 * @file
 * The motion guard by itself: motions that are a fault, and motions that must not be one.
 */
#include "motion_guard.h"

#include <math.h>

#include "check.h"

/* Any numbers: the generator writes those of the kind's faults. */
static const epg_fault_t STALL = (epg_fault_t)300, RUNAWAY = (epg_fault_t)301, HOMING_TRAVEL = (epg_fault_t)302,
                         HOMING_TIME = (epg_fault_t)303;

static epg_motion_guard_t guard;
static epg_motion_guard_config_t config;
static double angle;
static uint32_t resets;

static void begin(epg_motion_guard_config_t checks)
{
    config = checks;
    config.faults.stall = STALL;
    config.faults.runaway = RUNAWAY;
    config.faults.homing_travel = HOMING_TRAVEL;
    config.faults.homing_time = HOMING_TIME;
    angle = 0.0;
    resets = 0;
    epg_motion_guard_start(&guard);
}

static epg_fault_t step(double duty, double motion)
{
    angle += motion;
    return epg_motion_guard_check(&guard, &config, true, angle, resets, duty);
}

/** The number of the step that first finds a fault, 1 ... `count`; 0 if no step does. */
static int fault_after(int count, double duty, double motion, epg_fault_t fault)
{
    for (int i = 1; i <= count; i++) {
        const epg_fault_t found = step(duty, motion);
        if (found != EPG_FAULT_NONE) {
            CHECK(found == fault);
            return i;
        }
    }
    return 0;
}

/* Stall --------------------------------------------------------------------------------------------------------- */

static const epg_motion_guard_config_t stall = {.stall = {.duty = 0.3, .angle = 0.1, .cycles = 100}};

TEST(stall_when_driven_without_motion)
{
    begin(stall);
    CHECK_EQUAL(fault_after(1000, 0.3, 0.0, STALL), 100);
    begin(stall);
    CHECK_EQUAL(fault_after(1000, -0.5, 0.0, STALL), 100);
}

TEST(no_stall_below_the_duty)
{
    begin(stall);
    CHECK_EQUAL(fault_after(10000, 0.299, 0.0, STALL), 0);
}

TEST(no_stall_while_the_axis_moves)
{
    begin(stall);
    CHECK_EQUAL(fault_after(10000, 1.0, 0.0011, STALL), 0);
    begin(stall);
    CHECK_EQUAL(fault_after(10000, 1.0, -0.0011, STALL), 0); /* in both directions */
}

TEST(stall_after_motion)
{
    begin(stall);
    CHECK_EQUAL(fault_after(1000, 1.0, 0.01, STALL), 0);
    const int found = fault_after(1000, 1.0, 0.0, STALL);
    CHECK(found > 0 && found <= 100);
}

TEST(stall_when_the_axis_moves_too_little)
{
    begin(stall);
    CHECK(fault_after(200, 1.0, 0.0009, STALL) >= 100);
}

TEST(counts_that_flicker_are_no_motion)
{
    begin(stall);
    int found = 0;
    for (int i = 0; i < 200 && found == 0; i++) {
        found = step(0.5, i % 2 == 0 ? 0.05 : -0.05) == STALL ? i : 0;
    }
    CHECK_EQUAL(found, 99);
}

TEST(gaps_in_the_drive_do_not_hide_a_stall)
{
    begin(stall);
    int found = 0;
    for (int i = 0; i < 1000 && found == 0; i++) {
        found = step(i % 5 == 4 ? 0.1 : 0.6, 0.0) == STALL ? i : 0;
    }
    CHECK(found > 100 && found < 200);
}

TEST(a_drive_that_dithers_is_no_stall)
{
    begin(stall);
    for (int i = 0; i < 10000; i++) {
        CHECK(step(i / 20 % 2 == 0 ? 0.8 : -0.8, 0.0) == EPG_FAULT_NONE);
    }
}

TEST(time_below_the_duty_takes_back_time_above)
{
    begin(stall);
    for (int i = 0; i < 50; i++) {
        CHECK_EQUAL(fault_after(90, 0.5, 0.0, STALL), 0);
        CHECK_EQUAL(fault_after(90, 0.0, 0.0, STALL), 0);
    }
}

TEST(no_fault_while_disabled)
{
    begin((epg_motion_guard_config_t){
        .stall = stall.stall, .runaway = {.duty = 0.1, .angle = 1.0}, .homing = {.travel = 1.0, .cycles = 10}});
    for (int i = 0; i < 10000; i++) { /* moved by hand, at any duty */
        angle -= 0.01;
        CHECK(epg_motion_guard_check(&guard, &config, false, angle, resets, 1.0) == EPG_FAULT_NONE);
    }
    CHECK(step(0.0, 0.0) == EPG_FAULT_NONE); /* enabled at the present position */
}

TEST(enabling_begins_anew)
{
    begin(stall);
    CHECK_EQUAL(fault_after(99, 0.5, 0.0, STALL), 0);
    epg_motion_guard_check(&guard, &config, false, angle, resets, 0.5);
    CHECK_EQUAL(fault_after(1000, 0.5, 0.0, STALL), 100);
}

TEST(a_reset_is_no_motion_and_begins_anew)
{
    begin((epg_motion_guard_config_t){.stall = stall.stall, .runaway = {.duty = 0.1, .angle = 1.0}});
    CHECK_EQUAL(fault_after(60, 0.5, 0.0, STALL), 0);
    angle -= 50.0;
    resets++;
    CHECK_EQUAL(fault_after(1000, 0.5, 0.0, STALL), 100);
}

/* Runaway ------------------------------------------------------------------------------------------------------- */

static const epg_motion_guard_config_t runaway = {.runaway = {.duty = 0.1, .angle = 1.0}};

TEST(runaway_at_constant_speed)
{
    begin(runaway);
    const int found = fault_after(10000, 0.5, -0.01, RUNAWAY);
    CHECK(found >= 100 && found <= 402); /* because of rounding, the second half may be the slower one a few times */
    begin(runaway);
    CHECK(fault_after(10000, -0.5, 0.01, RUNAWAY) > 0);
}

TEST(runaway_that_accelerates_is_found_at_the_angle)
{
    for (int direction = -1; direction <= 1; direction += 2) {
        begin(runaway);
        epg_fault_t found = EPG_FAULT_NONE;
        for (int i = 0; i < 1000 && found == EPG_FAULT_NONE; i++) {
            found = step(0.5 * direction, -1e-4 * i * direction);
        }
        CHECK(found == RUNAWAY);
        CHECK(fabs(angle) >= 1.0 && fabs(angle) < 1.02);
    }
}

TEST(runaway_after_it_has_turned_round)
{
    for (int fast = 0; fast < 2; fast++) { /* than the motion before, which ended beyond half of the angle */
        begin(runaway);
        CHECK_EQUAL(fault_after(120, 0.5, -0.005, RUNAWAY), 0);
        CHECK_EQUAL(fault_after(500, 0.5, 0.01, RUNAWAY), 0);
        const double best = angle;
        CHECK(fault_after(1000, 0.5, fast > 0 ? -0.02 : -0.0078125, RUNAWAY) > 0);
        CHECK(best - angle < 1.05);
    }
}

TEST(no_runaway_with_the_drive_or_below_its_duty)
{
    begin(runaway);
    CHECK_EQUAL(fault_after(10000, 0.5, 0.01, RUNAWAY), 0);
    CHECK_EQUAL(fault_after(10000, 0.0999, -0.01, RUNAWAY), 0);
    CHECK_EQUAL(fault_after(10000, 0.0, -0.01, RUNAWAY), 0);
}

/** Starts at `speed` (rad per cycle), reduces it by the factor `slower` in each cycle, until the axis stops. */
static epg_fault_t brake(double speed, double slower)
{
    epg_fault_t found = EPG_FAULT_NONE;
    for (int i = 0; i < 100000 && speed > 1e-6 && found == EPG_FAULT_NONE; i++) {
        found = step(-1.0, speed);
        speed = speed * slower - 1e-6;
    }
    return found;
}

TEST(braking_is_no_runaway_however_long_it_takes)
{
    const double speeds[] = {0.001, 0.01, 0.03, 0.1};
    for (int i = 0; i < 4; i++) {
        begin(runaway);
        CHECK(brake(speeds[i], 0.97) == EPG_FAULT_NONE);
        begin(runaway);
        CHECK(brake(speeds[i], 0.998) == EPG_FAULT_NONE);
        CHECK(i == 0 || angle > 2.0); /* twice the angle that a runaway axis may move */
    }
}

TEST(braking_seen_by_a_coarse_encoder_is_no_runaway)
{
    begin(runaway);
    double exact = 0.0, speed = 0.02;
    for (int i = 0; i < 10000 && speed > 1e-6; i++) {
        exact += speed;
        speed *= 0.99;
        angle = floor(exact / 0.05) * 0.05;
        CHECK(step(-1.0, 0.0) == EPG_FAULT_NONE);
    }
    CHECK(exact > 1.9);
}

TEST(swinging_about_a_point_is_no_runaway)
{
    begin(runaway);
    for (int i = 0; i < 20000; i++) { /* half of the time against the drive, by 0.9 rad at most */
        const double phase = 0.01 * i;
        const double next = 0.45 * sin(phase);
        CHECK(step(-sin(phase + 0.8), next - angle) == EPG_FAULT_NONE);
    }
}

TEST(motion_with_the_drive_is_where_the_angle_counts_from)
{
    begin(runaway);
    CHECK_EQUAL(fault_after(500, 0.5, 0.01, RUNAWAY), 0); /* 5 rad forwards */
    int steps = 0;
    double speed = 0.0;
    while (step(0.5, -speed) == EPG_FAULT_NONE) {
        speed += 1e-3;
        steps++;
    }
    CHECK(angle > 3.9 && steps < 100); /* detected 1 rad back from there */
}

/* Homing -------------------------------------------------------------------------------------------------------- */

static const epg_motion_guard_config_t homing = {.stall = {.duty = 0.3, .angle = 0.1, .cycles = 100},
                                                 .homing = {.travel = 3.0, .cycles = 1000}};

TEST(homing_beyond_its_travel)
{
    begin(homing);
    CHECK_EQUAL(fault_after(1000, 0.2, 0.015625, HOMING_TRAVEL), 194); /* 3.015625 from the first step */
    begin(homing);
    CHECK_EQUAL(fault_after(1000, 0.2, -0.015625, HOMING_TRAVEL), 194);
}

TEST(homing_beyond_its_time)
{
    begin(homing);
    CHECK_EQUAL(fault_after(5000, 0.2, 0.001, HOMING_TIME), 1001);
}

TEST(homing_that_waits_takes_no_time)
{
    begin(homing);
    CHECK_EQUAL(fault_after(50000, 0.0, 0.0, HOMING_TIME), 0);
    CHECK_EQUAL(fault_after(5000, -0.2, 0.001, HOMING_TIME), 1001);
}

TEST(standing_at_the_end_stop_is_no_stall_while_homing)
{
    begin(homing);
    CHECK_EQUAL(fault_after(900, 1.0, 0.0, STALL), 0);
    resets++; /* homed */
    CHECK_EQUAL(fault_after(1000, 1.0, 0.0, STALL), 100);
}

TEST(runaway_while_homing)
{
    begin((epg_motion_guard_config_t){.runaway = runaway.runaway, .homing = {.travel = 100.0, .cycles = 100000}});
    CHECK(fault_after(10000, 0.5, -0.01, RUNAWAY) > 0);
}

TEST(after_the_reset_there_is_no_limit)
{
    begin(homing);
    CHECK_EQUAL(fault_after(200, 0.2, 0.01, HOMING_TRAVEL), 0);
    resets++;
    CHECK_EQUAL(fault_after(100000, 0.2, 0.01, HOMING_TRAVEL), 0);
}

TEST(enabling_again_homes_again)
{
    begin(homing);
    step(0.0, 0.0);
    resets++;
    step(0.0, 0.0);
    epg_motion_guard_check(&guard, &config, false, angle, resets, 0.0);
    CHECK_EQUAL(fault_after(1000, 0.2, 0.015625, HOMING_TRAVEL), 194);
}

TEST(resets_before_the_enabling_do_not_end_homing)
{
    begin(homing);
    resets = 5;
    CHECK_EQUAL(fault_after(1000, 0.2, 0.015625, HOMING_TRAVEL), 194);
}

TEST(homing_again_has_all_of_its_time)
{
    begin(homing);
    CHECK_EQUAL(fault_after(900, 0.2, 0.001, HOMING_TIME), 0);
    epg_motion_guard_check(&guard, &config, false, angle, resets, 0.0);
    CHECK_EQUAL(fault_after(5000, 0.2, 0.001, HOMING_TIME), 1001);
}

TEST(without_checks_there_is_no_fault)
{
    begin((epg_motion_guard_config_t){0});
    CHECK_EQUAL(fault_after(100000, 1.0, 0.0, STALL), 0);
    CHECK_EQUAL(fault_after(100000, 1.0, -0.1, RUNAWAY), 0);
}

RUN()
