/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * EPG's main() of a host executable, for users who do not write their own.
 */
#include "epg/host.h"

/** The generated <name>_host; CMake defines the name. */
extern const epg_host_target_t EPG_HOST_TARGET;

int main(int argc, char **argv)
{
    return epg_host_main(&EPG_HOST_TARGET, argc, argv);
}
