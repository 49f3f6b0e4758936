/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The serial number of the program: a word from the command line.  A serial number of the PC would not distinguish
 * several programs on it.
 */
#include "serial.h"

#include "epg/port.h"

static const char *serial = "host";

void epg_host_serial_set(const char *text)
{
    serial = text;
}

const char *epg_port_serial(void)
{
    return serial;
}
