/**
 * @file
 * A port layer whose clock and signals a test sets and reads.
 */
#include "fake_port.h"

#include "check.h"

fake_port_t fake_port;

void fake_port_reset(void)
{
    fake_port = (fake_port_t){0};
}

static void written(void)
{
    fake_port.writes++;
    if (fake_port.on_write != NULL) {
        fake_port.on_write();
    }
}

/** Like ports whose drivers may refuse a write; returns false if nothing is written. */
static bool may_write(uint8_t pin, epg_level_t level)
{
    if (fake_port.guarded == NULL) {
        return true;
    }
    if (!epg_outputs_may_write(fake_port.guarded, pin)) {
        return false;
    }
    if ((fake_port.refuses >> pin & 1U) != 0U) {
        fake_port.refused |= 1U << pin;
        epg_outputs_refused(fake_port.guarded, pin, fake_port.take_over);
        return false;
    }
    epg_outputs_written(fake_port.guarded, pin, level);
    return true;
}

static epg_level_t level_of(bool high)
{
    return high ? EPG_LEVEL_HIGH : EPG_LEVEL_LOW;
}

uint64_t epg_port_time_ns(void)
{
    return fake_port.now_ns;
}

void epg_port_quadrature_start(const epg_port_quadrature_t *decoder)
{
    fake_port.decoders_started[decoder->slot] = true;
}

uint32_t epg_port_quadrature_count(const epg_port_quadrature_t *decoder)
{
    CHECK(fake_port.decoders_started[decoder->slot]);
    return fake_port.counts[decoder->slot];
}

bool epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder)
{
    CHECK(fake_port.decoders_started[decoder->slot]);
    return !fake_port.decoders_failed[decoder->slot];
}

void epg_port_pwm_start(const epg_port_pwm_t *pwm)
{
    fake_port.pwms_started[pwm->slot] = true;
    fake_port.tops[pwm->slot] = pwm->top;
    fake_port.levels[pwm->slot] = 0;
    written();
}

void epg_port_pwm_write(const epg_port_pwm_t *pwm, uint32_t level)
{
    CHECK(fake_port.pwms_started[pwm->slot]);
    CHECK(level <= fake_port.tops[pwm->slot] + 1U);
    if (!may_write(pwm->pin, level > 0U && level <= pwm->top ? EPG_LEVEL_SWITCHING : level_of(level > 0U))) {
        return;
    }
    fake_port.levels[pwm->slot] = level;
    written();
}

void epg_port_output_start(uint8_t pin, bool level)
{
    fake_port.outputs_started[pin] = true;
    fake_port.outputs[pin] = level;
    written();
}

void epg_port_output_write(uint8_t pin, bool level)
{
    CHECK(fake_port.outputs_started[pin]);
    if (!may_write(pin, level_of(level))) {
        return;
    }
    fake_port.outputs[pin] = level;
    written();
}

void epg_port_input_start(uint8_t pin, epg_port_pull_t pull)
{
    fake_port.inputs_started[pin] = true;
    fake_port.pulls[pin] = pull;
}

bool epg_port_input_read(uint8_t pin)
{
    CHECK(fake_port.inputs_started[pin]);
    return fake_port.inputs[pin];
}

size_t epg_port_store_read(void *data, size_t size)
{
    const size_t taken = size < fake_port.store_size ? size : fake_port.store_size;
    memcpy(data, fake_port.store, taken);
    return taken;
}

const char *epg_port_store_write(const void *data, size_t size)
{
    if (fake_port.store_refuses || size > FAKE_STORE) {
        return "the fake memory is worn out";
    }
    memcpy(fake_port.store, data, size);
    fake_port.store_size = size;
    return NULL;
}

bool epg_port_uart_start(const epg_port_uart_t *uart)
{
    (void)uart;
    return true;
}

void epg_port_uart_send(const epg_port_uart_t *uart)
{
    (void)uart;
}

void epg_port_wait_until(uint64_t time_ns)
{
    CHECK(time_ns >= fake_port.now_ns);
    fake_port.now_ns = time_ns;
}

const char *epg_port_serial(void)
{
    return "E6616407E3A51B2C";
}

uint32_t epg_port_boot_id(void)
{
    return FAKE_BOOT_ID;
}
