/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Prints the sizes of the runtime's objects on this machine.
 */
#include <stdio.h>

#include "epg/control.h"

int main(void)
{
    printf("epg_control_t %zu\n", sizeof(epg_control_t));
    printf("epg_status_t %zu\n", sizeof(epg_status_t));
    printf("epg_exchange_t %zu\n", sizeof(epg_exchange_t));
    printf("epg_application_t %zu\n", sizeof(epg_application_t));
    printf("epg_setpoint_state_t %zu\n", sizeof(epg_setpoint_state_t));
    printf("epg_setpoint_sample_t %zu\n", sizeof(epg_setpoint_sample_t));
    return 0;
}
