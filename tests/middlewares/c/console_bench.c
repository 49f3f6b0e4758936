/**
 * @file
 * A console on a test bench.
 */
#include "console_bench.h"

#include <math.h>

#include "check.h"
#include "fake_application.h"
#include "fake_port.h"

bench_t bench;

/* Stream --------------------------------------------------------------------------------------------------------- */

static bool connected(void *context)
{
    (void)context;
    return bench.connected;
}

static size_t read_bytes(void *context, void *data, size_t size)
{
    (void)context;
    const size_t count = size < bench.in_length ? size : bench.in_length;
    if (count > 0) {
        memcpy(data, bench.in, count);
        bench.in += count;
        bench.in_length -= count;
    }
    return count;
}

static size_t write_bytes(void *context, const void *data, size_t size)
{
    (void)context;
    const size_t count = size < bench.room ? size : bench.room;
    CHECK(bench.out_length + count < sizeof bench.out);
    memcpy(bench.out + bench.out_length, data, count);
    bench.out_length += count;
    bench.out[bench.out_length] = '\0';
    bench.room -= count;
    return count;
}

static size_t writable(void *context)
{
    (void)context;
    return bench.room;
}

static const epg_stream_t stream = {
    .connected = connected, .read = read_bytes, .write = write_bytes, .writable = writable};

/* Target --------------------------------------------------------------------------------------------------------- */

static const epg_parameter_t table[BENCH_PARAMETERS] = {
    {"PID\\kp", "", 2.6}, {"PID\\tauD", "s", 0.05}, {"p2", "", 0.0}, {"p3", "", 0.0}, {"p4", "", 0.0}, {"p5", "", 0.0},
    {"p6", "", 0.0},      {"p7", "", 0.0},          {"p8", "", 0.0}, {"p9", "", 0.0}, {"pa", "", 0.0}, {"pb", "", 0.0}};
static double values[BENCH_PARAMETERS];
static double applied[BENCH_PARAMETERS];
static bool wanted[BENCH_PARAMETERS];
static epg_parameter_limits_t limits[BENCH_PARAMETERS];
static bool changed[BENCH_PARAMETERS];
static uint32_t acted[BENCH_PARAMETERS];
static unsigned char store_bytes[EPG_STORE_SIZE(BENCH_PARAMETERS)];

static void set(const double *new_values, const bool *which)
{
    for (size_t i = 0; i < BENCH_PARAMETERS; i++) {
        bench.model[i] = which[i] ? new_values[i] : bench.model[i];
    }
}

static void drive(double duty)
{
    fake.actuator = duty;
    bench.count += (int64_t)(duty * 100.0);
}

static double driven(void)
{
    return fake.actuator;
}

static int64_t count(void)
{
    return bench.count;
}

static double position(void)
{
    return (double)bench.count * -0.25;
}

static const epg_jog_actuator_t actuators[1] = {{"motor", drive, driven}};
static const epg_jog_encoder_t encoders[1] = {{"encoder", count, position, "rad"}};
static epg_jog_reading_t first[1];
static epg_jog_reading_t last[1];
static double observed[2];

static const epg_signal_t signals[4] = {
    {"inputs.position", "rad", &fake.input, 1},
    {"inputs.same", "", &fake.sampled, 2},
    {"outputs.same", "", &fake.state, 3},
    {"outputs.duty", "", &fake.output, 4},
};
static const epg_topic_t subscriptions[FAKE_SETPOINTS] = {{.name = "a/set", .count = 1},
                                                          {.name = "/set_b", .index = 1, .count = 1}};
static const epg_topic_t publications[1] = {{.name = "/angle", .count = 1}};
static const char *const components[2] = {"encoder", "motor"};

enum { MONITORED = 6 };

static double monitor_values[MONITORED];
static double monitor_buffers[4][MONITORED];
static epg_exchange_t monitor_exchange = EPG_EXCHANGE(monitor_buffers);
static char output[BENCH_OUTPUT];
static double read_values[MONITORED];
static double memory[BENCH_CAPTURE];

