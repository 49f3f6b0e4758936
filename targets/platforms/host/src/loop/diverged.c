/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Plants whose outputs are no possible values.
 */
#include "diverged.h"

#include <stdio.h>

#include "epg/finite.h"
#include "files/number.h"

bool epg_host_has_diverged(double value)
{
    return !epg_is_finite(value) || value > EPG_HOST_PLANT_LARGEST || value < -EPG_HOST_PLANT_LARGEST;
}

void epg_host_tell_diverged(const char *owner, const char *output, double value, uint64_t time_ns)
{
    const bool owned = owner != NULL;
    fprintf(stderr, "error: the plant has diverged: %s%s%s is ", owned ? owner : "", owned ? "/" : "", output);
    epg_host_write_number(stderr, value);
    fputs(" at ", stderr);
    epg_host_write_number(stderr, epg_host_seconds(time_ns));
    fputs(" s\nhint: an output of a plant must be finite and within +-1e12: check the plant's step size and its "
          "parameters; --trace records its signals up to this time\n",
          stderr);
}
