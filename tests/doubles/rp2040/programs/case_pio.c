/* PIO programs that drive pins and raise interrupts. */
#include "cases.h"
#include "hardware/gpio.h"
#include "hardware/irq.h"
#include "hardware/pio.h"
#include "pico/stdlib.h"

static void load(PIO pio, const uint16_t *words, uint8_t length)
{
    const struct pio_program program = {.instructions = words, .length = length, .origin = 0};
    pio_clear_instruction_memory(pio);
    pio_add_program_at_offset(pio, &program, 0);
}

/* A wave, high for 3 and low for 5 cycles at clk_sys / (arguments[0] / 256): delays and divider. */
void case_pio_wave(void)
{
    const uint16_t words[] = {
        (uint16_t)(pio_encode_set(pio_pins, 1) | pio_encode_delay(2)),
        (uint16_t)(pio_encode_set(pio_pins, 0) | pio_encode_delay(4)),
    };
    load(pio0, words, 2);
    pio_sm_config config = pio_get_default_sm_config();
    sm_config_set_set_pins(&config, 6, 1);
    sm_config_set_wrap(&config, 0, 1);
    sm_config_set_clkdiv_int_frac8(&config, arguments[0] >> 8, (uint8_t)arguments[0]);
    pio_gpio_init(pio0, 6);
    pio_sm_set_consecutive_pindirs(pio0, 0, 6, 1, true);
    pio_sm_init(pio0, 0, 0, &config);
    pio_sm_set_enabled(pio0, 0, true);
    busy_wait_us(arguments[1]);
    pio_sm_set_enabled(pio0, 0, false);
}

/* Shifts words out on pin 7, with a clock by side-set on pin 8, and a second state machine shifts them in. */
void case_pio_shift(void)
{
    const uint16_t words[] = {
        (uint16_t)(pio_encode_out(pio_pins, 1) | pio_encode_sideset(1, 0) | pio_encode_delay(1)),
        (uint16_t)(pio_encode_nop() | pio_encode_sideset(1, 1) | pio_encode_delay(1)),
        (uint16_t)pio_encode_wait_gpio(true, 8),
        (uint16_t)pio_encode_in(pio_pins, 1),
        (uint16_t)pio_encode_wait_gpio(false, 8),
    };
    load(pio1, words, 5);
    pio_sm_config out = pio_get_default_sm_config();
    sm_config_set_out_pins(&out, 7, 1);
    sm_config_set_sideset(&out, 1, false, false);
    sm_config_set_sideset_pins(&out, 8);
    sm_config_set_out_shift(&out, false, true, 32);
    sm_config_set_wrap(&out, 0, 1);
    sm_config_set_clkdiv_int_frac8(&out, 4, 0);
    pio_sm_config in = pio_get_default_sm_config();
    sm_config_set_in_pins(&in, 7);
    sm_config_set_in_shift(&in, false, true, 32);
    sm_config_set_wrap(&in, 2, 4);
    pio_gpio_init(pio1, 7);
    pio_gpio_init(pio1, 8);
    pio_sm_set_consecutive_pindirs(pio1, 0, 7, 2, true);
    pio_sm_init(pio1, 1, 2, &in);
    pio_sm_init(pio1, 0, 0, &out);
    pio_sm_set_enabled(pio1, 1, true);
    pio_sm_set_enabled(pio1, 0, true);
    uint32_t errors = 0;
    for (uint32_t n = 0; n < 20; n++) {
        const uint32_t word = 0x9e3779b1u * (n + 1u);
        pio_sm_put_blocking(pio1, 0, word);
        errors += pio_sm_get_blocking(pio1, 1) != word;
    }
    results[0] = errors;
    pio_sm_set_enabled(pio1, 0, false);
    pio_sm_set_enabled(pio1, 1, false);
}

static void on_pio(void)
{
    pio_interrupt_clear(pio0, 0);
    results[1]++;
}

/* A state machine raises flag 0 every 32 cycles and waits until a processor clears it. */
void case_pio_flags(void)
{
    const uint16_t words[] = {
        (uint16_t)(pio_encode_nop() | pio_encode_delay(30)),
        (uint16_t)pio_encode_irq_wait(false, 0),
    };
    load(pio0, words, 2);
    results[1] = 0;
    pio_sm_config config = pio_get_default_sm_config();
    sm_config_set_wrap(&config, 0, 1);
    pio_sm_init(pio0, 3, 0, &config);
    pio_set_irq0_source_enabled(pio0, pis_interrupt0, true);
    irq_set_exclusive_handler(PIO0_IRQ_0, on_pio);
    irq_set_enabled(PIO0_IRQ_0, true);
    pio_sm_set_enabled(pio0, 3, true);
    busy_wait_us(100);
    pio_sm_set_enabled(pio0, 3, false);
    irq_set_enabled(PIO0_IRQ_0, false);
    pio_set_irq0_source_enabled(pio0, pis_interrupt0, false);
}

/* Copies pin 9 to pin 6: two cycles for the synchroniser, one for the instruction. */
void case_pio_latency(void)
{
    const uint16_t words[] = {
        (uint16_t)pio_encode_mov(pio_pins, pio_pins),
    };
    load(pio0, words, 1);
    pio_sm_config config = pio_get_default_sm_config();
    sm_config_set_in_pins(&config, 9);
    sm_config_set_out_pins(&config, 6, 1);
    sm_config_set_wrap(&config, 0, 0);
    pio_gpio_init(pio0, 6);
    gpio_init(9);
    pio_sm_set_consecutive_pindirs(pio0, 0, 6, 1, true);
    pio_sm_init(pio0, 0, 0, &config);
    pio_sm_set_enabled(pio0, 0, true);
}
