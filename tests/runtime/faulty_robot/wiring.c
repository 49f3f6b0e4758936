/**
 * @file
 * Wires of the pan axis that break, or that somebody has swapped, from a moment on.
 *
 * The environment says what happens: `WIRING=encoder-dead@8.5` and so on.  The functions stand between the simulated
 * plant and the simulated peripherals; the linker puts them there (--wrap).
 */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "epg/port.h"

void __real_epg_host_quadrature_set(uint8_t unit, int64_t count);
double __real_epg_host_pwm_duty(uint8_t unit);
void __wrap_epg_host_quadrature_set(uint8_t unit, int64_t count);
double __wrap_epg_host_pwm_duty(uint8_t unit);
bool __real_epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder);
bool __wrap_epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder);

enum { PAN = 0 };

/** Whether `what` is the case now. */
static bool wired(const char *what)
{
    const char *wiring = getenv("WIRING");
    const char *at = wiring == NULL ? NULL : strchr(wiring, '@');
    return at != NULL && (size_t)(at - wiring) == strlen(what) && strncmp(wiring, what, strlen(what)) == 0 &&
           (double)epg_port_time_ns() * 1e-9 >= atof(at + 1);
}

void __wrap_epg_host_quadrature_set(uint8_t unit, int64_t count)
{
    static int64_t last; /* of the pan axis, while everything was right */
    int64_t seen = count;
    if (unit == PAN) {
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
    __real_epg_host_quadrature_set(unit, seen);
}

double __wrap_epg_host_pwm_duty(uint8_t unit)
{
    const double duty = __real_epg_host_pwm_duty(unit);
    if (unit == PAN && wired("motor-swapped")) {
        return -duty;
    }
    return unit == PAN && wired("motor-unplugged") ? 0.0 : duty;
}

bool __wrap_epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder)
{
    const bool halted = decoder->unit == PAN && wired("decoder-halted") && epg_port_time_ns() < 12000000000U;
    return !halted && __real_epg_port_quadrature_healthy(decoder);
}
