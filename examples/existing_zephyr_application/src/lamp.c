#include "lamp.h"

#include <zephyr/drivers/gpio.h>

static const struct gpio_dt_spec lamp = GPIO_DT_SPEC_GET(DT_ALIAS(lamp), gpios);

int lamp_start(void)
{
    return gpio_pin_configure_dt(&lamp, GPIO_OUTPUT_INACTIVE);
}

void lamp_set(int on)
{
    (void)gpio_pin_set_dt(&lamp, on);
}
