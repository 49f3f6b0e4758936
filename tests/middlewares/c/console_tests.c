/**
 * @file
 * The console's protocol, line by line.
 */
#include <math.h>

#include "check.h"
#include "console_bench.h"
#include "fake_application.h"
#include "fake_port.h"

/** Checks that `command` has exactly the answer `expected`. */
static void check_answer(const char *command, const char *expected)
{
    const char *answer = bench_say(command);
    if (strcmp(answer, expected) != 0) {
        fprintf(stderr, "%s is answered with\n%s", command, answer);
        exit(1);
    }
}

TEST(it_greets)
{
    bench_start(true);
    CHECK(strcmp(bench.out, "ready node=bench_node epg=1.2.3 hash=0123456789abcdef\r\n") == 0);
    check_answer("version\n", "ok version name=fake node=bench_node epg=1.2.3 hash=0123456789abcdef "
                              "model=fedcba9876543210 period=0.001 stored=nothing\r\n");
}

TEST(setpoints_of_one_line_act_in_one_cycle)
{
    bench_start(true);
    check_answer("a/set=0.5 set_b=-2e-3\n", "ok setpoint\r\n");
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 0.5);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 1), -0.002);
    check_answer("/set_b=7\r\n", "ok setpoint\r\n");
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 1), 7.0);
}

TEST(setpoints_of_one_line_act_all_or_not_at_all)
{
    bench_start(true);
    check_answer("a/set=1 b=2\n", "error setpoint there is no setpoint 'b'\r\n");
    check_answer("a/set=1 set_b=nan\n", "error setpoint this is not a number: 'nan'\r\n");
    check_answer("a/set=1 set_b=1e999\n", "error setpoint this is not a number: '1e999'\r\n");
    check_answer("a/set=1 set_b\n", "error setpoint this is not a number: ''\r\n");
    check_answer("a/set=\n", "error setpoint this is not a number: ''\r\n");
    check_answer("=\n", "error setpoint there is no setpoint ''\r\n");
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 0.0);
}

TEST(setpoints_outside_of_their_limits_are_refused_with_the_limits)
{
    bench_start(true);
    fake.setpoints[0] = (epg_setpoint_t){.minimum = -1.2, .maximum = 1.2, .unit = "rad", .guard = EPG_NO_COMPONENT};
    fake.setpoints[1] = (epg_setpoint_t){.minimum = 0.0, .maximum = 5.0, .guard = EPG_NO_COMPONENT};
    check_answer("set_b=2 a/set=1.25\n", "error setpoint a/set must be from -1.2 to 1.2 rad\r\n");
    check_answer("a/set=-1e9\n", "error setpoint a/set must be from -1.2 to 1.2 rad\r\n");
    check_answer("a/set=1 set_b=5.5\n", "error setpoint set_b must be from 0 to 5\r\n");
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 0.0);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 1), 0.0);
    check_answer("a/set=-1.2 set_b=5\n", "ok setpoint\r\n");
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), -1.2);
}

TEST(ports_tell_limits_and_where_an_enabling_begins)
{
    bench_start(false);
    fake.setpoints[0] = (epg_setpoint_t){.minimum = -1.2, .maximum = 1.2, .unit = "rad", .guard = EPG_NO_COMPONENT};
    fake.setpoints[1] = (epg_setpoint_t){.initial = 0.25, .fresh = true, .unit = "rad/s"};
    bench_say("a/set=1 set_b=0.5\n");
    const char *ports = bench_say("ports\n");
    CHECK(has_line(ports, "port setpoint a/set unit=rad min=-1.2 max=1.2 starts=1\r\n"));
    CHECK(has_line(ports, "port setpoint /set_b unit=rad/s starts=0.25 fresh=1\r\n"));
    fake.setpoints[1].follows = "inputs.position";
    CHECK(has_line(bench_say("ports\n"), "port setpoint /set_b unit=rad/s follows=inputs.position fresh=1\r\n"));
    fake.setpoints[0].timeout_ns = 10000000; /* the value is older when it is asked for */
    fake.setpoints[0].action = EPG_TIMEOUT_DISABLE;
    bench_run(50);
    CHECK(has_line(bench_say("ports\n"), "port setpoint a/set unit=rad min=-1.2 max=1.2 starts=0\r\n"));
}

