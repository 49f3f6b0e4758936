/*
 * What the emulator's own tests run: lines over USB select a case, and each answers with a line.
 */
#include <stdio.h>
#include <string.h>

#include "pico/stdlib.h"

int main(void)
{
    stdio_init_all();
    while (!stdio_usb_connected()) {
        tight_loop_contents();
    }
    printf("ready\n");
    char line[64];
    size_t length = 0;
    for (;;) {
        const int character = getchar();
        if (character != '\n') {
            if (length + 1 < sizeof line) {
                line[length++] = (char)character;
            }
            continue;
        }
        line[length] = 0;
        length = 0;
        printf("echo %s\n", line);
    }
}
