/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What distinguishes this computer and this program from others.
 */
#define _POSIX_C_SOURCE 200809L

#include "links/realtime/computer.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

enum { TEXT_SIZE = 512 };

const char *const *epg_host_computer_words(void)
{
    static char machine[TEXT_SIZE];
    static char host[TEXT_SIZE]; /* containers of one image can have one machine-id */
    static char program[TEXT_SIZE];
    static const char *const words[] = {machine, host, program, NULL};
    FILE *file = fopen("/etc/machine-id", "r");
    if (file != NULL) {
        machine[fread(machine, 1, sizeof machine - 1, file)] = '\0';
        (void)fclose(file);
    }
    if (gethostname(host, sizeof host - 1) != 0) {
        host[0] = '\0';
    }
    if (readlink("/proc/self/exe", program, sizeof program - 1) <= 0) {
        program[0] = '\0';
    }
    return words;
}

/** The name is that of a socket that is not in the file system. */
bool epg_host_computer_reserve(const char *name)
{
    static int reserved = -1;
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const int length = snprintf(address.sun_path + 1, sizeof address.sun_path - 1, "epg-%s", name);
    if (reserved >= 0) {
        (void)close(reserved); /* a program can start its target again */
    }
    reserved = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const socklen_t size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + (size_t)length);
    return reserved < 0 || bind(reserved, (const struct sockaddr *)&address, size) == 0 || errno != EADDRINUSE;
}
