/**
 * @file
 * Names of a node.
 */
#include "epg/names.h"

#include <string.h>

#include "epg/port.h"

static const char serial_word[] = "$serial";

/** Appends `text` behind `*length` characters of `name`; false if it does not fit. */
static bool append(char *name, size_t size, size_t *length, const char *text, size_t count)
{
    const size_t room = size - 1 - *length;
    const bool fits = count <= room;
    const size_t taken = fits ? count : room;
    memcpy(name + *length, text, taken);
    *length += taken;
    return fits;
}

bool epg_names_expand(const char *pattern, char *name, size_t size)
{
    size_t length = 0;
    bool fits = true;
    while (*pattern != '\0') {
        if (strncmp(pattern, serial_word, sizeof serial_word - 1) == 0) {
            const char *serial = epg_port_serial();
            fits = append(name, size, &length, serial, strlen(serial)) && fits;
            pattern += sizeof serial_word - 1;
        } else {
            fits = append(name, size, &length, pattern, 1) && fits;
            pattern++;
        }
    }
    name[length] = '\0';
    return fits;
}
