/* Reports the chip's temperature on the UART. */
#include <stdio.h>

#include "pico/stdlib.h"
#include "readings.h"

int main(void)
{
    stdio_init_all();
    readings_start();
    for (;;) {
        printf("%.1f\n", (double)readings_temperature());
        sleep_ms(1000);
    }
}
