/*
 * A program whose main() on core 0 sets and gets values by name, while core 1 controls, and while communication
 * interrupts it.  The test writes `wanted` and `gain`, and reads the other variables.
 */
#include "jiwy.h"
#include "pico.h"

volatile int32_t wanted = -1;   /* setpoint in mrad; negative: main() sets none */
volatile int32_t gain = -1;     /* Pan\PID\kp in thousandths; negative: main() sets none */
volatile uint32_t order;        /* 1: stop and start again */
volatile uint32_t rounds;       /* in which all values were read */
volatile uint32_t refused;      /* calls that failed and should not have */
volatile uint32_t disordered;   /* values that are not from the next cycles */
volatile uint32_t first_failed; /* after a start, the first call has no values */
jiwy_values_t values;
double measured_gain;
epg_status_t status;

static void start(void)
{
    if (!jiwy_start()) {
        panic("start");
    }
    first_failed += jiwy_get(&values) ? 0U : 1U;
    rounds = 0;
}

int main(void)
{
    start();
    for (;;) {
        const uint64_t last = values.time_ns;
        if (wanted >= 0) {
            refused += jiwy_set_setpoint_pan(wanted / 1000.0) ? 0U : 1U;
        }
        if (gain >= 0) {
            refused += jiwy_set_Pan_PID_kp(gain / 1000.0) ? 0U : 1U;
        }
        (void)jiwy_get_Pan_PID_kp(&measured_gain);
        if (jiwy_get(&values)) {
            if (rounds > 0 && (values.time_ns < last || (values.time_ns - last) % 1000000U != 0U)) {
                disordered++;
            }
            rounds++;
        }
        (void)jiwy_status(&status);
        if (order == 1U) {
            order = 0;
            refused += jiwy_stop() ? 0U : 1U;
            start();
        }
    }
}
