/*
 * Prints "ready" when a terminal opens, echoes each line, and counts the other events of the port.
 */
#include <stdio.h>
#include <string.h>

#include "pico/stdlib.h"

volatile uint32_t opened;
volatile uint32_t closed;
volatile uint32_t received;
volatile uint32_t checksum; /* of all bytes received: sum * 31 + byte */

int main(void)
{
    stdio_init_all();
    stdio_set_translate_crlf(&stdio_usb, false);
    bool open = false;
    char line[600];
    size_t length = 0;
    for (;;) {
        if (stdio_usb_connected() != open) {
            open = !open;
            if (open) {
                opened++;
                printf("ready\n");
            } else {
                closed++;
                length = 0;
            }
        }
        const int character = getchar_timeout_us(100);
        if (character == PICO_ERROR_TIMEOUT) {
            continue;
        }
        received++;
        checksum = checksum * 31u + (uint32_t)character;
        if (character != '\n' && length + 1 < sizeof line) {
            line[length++] = (char)character;
            continue;
        }
        line[length] = 0;
        length = 0;
        printf("echo %s\n", line);
    }
}
