/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What tells one program from another: a word from the command line, as nothing else of a PC is one program's own.
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
