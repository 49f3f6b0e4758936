/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * main() of an executable that contains a target and nothing else.
 */
#include "epg/family.h"
#include "epg/freertos.h"

/* <name>_start() of the target; CMake defines the name. */
extern bool EPG_MCU_START(void);

int main(void)
{
    if (!EPG_MCU_START()) {
        epg_family_panic(NULL);
    }
    vTaskStartScheduler();
    epg_family_panic(NULL);
}
