/* SPDX-License-Identifier: Apache-2.0 */
#include "witness.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "epg/port.h"

static FILE *file;
static bool driven;
static uint64_t begin_ns;
static uint64_t driven_ns;

void witness_start(void)
{
    const char *path = getenv("WITNESS_FILE");
    file = path == NULL ? NULL : fopen(path, "a");
}

void witness_cycle(void)
{
    begin_ns = epg_port_time_ns();
}

void witness_drive(double duty)
{
    (void)duty;
    if (!driven && file != NULL) {
        fprintf(file, "drive %" PRIu64 "\n", begin_ns);
        fflush(file);
    }
    driven = true;
    driven_ns = begin_ns;
}

void witness_safe(void)
{
    if (driven && file != NULL) {
        fprintf(file, "safe %" PRIu64 " %" PRIu64 "\n", driven_ns, epg_port_time_ns());
        fflush(file);
    }
    driven = false;
}