TEST(a_stall_names_the_setpoint_at_its_limit)
{
    static const epg_kind_fault_t stall = {.fault = (epg_fault_t)256, .name = "stall"};
    bench_start(true);
    bench.target.faults = &stall;
    bench.target.fault_count = 1;
    fake.setpoints[0] = (epg_setpoint_t){.minimum = -1.2, .maximum = 1.2, .guard = 0};
    fake.setpoints[1] = (epg_setpoint_t){.minimum = -1.2, .maximum = 1.2, .guard = FAKE_COMPONENT};
    bench_say("a/set=1.2 set_b=1\n");
    fake.fault = stall.fault;
    CHECK(strstr(bench_say(""), "setpoint=") == NULL); /* the axis of the fault has another setpoint */
    fake.fault = EPG_FAULT_NONE;
    bench_say("enable\nset_b=-1.2\n");
    fake.fault = stall.fault;
    const char *told = bench_say("");
    CHECK(strstr(told, "state enabled=0 fault=stall") != NULL);
    CHECK(strstr(told, " setpoint=/set_b") != NULL);
    fake.fault = EPG_FAULT_NONE;
    bench_say("enable\n");
    fake.fault = EPG_FAULT_OUTPUT;
    CHECK(strstr(bench_say(""), "setpoint=") == NULL); /* another fault */
}

TEST(enabling_is_answered_with_what_came_of_it)
{
    bench_start(false);
    check_answer("enable\n", "state enabled=1 fault=none\r\nok enable\r\n");
    CHECK(fake_status().enabled);
    check_answer("disable and be quick\n", "state enabled=0 fault=none by=line\r\nok disable\r\n");
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(fake.actuator, 0.0);
}

static bool fail_safe(void)
{
    return fake.fail_safe;
}

TEST(enabling_that_is_refused_says_why)
{
    bench_start(false);
    fake.application.fail_safe = fail_safe;
    fake.application.fail_safe_component = 1;
    fake.fail_safe = false;
    check_answer("enable\n", "state enabled=0 fault=fail-safe component=motor by=fault\r\n"
                             "error enable refused: stopped by fault fault=fail-safe component=motor\r\n");
}

TEST(faults_are_told_unasked)
{
    bench_start(true);
    fake.output_error = NAN;
    check_answer("", "state enabled=0 fault=not_finite by=fault\r\n");
}

TEST(a_loop_that_does_not_run_is_no_reason_to_hang)
{
    bench_start(true);
    bench.frozen = true;
    bench_say("disable\n");
    bench_run(1100);
    CHECK(has_line(bench.out, "error disable the control loop does not run"));
    bench_say("set p2=1\n");
    bench_run(1100);
    CHECK(has_line(bench.out, "error set the control loop does not run"));
    bench.frozen = false;
    const char *answer = bench_say("set p2=2\n"); /* the first value is applied before the second one arrives */
    bench_run(5);
    CHECK(has_line(answer, "ok set"));
    CHECK_EQUAL(bench.model[2], 2.0);
}

TEST(parameters_are_read_and_changed_by_name)
{
    bench_start(true);
    check_answer("get PID\\kp PID\\tauD\n", "parameter PID\\kp=2.6\r\nparameter PID\\tauD=0.05 unit=s\r\nok get\r\n");
    check_answer("set PID\\kp=0.1 PID\\tauD=1e-3\n", "ok set\r\n");
    CHECK_EQUAL(bench.model[0], 0.1);
    CHECK_EQUAL(bench.model[1], 0.001);
    check_answer("get PID\\tauD\n", "parameter PID\\tauD=0.001 unit=s generated=0.05\r\nok get\r\n");
    const char *all = bench_say("get\n");
    CHECK(has_line(all, "parameter pb=0 min=0 max=1\r\n"));
    CHECK(has_line(all, "ok get"));
}

