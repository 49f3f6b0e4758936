/**
 * @file
 * An application with one input and one output.  A test can control and count each of its functions.
 */
#include "fake_application.h"

#include "check.h"
#include "epg/finite.h"
#include "fake_port.h"

fake_application_t fake;

static epg_setpoint_sample_t samples[FAKE_SETPOINTS];
static epg_setpoint_sample_t received[FAKE_SETPOINTS];
static epg_setpoint_state_t states[FAKE_SETPOINTS];
static epg_setpoint_sample_t setpoint_buffers[4][FAKE_SETPOINTS];
static epg_exchange_t setpoint_exchange = EPG_EXCHANGE(setpoint_buffers);
static double monitor_values[1];
static double monitor_buffers[4][1];
static epg_exchange_t monitor_exchange = EPG_EXCHANGE(monitor_buffers);

static void called(char letter)
{
    const size_t length = strlen(fake.calls);
    CHECK(length + 1 < sizeof fake.calls);
    fake.calls[length] = letter;
}

static void start(void)
{
    called('p');
    fake.starts++;
}

static void sample(void)
{
    called('x');
    fake.sampled = fake.sensor;
}

static void read_inputs(void)
{
    called('r');
    fake.reads++;
    epg_control_check(&fake.control, fake.fault, FAKE_COMPONENT);
    fake.input = fake.sampled + epg_control_setpoint(&fake.control, 0);
}

static bool inputs_finite(void)
{
    return epg_is_finite(fake.input);
}

static void model_init(void)
{
    called('i');
    fake.inits++;
    fake.state = 0.0;
    fake.output = fake.input;
}

static void model_step(void)
{
    called('m');
    fake.steps++;
    fake.state += 1.0 + fake.state_error;
    fake.output = fake.input + fake.state + fake.output_error;
    if (fake.limit > 0.0 && fake.output > fake.limit) {
        fake.output = fake.limit;
    }
    fake_port.now_ns += fake.step_ns;
}

static bool model_finite(void)
{
    return epg_is_finite(fake.state) && epg_is_finite(fake.output);
}

static bool model_stopped(void)
{
    return fake.stop;
}

static void write_outputs(void)
{
    called('w');
    fake.writes++;
    fake.written_ns = fake_port.now_ns;
    fake.actuator = fake.output;
}

static void safe_outputs(void)
{
    called('s');
    fake.safes++;
    fake.actuator = 0.0;
}

static void monitor(double *values)
{
    called('o');
    values[0] = fake.output;
}

void fake_reset(void)
{
    fake_port_reset();
    fake = (fake_application_t){
        .application =
            {
                .name = "fake",
                .period_ns = FAKE_PERIOD_NS,
                .step_divider = 1,
                .enable_at_start = true,
                .start = start,
                .sample = sample,
                .read = read_inputs,
                .inputs_finite = inputs_finite,
                .model_init = model_init,
                .model_step = model_step,
                .model_finite = model_finite,
                .model_stopped = model_stopped,
                .write = write_outputs,
                .safe = safe_outputs,
                .monitor = monitor,
                .setpoint_count = FAKE_SETPOINTS,
                .setpoints = fake.setpoints,
                .samples = samples,
                .received = received,
                .setpoint_states = states,
                .setpoint_exchange = &setpoint_exchange,
                .monitor_count = 1,
                .monitor_values = monitor_values,
                .monitor_exchange = &monitor_exchange,
            },
        .fail_safe = true,
    };
}

void fake_start(void)
{
    epg_control_start(&fake.control, &fake.application);
}

void fake_late_cycle(uint64_t late_ns, uint32_t missed)
{
    fake.tick += missed;
    const uint64_t tick_ns = fake.tick * FAKE_PERIOD_NS;
    fake_port.now_ns = tick_ns + late_ns;
    memset(fake.calls, 0, sizeof fake.calls);
    epg_control_cycle(&fake.control, tick_ns, missed);
    fake.tick++;
}

void fake_cycle(void)
{
    fake_late_cycle(0, 0);
}

void fake_cycles(unsigned int count)
{
    for (unsigned int i = 0; i < count; i++) {
        fake_cycle();
    }
}

bool fake_receive(size_t index, double value)
{
    return epg_control_receive(&fake.control, index, value, fake_port.now_ns, true);
}

epg_status_t fake_status(void)
{
    epg_status_t status;
    CHECK(epg_control_status(&fake.control, &status));
    return status;
}

double fake_published(void)
{
    double value;
    CHECK(epg_control_monitor(&fake.control, &value));
    return value;
}
