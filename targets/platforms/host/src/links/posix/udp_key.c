/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The file with the key of the console by UDP.
 */
#define _DEFAULT_SOURCE /* getentropy() */

#include "links/realtime/udp_key.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

enum { LONGEST = 200 }; /* bytes of the file */

static bool refuse(const char *path, const char *reason, const char *hint)
{
    fprintf(stderr, "error: --console-key %s: %s\nhint: %s%s\n", path, reason, hint, path);
    return false;
}

bool epg_host_udp_key_load(const char *path, unsigned char key[EPG_HOST_UDP_KEY])
{
    static const char make[] = "this makes a new one: umask 077; openssl rand -hex 16 > ";
    const int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status;
    if (file < 0 || fstat(file, &status) != 0) {
        return refuse(path, strerror(errno), make);
    }
    char text[LONGEST + 1];
    const ssize_t count = read(file, text, LONGEST);
    close(file);
    if (!S_ISREG(status.st_mode)) {
        return refuse(path, "it is not a file", make);
    }
    if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
        return refuse(path, "other users may read or change it", "chmod 600 ");
    }
    text[count > 0 ? count : 0] = '\0';
    if (!epg_host_udp_key_read(text, key)) {
        return refuse(path, "it does not have the 32 hexadecimal digits of a key", make);
    }
    return true;
}

void epg_host_udp_random(void *data, size_t size)
{
    while (getentropy(data, size) != 0) { /* a signal came before the system had a first number */
    }
}