TEST(parameters_change_all_or_not_at_all)
{
    bench_start(true);
    check_answer("set PID\\kp=0.1 PID\\tau=1\n", "error set there is no parameter 'PID\\tau'\r\n");
    check_answer("set PID\\kp=0.1 p2=inf\n", "error set this is not a number: 'inf'\r\n");
    check_answer("set PID\\kp=0.1 pb=1.5\n", "error set this number is more than the maximum 1: '1.5'\r\n");
    check_answer("set pb=-0.5\n", "error set this number is less than the minimum 0: '-0.5'\r\n");
    check_answer("set PID\\kp\n", "error set this is not a number: ''\r\n");
    check_answer("set\n", "error set use <parameter>=<number>, 1 to 8 times\r\n");
    check_answer("set p2=1 p3=1 p4=1 p5=1 p6=1 p7=1 p8=1 p9=1 pa=1\n",
                 "error set use <parameter>=<number>, 1 to 8 times\r\n");
    check_answer("get nothing\n", "error get there is no parameter 'nothing'\r\n");
    CHECK_EQUAL(epg_parameters_value(&bench.parameters, 0), 2.6);
    check_answer("set p2=1 p3=2 p4=3 p5=4 p6=5 p7=6 p8=7 p9=8\n", "ok set\r\n");
    CHECK_EQUAL(bench.model[9], 8.0);
}

TEST(parameters_are_saved_only_while_outputs_are_safe)
{
    bench_start(true);
    bench_say("set PID\\kp=0.1\n");
    check_answer("save\n", "error save the actuators must be off: disable first\r\n");
    CHECK(fake_port.store_size == 0);
    bench_say("disable\njog motor 0.1 200\n");
    check_answer("save\n", "error save the actuators must be off: disable first\r\n");
    bench_run(300);
    check_answer("save\n", "ok save values=1\r\n");
    CHECK(fake_port.store_size > 0);
    fake_port.store_refuses = true;
    check_answer("save\n", "error save the fake memory is worn out\r\n");
}

TEST(names_are_read_and_set_and_kept)
{
    bench_start(false);
    check_answer("get node\n", "ok get node=bench_node name=bench_node\r\n");
    check_answer("get namespace\n", "ok get namespace=/ name=/\r\n");
    check_answer("set node=robot_$serial\n", "ok set acts=at_next_start_if_saved\r\n");
    check_answer("set namespace=/fleet\n", "ok set acts=at_next_start_if_saved\r\n");
    check_answer("get node\n", "ok get node=robot_$serial name=robot_E6616407E3A51B2C\r\n");
    check_answer("set node=1st\n", "error set this is not a name of a node: '1st'\r\n");
    check_answer("set node=\n", "error set this is not a name of a node: ''\r\n");
    check_answer("set namespace=fleet\n", "error set this is not a namespace: 'fleet'\r\n");
    check_answer("set node=a PID\\kp=1\n", "error set there is no parameter 'node'\r\n");
    check_answer("get namespace\n", "ok get namespace=/fleet name=/fleet\r\n");
    check_answer("save\n", "ok save values=0\r\n");
    epg_store_load(&bench.store); /* the next start */
    check_answer("get node\n", "ok get node=robot_$serial name=robot_E6616407E3A51B2C\r\n");
    check_answer("set node=bench_node\n", "ok set acts=at_next_start_if_saved\r\n");
    CHECK(bench.store.node[0] == '\0'); /* empty: the generated name applies */
}

TEST(names_cannot_be_set_without_a_store)
{
    bench_start(false);
    bench.target.store = NULL;
    check_answer("get node\n", "ok get node=bench_node name=bench_node\r\n");
    check_answer("set node=other\n", "error set this target cannot store names\r\n");
    check_answer("save\n", "error save there is nothing to save\r\n");
}

static const epg_topic_t values_and_others[3] = {
    {.name = "~/enable", .role = EPG_TOPIC_ENABLE, .count = 1},
    {.name = "joints", .values = (const char *const[]){"joints/pan.position", "joints/tilt.position"}, .count = 2},
    {.name = "/ping", .role = EPG_TOPIC_ECHO},
};

