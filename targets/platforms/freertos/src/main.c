/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * main() of an executable that holds a target and nothing else.
 */
#include "../../../families/rp2/src/sdk.h"
#include "rtos.h"

/* <name>_start() of the target; CMake names it. */
extern bool EPG_PICO_START(void);

int main(void)
{
    if (!EPG_PICO_START()) {
        panic(NULL);
    }
    vTaskStartScheduler();
    panic(NULL);
}
