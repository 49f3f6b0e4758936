/* Reads numbers, one per line, into a histogram; prints count, min, max, mean and the quantiles that the tests need. */
#include <inttypes.h>
#include <stdio.h>

#include "loop/histogram.h"

int main(void)
{
    static epg_host_histogram_t histogram;
    uint64_t value;
    while (scanf("%" SCNu64, &value) == 1) {
        epg_host_histogram_add(&histogram, value);
    }
    printf("%" PRIu64 " %" PRIu64 " %" PRIu64 " %.17g", histogram.count, histogram.min, histogram.max,
           epg_host_histogram_mean(&histogram));
    const double shares[] = {0.0, 0.5, 0.9, 0.99, 0.999, 1.0};
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        printf(" %" PRIu64, epg_host_histogram_quantile(&histogram, shares[i]));
    }
    printf(" %" PRIu64 "\n", epg_host_histogram_between(&histogram, 0, UINT64_MAX));
    return 0;
}