TEST(values_of_a_topic_have_names_of_their_own)
{
    bench_start(true);
    bench.target.subscriptions = values_and_others;
    bench.target.subscription_count = 3;
    bench.target.publications = values_and_others;
    bench.target.publication_count = 3;
    const char *ports = bench_say("ports\n");
    CHECK(strstr(ports, "port setpoint joints/pan.position starts=0\r\nport setpoint joints/tilt.position starts=0\r\n"
                        "port publication joints/pan.position\r\nport publication joints/tilt.position\r\n") != NULL);
    CHECK(strstr(ports, "enable") == NULL && strstr(ports, "ping") == NULL);
    check_answer("joints/tilt.position=2 joints/pan.position=1\n", "ok setpoint\r\n");
    bench_run(2);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 1.0);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 1), 2.0);
    check_answer("~/enable=0\n", "error setpoint there is no setpoint '~/enable'\r\n");
    check_answer("joints=0\n", "error setpoint there is no setpoint 'joints'\r\n");
    bench.out_length = 0;
    bench_say("watch\n");
    bench_run(20);
    CHECK(strstr(bench.out, " joints/pan.position=") != NULL && strstr(bench.out, " joints/tilt.position=") != NULL);
    CHECK(strstr(bench.out, "enable=") == NULL);
}

TEST(watch_shows_values_of_one_cycle_at_the_communication_period)
{
    bench_start(true);
    bench.out_length = 0;
    bench_say("watch angle outputs.duty position\n");
    bench_run(90);
    CHECK(strncmp(bench.out, "ok watch\r\n", 10) == 0);
    int lines = 0;
    double before = 0.0;
    for (const char *line = strstr(bench.out, "watch "); line != NULL; line = strstr(line + 1, "\r\nwatch ")) {
        double time = 0.0;
        double angle = 0.0;
        double duty = 0.0;
        double input = 0.0;
        line += *line == '\r' ? 2 : 0;
        if (strncmp(line, "watch 0", 7) != 0) {
            continue;
        }
        CHECK(sscanf(line, "watch %lf /angle=%lf outputs.duty=%lf inputs.position=%lf", &time, &angle, &duty, &input) ==
              4);
        CHECK_EQUAL(angle, duty);
        /* The model's state is the number of steps; the first step was at time 0. */
        CHECK(fabs(duty - (time * 1000.0 + 1.0)) < 1e-9);
        CHECK(lines == 0 || fabs(time - before - 0.010) < 1e-9);
        before = time;
        lines++;
    }
    CHECK(lines >= 9 && lines <= 11);
    const char *off = bench_say("watch off\n");
    CHECK(has_line(off, "ok watch"));
    check_answer("", "");
}

TEST(watch_without_ports_shows_what_is_published)
{
    bench_start(true);
    const char *answer = bench_say("watch\n");
    CHECK(strstr(answer, " /angle=") != NULL);
    CHECK(strstr(answer, "duty") == NULL);
    CHECK(has_line(bench_say("watch nothing\n"), "error watch there is no port 'nothing'"));
    CHECK(has_line(bench_say("watch same\n"), "error watch there is no port 'same'")); /* ambiguous: input or output */
    CHECK(has_line(bench_say("watch inputs.same\n"), "ok watch"));
}

TEST(watch_is_silent_while_the_model_rests)
{
    bench_start(true);
    bench_say("watch\n");
    fake.output_error = NAN;
    bench_run(20);
    check_answer("", "");
}

TEST(a_capture_is_told_and_read)
{
    bench_start(true);
    check_answer("capture\n", "ok capture state=ready rows=0\r\n");
    check_answer("capture position outputs.duty rows=4 every=2\n",
                 "ok capture rows=4\r\ncaptured state=ready rows=4 trigger=0\r\n");
    const char *rows = bench_say("capture read\n");
    CHECK(has_line(rows, "csv time,inputs.position,outputs.duty\r\n"));
    double time[4];
    double duty[4];
    double input;
    const char *line = strchr(rows, '\n') + 1;
    for (int i = 0; i < 4; i++) {
        CHECK(sscanf(line, "csv %lf,%lf,%lf", &time[i], &input, &duty[i]) == 3);
        line = strchr(line, '\n') + 1;
    }
    CHECK(fabs(time[3] - time[0] - 0.006) < 1e-9);
    CHECK_EQUAL(duty[3], duty[0] + 6.0);
    CHECK(strcmp(line, "ok capture\r\n") == 0);
}

