/**
 * @file
 * Wires of the pan axis that break or are swapped, from a given time on.
 *
 * The environment selects the fault: `WIRING=encoder-dead@8.5` and so on.  With `SIGNALS=<file>`, that file records
 * each access of the program to the hardware.  The linker inserts the functions here between the program, the simulated
 * peripherals and the simulated plant (--wrap).
 */
#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "epg/port.h"

void __real_epg_plant_quadrature_set(uint8_t slot, int64_t count);
double __real_epg_plant_pwm_duty(uint8_t slot);
void __wrap_epg_plant_quadrature_set(uint8_t slot, int64_t count);
double __wrap_epg_plant_pwm_duty(uint8_t slot);
bool __real_epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder);
bool __wrap_epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder);
uint32_t __real_epg_port_quadrature_count(const epg_port_quadrature_t *decoder);
uint32_t __wrap_epg_port_quadrature_count(const epg_port_quadrature_t *decoder);
void __real_epg_port_pwm_write(const epg_port_pwm_t *pwm, uint32_t level);
void __wrap_epg_port_pwm_write(const epg_port_pwm_t *pwm, uint32_t level);
void __real_epg_port_output_write(uint8_t pin, bool level);
void __wrap_epg_port_output_write(uint8_t pin, bool level);

enum { PAN = 0 };

/** True if the fault `what` is present now. */
static bool wired(const char *what)
{
    const char *wiring = getenv("WIRING");
    const char *at = wiring == NULL ? NULL : strchr(wiring, '@');
    return at != NULL && (size_t)(at - wiring) == strlen(what) && strncmp(wiring, what, strlen(what)) == 0 &&
           (double)epg_port_time_ns() * 1e-9 >= atof(at + 1);
}

void __wrap_epg_plant_quadrature_set(uint8_t slot, int64_t count)
{
    static int64_t last; /* last count of the pan axis before the fault */
    int64_t seen = count;
    if (slot == PAN) {
        if (wired("encoder-dead")) {
            seen = last;
        } else if (wired("encoder-swapped")) {
            seen = 2 * last - count;
        } else if (wired("encoder-turned-by-hand")) {
            seen = last + (int64_t)(1000.0 * sin(5.0 * (double)epg_port_time_ns() * 1e-9));
        } else if (wired("encoder-counts-thrice")) {
            seen = 3 * count;
        } else {
            last = count;
        }
    }
    __real_epg_plant_quadrature_set(slot, seen);
}

double __wrap_epg_plant_pwm_duty(uint8_t slot)
{
    const double duty = __real_epg_plant_pwm_duty(slot);
    if (slot == PAN && wired("motor-swapped")) {
        return -duty;
    }
    return slot == PAN && wired("motor-unplugged") ? 0.0 : duty;
}

bool __wrap_epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder)
{
    const bool halted = decoder->slot == PAN && wired("decoder-halted") && epg_port_time_ns() < 12000000000U;
    return !halted && __real_epg_port_quadrature_healthy(decoder);
}

/* The signals, in the order in which the program reads and writes them. */

static void record(const char *what, unsigned int number, uint32_t value)
{
    static FILE *file;
    if (file == NULL && getenv("SIGNALS") != NULL) {
        file = fopen(getenv("SIGNALS"), "w");
    }
    if (file != NULL) {
        fprintf(file, "%" PRIu64 " %s%u %" PRIu32 "\n", epg_port_time_ns(), what, number, value);
    }
}

uint32_t __wrap_epg_port_quadrature_count(const epg_port_quadrature_t *decoder)
{
    record("encoder", decoder->slot, 0);
    return __real_epg_port_quadrature_count(decoder);
}

void __wrap_epg_port_pwm_write(const epg_port_pwm_t *pwm, uint32_t level)
{
    record("pwm", pwm->slot, level);
    __real_epg_port_pwm_write(pwm, level);
}

void __wrap_epg_port_output_write(uint8_t pin, bool level)
{
    record("pin", pin, level);
    __real_epg_port_output_write(pin, level);
}
