/* Shows that a cable carries data. */
#include <stdio.h>

#include "pico/stdlib.h"

int main(void)
{
    stdio_init_all();
    for (unsigned count = 0;; count++) {
        printf("hello %u\n", count);
        sleep_ms(1000);
    }
}
