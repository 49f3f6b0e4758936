/* Core 0 of the turntable: the controller runs on core 1, its console on USB. */
#include <stdio.h>

#include "pico/stdlib.h"
#include "turntable.h"

int main(void)
{
    stdio_init_all();
    gpio_init(PICO_DEFAULT_LED_PIN);
    gpio_set_dir(PICO_DEFAULT_LED_PIN, GPIO_OUT);
    if (!turntable_start()) {
        printf("the turntable's controller cannot be started\n");
        return 1;
    }
    for (unsigned count = 0;; count++) {
        epg_status_t status;
        if (turntable_status(&status)) {
            gpio_put(PICO_DEFAULT_LED_PIN, status.enabled);
            double position; /* rad, in the newest control cycle */
            if (turntable_get_position(&position) && count % 10 == 0) {
                printf("%.3f rad, %llu cycles, %llu overruns\n", position,
                       (unsigned long long)status.statistics.cycles, (unsigned long long)status.statistics.overruns);
            }
        }
        sleep_ms(100);
    }
}
