/**
 * @file
 * The steps of a simulated plant.
 */
#include "epg/plant.h"

#include "check.h"

enum { PERIOD_NS = 1000000 };

static int steps;

static void step(void)
{
    steps++;
}

static void nothing(void)
{
}

/** The steps of a plant with three steps in each period of 1 ms, up to `time_ns`. */
static int steps_until(uint64_t time_ns, bool starts_by_step)
{
    const epg_plant_t plant = {3, starts_by_step, nothing, nothing, step, nothing};
    epg_plant_run_t run;

    steps = 0;
    epg_plant_start(&run, &plant, PERIOD_NS);
    epg_plant_advance(&run, time_ns);
    return steps;
}

TEST(a_step_need_not_be_a_whole_number_of_nanoseconds)
{
    CHECK_EQUAL(steps_until(PERIOD_NS / 3, false), 0);
    CHECK_EQUAL(steps_until(PERIOD_NS / 3 + 1, false), 1);
    CHECK_EQUAL(steps_until(1000ULL * PERIOD_NS, false), 3000);
}

TEST(a_step_at_time_0_is_the_first_of_all_steps)
{
    CHECK_EQUAL(steps_until(0, false), 0);
    CHECK_EQUAL(steps_until(0, true), 1);
    CHECK_EQUAL(steps_until(1000ULL * PERIOD_NS, true), 3000);
}

RUN()
