/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Numbers in the form of the host's files.
 */
#include "number.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "epg/finite.h"

bool epg_host_parse_number(const char *text, double *value)
{
    /* strtod() alone would also accept leading white space, hexadecimal numbers and "infinity". */
    const char *digits = text[0] == '+' || text[0] == '-' ? text + 1 : text;
    const bool named = strcmp(digits, "nan") == 0 || strcmp(digits, "inf") == 0;
    if (!named && (digits[0] == '\0' || strspn(digits, "0123456789.eE+-") != strlen(digits))) {
        return false;
    }
    char *end = NULL;
    *value = strtod(text, &end);
    return *end == '\0' && (named || epg_is_finite(*value));
}

bool epg_host_parse_time(const char *text, uint64_t *time_ns)
{
    double seconds = 0.0;
    if (!epg_host_parse_number(text, &seconds) || !(seconds >= 0.0 && seconds <= EPG_HOST_TIME_MAX)) {
        return false;
    }
    *time_ns = (uint64_t)(seconds * 1e9 + 0.5);
    return true;
}

void epg_host_write_number(FILE *file, double value)
{
    if (!epg_is_finite(value)) {
        /* Never "-nan": the sign of a NaN has no meaning and differs between machines. */
        fputs(value > DBL_MAX ? "inf" : value < -DBL_MAX ? "-inf" : "nan", file);
        return;
    }
    char text[32];
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) {
            break;
        }
    }
    fputs(text, file);
}
