/* Shows that a board is alive. */
#include "pico/stdlib.h"

int main(void)
{
    gpio_init(PICO_DEFAULT_LED_PIN);
    gpio_set_dir(PICO_DEFAULT_LED_PIN, GPIO_OUT);
    for (bool on = true;; on = !on) {
        gpio_put(PICO_DEFAULT_LED_PIN, on);
        sleep_ms(250);
    }
}
