/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What distinguishes this computer and this program from others.  No Mac has run this.
 */
#include "links/realtime/computer.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <mach-o/dyld.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <unistd.h>
#include <uuid/uuid.h>

const char *const *epg_host_computer_words(void)
{
    static uuid_string_t machine;
    static char program[PATH_MAX];
    static const char *const words[] = {machine, program, NULL};
    const struct timespec patience = {.tv_sec = 1};
    uuid_t number;
    uint32_t size = sizeof program;
    if (gethostuuid(number, &patience) == 0) {
        uuid_unparse(number, machine);
    }
    if (_NSGetExecutablePath(program, &size) != 0) {
        program[0] = '\0';
    }
    return words;
}

/** The name is that of a file in the user's own folder, which the system unlocks when the program ends. */
bool epg_host_computer_reserve(const char *name)
{
    static int reserved = -1;
    char folder[PATH_MAX];
    char path[2 * PATH_MAX];
    if (reserved >= 0) {
        (void)close(reserved); /* a program can start its target again */
    }
    if (confstr(_CS_DARWIN_USER_TEMP_DIR, folder, sizeof folder) == 0) {
        return true;
    }
    (void)snprintf(path, sizeof path, "%s/epg-%s", folder, name);
    reserved = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_EXLOCK, 0600);
    return reserved >= 0 || errno != EWOULDBLOCK;
}
