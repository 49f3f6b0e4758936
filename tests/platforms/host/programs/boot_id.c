/**
 * @file
 * Prints the number of this start twice, in real time or, with any argument, in simulated time.
 */
#include <inttypes.h>
#include <stdio.h>

#include "epg/port.h"
#include "port/clock.h"

int main(int argc, char **argv)
{
    (void)argv;
    if (argc > 1) {
        epg_host_clock_simulate(0);
    }
    const uint32_t first = epg_port_boot_id();
    printf("%" PRIu32 " %" PRIu32 "\n", first, epg_port_boot_id());
    return 0;
}