TEST(a_capture_waits_for_its_trigger)
{
    bench_start(true);
    check_answer("capture duty rows=10 before=3 when=position>2.5\n", "ok capture rows=10\r\n");
    const char *answer = bench_say("capture\n");
    CHECK(has_line(answer, "ok capture state=recording rows=10"));
    check_answer("capture read\n", "error capture a recording runs: 'capture stop' ends it\r\n");
    check_answer("capture duty\n", "error capture a recording runs: 'capture stop' ends it\r\n");
    bench_say("a/set=3\n");
    bench_run(20);
    CHECK(has_line(bench.out, "captured state=ready rows=10 trigger=3"));
    check_answer("capture duty when=position<0 rows=5\n", "ok capture rows=5\r\n");
    check_answer("capture stop\n", "ok capture\r\ncaptured state=ready rows=5\r\n");
    check_answer("capture duty when=fault\n", "ok capture rows=150\r\n");
    fake.output_error = NAN;
    bench_run(200);
    CHECK(has_line(bench.out, "captured state=ready rows=150 trigger=0"));
}

TEST(a_capture_that_makes_no_sense_is_refused)
{
    bench_start(true);
    check_answer("capture duty rows=151\n", "error capture there is only room for rows=150\r\n");
    check_answer("capture duty rows=0\n", "error capture use rows=<n>, before=<n> or every=<n>, not 'rows'\r\n");
    check_answer("capture duty every=0\n", "error capture use rows=<n>, before=<n> or every=<n>, not 'every'\r\n");
    check_answer("capture duty rows=99999999999\n",
                 "error capture use rows=<n>, before=<n> or every=<n>, not 'rows'\r\n");
    check_answer("capture duty rows=5 before=5\n", "error capture before= must be less than rows=\r\n");
    check_answer("capture rows=5\n", "error capture name the ports to record\r\n");
    check_answer("capture nothing\n", "error capture there is no port 'nothing'\r\n");
    check_answer("capture duty when=nothing>1\n", "error capture there is no port 'nothing'\r\n");
    check_answer("capture duty when=duty>x\n", "error capture this is not a number: 'x'\r\n");
    check_answer("capture duty when=duty\n",
                 "error capture use when=<port>><number>, when=<port><<number> or when=fault\r\n");
    check_answer("capture duty duty duty duty duty duty duty duty duty\n",
                 "error capture a recording has at most 8 ports\r\n");
    check_answer("capture duty sort=1\n", "error capture use rows=<n>, before=<n> or every=<n>, not 'sort'\r\n");
}

TEST(jog_tells_what_the_encoders_counted)
{
    bench_start(false);
    bench_say("jog motor -0.2 50\n");
    bench_run(60);
    CHECK(has_line(bench.out, "moved encoder count=-1000 position=+250 unit=rad\r\n"));
    CHECK(has_line(bench.out, "ok jog\r\n"));
    CHECK_EQUAL(fake.actuator, 0.0);
    bench.out_length = 0;
    bench_say("jog motor 0 1\n");
    CHECK(has_line(bench.out, "moved encoder count=0 position=0 unit=rad\r\n"));
}

TEST(jog_refuses_what_is_not_safe)
{
    bench_start(true);
    check_answer("jog motor 0.1 50\n", "error jog the target is enabled: disable it\r\n");
    bench_say("disable\n");
    check_answer("jog motor 0.2501 50\n", "error jog the duty must be at most 0.25 for this target\r\n");
    check_answer("jog motor -0.2501 50\n", "error jog the duty must be at most 0.25 for this target\r\n");
    check_answer("jog motor 0.1 2001\n", "error jog the time must be from 1 to 2000 ms for this target\r\n");
    check_answer("jog motor 0.1 0\n", "error jog the time must be from 1 to 2000 ms for this target\r\n");
    check_answer("jog motor 0.1 1.5\n", "error jog the time must be from 1 to 2000 ms for this target\r\n");
    check_answer("jog motor nan 50\n", "error jog this is not a number: 'nan'\r\n");
    check_answer("jog motors 0.1 50\n", "error jog there is no actuator 'motors'\r\n");
    check_answer("jog motor 0.1\n", "error jog use jog <actuator> <duty> <ms>\r\n");
    CHECK_EQUAL(bench.count, 0);
    bench_say("jog motor 0.1 100\n");
    check_answer("jog motor 0.1 100\n", "error jog an actuator is moving\r\n");
    check_answer("disable\n", "error jog stopped by a request or a fault\r\nok disable\r\n");
    const int64_t count = bench.count;
    bench_run(100);
    CHECK(count == bench.count);
}

