/* PWM slices. */
#include "cases.h"
#include "hardware/gpio.h"
#include "hardware/irq.h"
#include "hardware/pwm.h"
#include "hardware/sync.h"
#include "pico/stdlib.h"

/* Slice 1 (pins 2, 3).  Arguments: TOP, levels A and B, divider in 1/16, flags (1: phase-correct, 2: invert A). */
void case_pwm(void)
{
    gpio_set_function(2, GPIO_FUNC_PWM);
    gpio_set_function(3, GPIO_FUNC_PWM);
    pwm_config config = pwm_get_default_config();
    pwm_config_set_wrap(&config, (uint16_t)arguments[0]);
    pwm_config_set_clkdiv_int_frac4(&config, arguments[3] >> 4, (uint8_t)(arguments[3] & 15u));
    pwm_config_set_phase_correct(&config, (arguments[4] & 1u) != 0);
    pwm_config_set_output_polarity(&config, (arguments[4] & 2u) != 0, false);
    pwm_init(1, &config, false);
    pwm_set_both_levels(1, (uint16_t)arguments[1], (uint16_t)arguments[2]);
    pwm_set_enabled(1, true);
}

/* The contents of the registers: EN as a mask, the counter twice, and PH_ADV. */
void __not_in_flash_func(case_pwm_registers)(void)
{
    pwm_config config = pwm_get_default_config();
    pwm_init(1, &config, false);
    pwm_init(2, &config, false);
    pwm_init(5, &config, false);
    pwm_set_mask_enabled(1u << 1 | 1u << 5);
    const uint32_t first = pwm_get_counter(1);
    const uint32_t other = pwm_get_counter(5);
    const uint32_t second = pwm_get_counter(1);
    results[0] = pwm_hw->en;
    results[1] = second - first;
    results[2] = other - first;
    pwm_set_enabled(2, true);
    results[3] = pwm_hw->en;
    pwm_set_mask_enabled(0);
    pwm_set_counter(1, 100);
    results[4] = pwm_get_counter(1);
    pwm_hw->slice[1].csr = PWM_CH0_CSR_EN_BITS;
    pwm_hw->slice[1].csr = PWM_CH0_CSR_EN_BITS | PWM_CH0_CSR_PH_ADV_BITS;
    results[5] = pwm_get_counter(1);
    pwm_set_mask_enabled(0);
}

static void __not_in_flash_func(on_tick)(void)
{
    pwm_clear_irq(3);
    results[0]++;
    pwm_set_gpio_level(2, (uint16_t)(results[0] % 100u));
}

/* A tick of arguments[0] cycles on slice 3.  It changes the level of slice 1, whose period is arguments[1] cycles. */
void case_pwm_tick(void)
{
    results[0] = 0;
    gpio_set_function(2, GPIO_FUNC_PWM);
    pwm_config config = pwm_get_default_config();
    pwm_config_set_wrap(&config, (uint16_t)(arguments[1] - 1u));
    pwm_init(1, &config, false);
    pwm_config_set_wrap(&config, (uint16_t)(arguments[0] - 1u));
    pwm_init(3, &config, false);
    pwm_clear_irq(3);
    pwm_set_irq_enabled(3, true);
    irq_set_exclusive_handler(PWM_IRQ_WRAP, on_tick);
    irq_set_enabled(PWM_IRQ_WRAP, true);
    pwm_set_mask_enabled(1u << 1 | 1u << 3);
    while (results[0] < 50) {
        __wfi();
    }
    pwm_set_mask_enabled(0);
    irq_set_enabled(PWM_IRQ_WRAP, false);
    irq_remove_handler(PWM_IRQ_WRAP, on_tick);
    pwm_set_irq_enabled(3, false);
}
