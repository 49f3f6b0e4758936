/* Reads the bits of doubles in hexadecimal, one per line; prints each double as in the host's files. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "files/number.h"

int main(void)
{
    uint64_t bits;
    while (scanf("%" SCNx64, &bits) == 1) {
        double value;
        memcpy(&value, &bits, sizeof value);
        epg_host_write_number(stdout, value);
        putchar('\n');
    }
    return 0;
}
