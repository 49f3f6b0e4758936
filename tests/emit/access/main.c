/**
 * @file
 * A program that sets and gets values by name, while another thread delivers messages and a third one runs the cycles.
 *
 * With -DSHARED the middleware changes parameters, too.  Prints the observation that breaks a promise, and ends with 1.
 */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "epg/control.h"
#include "epg/port.h"
#include "epg/target.h"
#include "robot.h"

enum { CYCLES = 20000, MOST = 10000000, PERIOD_NS = 1000000 };

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            printf("%s:%d: not so: %s\n", __FILE__, __LINE__, #condition);                                             \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (0)

static atomic_bool ended;
static atomic_bool seen; /* the program has got values */
static uint64_t tick_ns; /* of the control side */

static void run_cycles(unsigned int count)
{
    for (unsigned int i = 0; i < count; i++) {
        epg_control_cycle(robot_target.control, tick_ns, 0);
        tick_ns += PERIOD_NS;
    }
}

static void *control_main(void *argument)
{
    run_cycles(CYCLES);
    /* A computer with other work may not have run the program's thread yet. */
    for (unsigned int i = 0; i < MOST && !atomic_load(&seen); i++) {
        run_cycles(1);
    }
    atomic_store(&ended, true);
    return argument;
}

static void *communication_main(void *argument)
{
    epg_control_t *control = robot_target.control;
    epg_status_t status;
    for (unsigned int i = 0; !atomic_load(&ended); i++) {
        double published[64];
        CHECK(robot_target.application->monitor_count <= 64);
        epg_control_alive(control);
        CHECK(epg_control_receive(control, 0, -(double)i, epg_port_time_ns(), true));
        (void)epg_control_monitor(control, published);
        (void)epg_control_observe(control, &status);
#ifdef SHARED
        epg_parameters_t *parameters = robot_target.application->parameters;
        const epg_parameter_change_t change = {.index = 1, .value = (double)(i % 50)};
        (void)epg_parameters_change(parameters, &change, 1);
        CHECK(epg_parameters_value(parameters, 0) >= 0.0);
#endif
    }
    return argument;
}

/** Sets and gets values until the last cycle. */
static void use_all(void)
{
    robot_values_t last = {0};
    bool any = false;
    for (unsigned int i = 0; !atomic_load(&ended); i++) {
        robot_values_t all;
        double value;
        CHECK(robot_set_x_input((double)i));
        CHECK(robot_set_speed((double)(i % 3)));
        CHECK(!robot_set_speed(NAN));
        CHECK(robot_set_gain((double)(i % 100)));
        CHECK(!robot_set_gain(100.5));
        if (robot_get_gain(&value)) {
            CHECK(value >= 0.0 && value <= 100.0);
        }
        if (!robot_get(&all)) {
            CHECK(!any);
            continue;
        }
        any = true;
        atomic_store(&seen, true);
        CHECK(all.outputs.x == all.inputs.x && all.inputs.again == all.inputs.x);
        CHECK(all.outputs.twice == 2.0 * all.inputs.x);
        CHECK((double)all.time_ns == (all.outputs.steps - 1.0) * PERIOD_NS);
        CHECK(all.time_ns >= last.time_ns);
        last = all;
        CHECK(robot_get_steps_output(&value) && value >= all.outputs.steps);
    }
    CHECK(any);
}

/** The same in one thread: each value arrives. */
static void use_one_by_one(void)
{
    double value;
    epg_status_t status;
    run_cycles(1); /* makes the last changes of the other threads */
    CHECK(robot_set_x_input(7.0));
    CHECK(robot_set_speed(0.5));
    CHECK(robot_set_gain(4.0));
    CHECK(robot_set_steps_parameter(0.25));
    run_cycles(1);
    CHECK(robot_get_x_input(&value) && value == 7.0);
    CHECK(robot_get_x_output(&value) && value == 7.0);
    CHECK(robot_get_again(&value) && value == 7.0);
    CHECK(robot_get_speed(&value) && value == 500.0); /* mm/s */
    CHECK(robot_get_product(&value) && value == 4.25);
    CHECK(robot_get_gain(&value) && value == 4.0);
    CHECK(robot_get_steps_parameter(&value) && value == 0.25);
    CHECK(!robot_set_speed(-3.0)); /* outside of its limits, which are in mm/s */
    run_cycles(1);
    CHECK(robot_get_speed(&value) && value == 500.0);
    CHECK(robot_set_speed(-2.0));
    run_cycles(1);
    CHECK(robot_get_speed(&value) && value == -2000.0);
    CHECK(robot_status(&status) && status.enabled);
}

static void run(void)
{
    double value = 0.0;
    pthread_t control;
    pthread_t communication;
    tick_ns = 0;
    atomic_store(&ended, false);
    atomic_store(&seen, false);
    epg_control_start(robot_target.control, robot_target.application);
    CHECK(!robot_get_x_output(&value)); /* nothing from before the start */
    CHECK(pthread_create(&control, NULL, control_main, NULL) == 0);
    CHECK(pthread_create(&communication, NULL, communication_main, NULL) == 0);
    use_all();
    CHECK(pthread_join(control, NULL) == 0 && pthread_join(communication, NULL) == 0);
    use_one_by_one();
}

int main(void)
{
    double value = 0.0;
    CHECK(!robot_set_x_input(1.0) && !robot_get_x_output(&value) && !robot_set_gain(1.0) && !robot_get_gain(&value));
    run();
    run();
    return 0;
}