static void monitor(double *monitored)
{
    monitored[0] = fake.output;
    for (size_t i = 0; i < 4; i++) {
        monitored[1 + i] = *signals[i].value;
    }
    memcpy(&monitored[5], &fake.control.time_ns, sizeof fake.control.time_ns);
}

void bench_start(bool enabled)
{
    fake_reset();
    for (size_t i = 0; i < BENCH_PARAMETERS; i++) {
        limits[i] = (epg_parameter_limits_t){-INFINITY, INFINITY};
    }
    limits[BENCH_PARAMETERS - 1] = (epg_parameter_limits_t){0.0, 1.0};
    bench = (bench_t){
        .target = {.control = &fake.control,
                   .application = &fake.application,
                   .node = "bench_node",
                   .name_space = "",
                   .communication_period_ns = 10000000,
                   .component_count = 2,
                   .components = components,
                   .subscription_count = FAKE_SETPOINTS,
                   .subscriptions = subscriptions,
                   .publication_count = 1,
                   .publications = publications,
                   .version = "1.2.3",
                   .hash = "0123456789abcdef",
                   .model = "fedcba9876543210",
                   .middleware = &epg_console,
                   .options = &bench.options,
                   .store = &bench.store,
                   .signal_count = 4,
                   .signals = signals,
                   .time_index = 5},
        .options = {.output = output,
                    .output_size = BENCH_OUTPUT,
                    .values = read_values,
                    .jog_duty = 0.25,
                    .jog_time_ns = 2000000000},
        .parameters = {.count = BENCH_PARAMETERS,
                       .table = table,
                       .model = 77,
                       .set = set,
                       .values = values,
                       .wanted = wanted,
                       .limits = limits,
                       .applied = applied,
                       .changed = changed,
                       .log.acted = acted},
        .store = {.bytes = store_bytes, .parameters = &bench.parameters},
        .capture = {.memory = memory, .capacity = BENCH_CAPTURE},
        .jog = {.actuator_count = 1,
                .actuators = actuators,
                .encoder_count = 1,
                .encoders = encoders,
                .first = first,
                .last = last,
                .values = observed},
        .connected = true,
        .room = SIZE_MAX,
    };
    fake.application.enable_at_start = enabled;
    fake.application.monitor = monitor;
    fake.application.monitor_count = MONITORED;
    fake.application.monitor_values = monitor_values;
    fake.application.monitor_exchange = &monitor_exchange;
    fake.application.parameters = &bench.parameters;
    fake.application.capture = &bench.capture;
    fake.application.jog = &bench.jog;
    epg_store_load(&bench.store);
    fake_start();
    epg_console.start(&bench.target, &stream);
    bench_run(5);
}

void bench_poll(void)
{
    static bool half;
    half = !half;
    if (half && !bench.frozen) {
        fake_cycle();
    } else if (half) {
        fake_port.now_ns += FAKE_PERIOD_NS;
        fake.tick++;
    } else {
        fake_port.now_ns += FAKE_PERIOD_NS / 2;
    }
    epg_console.poll(fake_port.now_ns);
}

void bench_run(unsigned int milliseconds)
{
    for (unsigned int i = 0; i < 2 * milliseconds; i++) {
        bench_poll();
    }
}

const char *bench_send(const void *bytes, size_t size)
{
    const size_t begin = bench.out_length;
    bench.in = bytes;
    bench.in_length = size;
    while (bench.in_length > 0) {
        bench_poll();
    }
    bench_run(10);
    return bench.out + begin;
}

const char *bench_say(const char *text)
{
    return bench_send(text, strlen(text));
}

bool has_line(const char *text, const char *begin)
{
    while (text != NULL && *text != '\0') {
        if (strncmp(text, begin, strlen(begin)) == 0) {
            return true;
        }
        const char *end = strstr(text, "\r\n");
        text = end == NULL ? NULL : end + 2;
    }
    return false;
}