TEST(who_goes_away_leaves_nothing_moving)
{
    bench_start(false);
    bench_say("watch\necho on\njog motor 0.1 2000\nver");
    CHECK(fake.actuator > 0.0);
    bench.connected = false;
    bench_run(2);
    CHECK_EQUAL(fake.actuator, 0.0);
    bench.out_length = 0;
    bench.connected = true;
    bench_run(50);
    CHECK(!fake_status().enabled);
    CHECK(strcmp(bench.out, "ready node=bench_node epg=1.2.3 hash=0123456789abcdef by=start\r\n") == 0);
    CHECK_EQUAL(fake_status().statistics.reconnects, 1);
    CHECK(has_line(bench_say("\x03version\n"), "ok version"));
}

TEST(commands_act_if_nobody_reads_the_output)
{
    bench_start(false);
    bench.connected = false;
    bench.out_length = 0;
    bench_say("help\nports\ncapture duty rows=100\nwatch\nenable\nset_b=0.5\n");
    CHECK(fake_status().enabled);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 1), 0.5);
    bench_say("set PID\\kp=3\nset PID\\tauD=4\ndisable\n");
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(bench.model[0], 3.0);
    CHECK_EQUAL(bench.model[1], 4.0);
    bench_run(3000);
    CHECK_EQUAL(bench.out_length, 0);
    bench.connected = true;
    bench_run(50);
    CHECK(strcmp(bench.out, "ready node=bench_node epg=1.2.3 hash=0123456789abcdef by=line\r\n") == 0);
    CHECK(has_line(bench_say("version\n"), "ok version"));
}

/** Sends `first`, then opens or closes the connection at the instant at which `second` arrives. */
static void send_around_a_change(bool opened, const char *first, const char *second)
{
    bench_start(true);
    bench.connected = !opened;
    bench_run(5);
    bench_say(first);
    bench.connected = opened;
    bench_say(second);
    bench_run(50);
}

TEST(a_change_of_the_connection_drops_no_stop)
{
    static const char line[] = "disable\n";
    for (int opened = 0; opened < 2; opened++) {
        for (size_t cut = 0; cut < sizeof line; cut++) {
            char first[sizeof line] = "";
            memcpy(first, line, cut);
            send_around_a_change(opened != 0, first, line + cut);
            CHECK(!fake_status().enabled);
        }
        send_around_a_change(opened != 0, "capture duty rows=100\nset_b=", line);
        CHECK(!fake_status().enabled);
        send_around_a_change(opened != 0, "\x80\x01", "\tdisable it\n");
        CHECK(!fake_status().enabled);
        send_around_a_change(opened != 0, "", "version\nports\nversion\nhelp\ndisable\n");
        CHECK(!fake_status().enabled);
        send_around_a_change(opened != 0, "version\nset_b=0.2", "5\n");
        CHECK(fake_status().enabled);
        CHECK_EQUAL(epg_control_setpoint(&fake.control, 1), 0.25);
    }
}

TEST(a_stop_behind_an_answer_that_nobody_reads_acts_at_once)
{
    bench_start(true);
    bench.room = 0; /* the terminal is open, and stands still */
    bench.in = "help\nports\nversion\ndisable\n";
    bench.in_length = strlen(bench.in);
    bench_run(2);
    CHECK(!fake_status().enabled);
}

static void send_alone(const char *line)
{
    bench.in = line;
    bench.in_length = strlen(line);
    bench_run(1);
    CHECK(bench.in_length == 0);
}

TEST(a_line_that_waits_for_an_answer_does_not_act_after_a_stop)
{
    static const char *const lines[] = {"enable\n", "a/set=4\n"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        bench_start(false);
        bench.frozen = true;
        send_alone("set p2=1\n"); /* no cycle runs, so its answer does not come, */
        send_alone(lines[i]);     /* and the next line waits for it */
        send_alone("disable\n");
        bench.frozen = false;
        bench_run(50);
        CHECK(!fake_status().enabled);
        CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 0.0);
        CHECK(strstr(bench.out, "refused: stopped by ") != NULL);
        bench_say("enable\n");
        CHECK(fake_status().enabled);
    }
}

