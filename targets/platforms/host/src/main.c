/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * main() of a host executable whose user has none of their own.
 */
#include "epg/host.h"

/** Defined by the generated code; the build names it: <name>_host. */
extern const epg_host_target_t EPG_HOST_TARGET;

int main(int argc, char **argv)
{
    return epg_host_main(&EPG_HOST_TARGET, argc, argv);
}
