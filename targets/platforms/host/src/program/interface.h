/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The names of a target, for programs.
 */
#ifndef EPG_HOST_INTERFACE_H
#define EPG_HOST_INTERFACE_H

#include "epg/host.h"

/** Prints the names that scenarios and setpoint files may use: a line `kind,name` for each name. */
void epg_host_print_interface(const epg_host_target_t *host);

#endif