TEST(lines_that_are_none)
{
    char line[2000];
    bench_start(true);
    memset(line, 'x', sizeof line);
    line[300] = '\n';
    CHECK(strcmp(bench_send(line, 301), "error line is too long\r\n") == 0);
    check_answer("version\x80\n", "error line contains bytes that are not text\r\n");
    check_answer("\x01\x02", "");
    check_answer("\n", "error line contains bytes that are not text\r\n");
    check_answer("\r\n\r\n \t \n", "");
    check_answer("1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25\n",
                 "error line has too many words\r\n");
    check_answer("versions\n", "error line there is no command 'versions'\r\n");
    memset(line, ' ', 256);
    memcpy(line + 249, "version\n", 8);
    CHECK(has_line(bench_send(line, 257), "ok version"));
}

TEST(typing_is_shown_and_corrected)
{
    bench_start(true);
    check_answer("echo on\r\n", "ok echo\r\n");
    check_answer(
        "verx\bsion\r\n",
        "verx\b \bsion\r\n"
        "ok version name=fake node=bench_node epg=1.2.3 hash=0123456789abcdef model=fedcba9876543210 period=0.001 "
        "stored=nothing\r\n");
    check_answer("echo off\n", "echo off\r\nok echo\r\n");
    check_answer("verxx\x7f\x7fsionx\b\n", "ok version name=fake node=bench_node epg=1.2.3 hash=0123456789abcdef "
                                           "model=fedcba9876543210 period=0.001 stored=nothing\r\n");
    check_answer("garbage\x03version\n", "ok version name=fake node=bench_node epg=1.2.3 hash=0123456789abcdef "
                                         "model=fedcba9876543210 period=0.001 stored=nothing\r\n");
    check_answer("echo\n", "error echo must be 'on' or 'off'\r\n");
}

TEST(answers_of_several_lines_come_whole_through_a_narrow_stream)
{
    bench_start(true);
    bench_say("capture position duty same outputs.same rows=5\n");
    bench_say("capture inputs.same duty rows=100\n");
    bench_run(120);
    const char *begin = bench.out + bench.out_length;
    bench.in = "capture read\nversion\n";
    bench.in_length = strlen(bench.in);
    for (int i = 0; i < 4000; i++) {
        bench.room = 3;
        bench_poll();
    }
    int rows = 0;
    for (const char *line = strstr(begin, "csv "); line != NULL; line = strstr(line + 1, "csv ")) {
        rows++;
    }
    CHECK_EQUAL(rows, 101);
    const char *end = strstr(begin, "ok capture\r\n");
    CHECK(end != NULL);
    CHECK(has_line(end, "ok version")); /* in its order */
}

TEST(what_must_act_at_once_does_not_wait_for_an_answer)
{
    bench_start(true);
    bench_say("capture duty rows=150\n");
    bench_run(160);
    bench.in = "capture read\ndisable\n";
    bench.in_length = strlen(bench.in);
    for (int i = 0; i < 100; i++) {
        bench.room = 3;
        bench_poll();
    }
    CHECK(!fake_status().enabled);
    CHECK(strstr(bench.out, "ok capture\r\n") == NULL || !has_line(bench.out, "ok capture\r\n"));
}

TEST(commands_act_though_nobody_reads)
{
    bench_start(true);
    bench_say("watch\n");
    bench.room = 0;
    bench_run(3000);
    bench.in = "help\nports\nget\na/set=4\ndisable\n";
    bench.in_length = strlen(bench.in);
    bench_run(5000);
    CHECK(!fake_status().enabled);
    CHECK_EQUAL(epg_control_setpoint(&fake.control, 0), 0.0); /* the stop has overtaken it */
    bench.room = SIZE_MAX;
    bench_say("watch off\n");
    bench_run(50);
    bench.out_length = 0;
    const char *stats = bench_say("stats\n");
    const char *dropped = strstr(stats, "stat lines_dropped=");
    CHECK(dropped != NULL);
    CHECK(atoi(dropped + 19) > 10);
    /* The output is whole lines. */
    CHECK(strncmp(stats, "stat enabled=0 ", 15) == 0);
}

TEST(stats_are_those_of_the_loop)
{
    bench_start(true);
    const char *stats = bench_say("stats\n");
    CHECK(has_line(stats, "stat enabled=1 fault=none time=0.0"));
    CHECK(has_line(stats, "stat cycles="));
    CHECK(has_line(stats, "stat computation_mean_ns=0\r\n"));
    CHECK(has_line(stats, "ok stats\r\n"));
}

TEST(stats_of_a_node_are_shown_too)
{
    static epg_node_t node;
    bench_start(true);
    CHECK(strstr(bench_say("stats\n"), "unsent") == NULL);
    node = (epg_node_t){.unsent = 3, .malformed = 4000000000U};
    bench.target.node_state = &node;
    const char *stats = bench_say("stats\n");
    bench_run(20);
    CHECK(has_line(stats, "stat unsent=3\r\n"));
    CHECK(has_line(stats, "stat malformed=4000000000\r\n"));
    CHECK(has_line(stats, "ok stats\r\n"));
}

TEST(ports_and_help_name_everything)
{
    bench_start(true);
    check_answer("ports\n",
                 "port setpoint a/set starts=0\r\nport setpoint /set_b starts=0\r\nport publication /angle\r\n"
                 "port signal inputs.position unit=rad\r\nport signal inputs.same\r\n"
                 "port signal outputs.same\r\nport signal outputs.duty\r\nport actuator motor\r\n"
                 "port encoder encoder unit=rad\r\nok ports\r\n");
    const char *help = bench_say("help\n");
    CHECK(has_line(help, "help jog <actuator> <duty> <ms>"));
    CHECK(has_line(help, "ok help"));
}

TEST(a_target_without_any_of_it)
{
    bench_start(true);
    fake.application.parameters = NULL;
    fake.application.capture = NULL;
    fake.application.jog = NULL;
    check_answer("get\n", "error get the model has no parameters\r\n");
    check_answer("set a=1\n", "error set the model has no parameters\r\n");
    bench.store.parameters = NULL;
    check_answer("save\n", "error save the actuators must be off: disable first\r\n");
    check_answer("capture duty\n", "error capture this target has no memory for recordings\r\n");
    check_answer("jog motor 0.1 5\n", "error jog this target has no jog\r\n");
    check_answer(
        "version\n",
        "ok version name=fake node=bench_node epg=1.2.3 hash=0123456789abcdef model=fedcba9876543210 period=0.001\r\n");
}

/** Bytes, words and parts of commands in any order, while the reader connects, disconnects and reads at random. */
TEST(any_bytes_at_all)
{
    static const char *const words[] = {
        "watch",   "capture", "read",    "stop",    "jog",     "motor", "0.1",   "50",      "set",  "get",    "save",
        "PID\\kp", "=",       "a/set=1", "when=",   "rows=",   "duty",  "stats", "ports",   "help", "enable", "disable",
        "\n",      "\r\n",    "fault",   "before=", "every=3", "<",     ">1",    "echo on", "\x03", "off"};
    srand(7);
    bench_start(true);
    for (int i = 0; i < 30000; i++) {
        char text[64];
        size_t length = 0;
        if (rand() % 3 > 0) {
            const char *word = words[(size_t)rand() % (sizeof words / sizeof words[0])];
            length = (size_t)snprintf(text, sizeof text, rand() % 4 > 0 ? " %s" : "%s", word);
        } else {
            length = (size_t)rand() % sizeof text;
            for (size_t k = 0; k < length; k++) {
                text[k] = (char)rand();
            }
        }
        bench.connected = rand() % 500 > 0;
        bench.room = rand() % 3 > 0 ? SIZE_MAX : (size_t)rand() % 50U;
        bench.in = text;
        bench.in_length = length;
        bench.out_length = 0;
        for (int poll = 0; poll < 5 && (poll == 0 || bench.in_length > 0); poll++) {
            bench_poll();
        }
    }
    bench.connected = true;
    bench.room = SIZE_MAX;
    bench_run(3000);
    bench.out_length = 0;
    bench_say("\x03");
    bench_run(3000);
    bench.out_length = 0;
    CHECK(has_line(bench_say("\x03version\n"), "ok version"));
}

RUN()
