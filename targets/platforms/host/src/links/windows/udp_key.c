/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The file with the key of the console by UDP.  Its rights are those of its folder: EPG does not check them.
 */
#define _CRT_RAND_S /* rand_s() */

#include "links/realtime/udp_key.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST = 200 }; /* bytes of the file */

bool epg_host_udp_key_load(const char *path, unsigned char key[EPG_HOST_UDP_KEY])
{
    char text[LONGEST + 1];
    FILE *file = fopen(path, "r");
    const size_t count = file != NULL ? fread(text, 1, LONGEST, file) : 0;
    text[count] = '\0';
    if (file != NULL) {
        fclose(file);
    }
    if (!epg_host_udp_key_read(text, key)) {
        fprintf(stderr, "error: --console-key %s: %s\nhint: without --console-key, the program makes a key\n", path,
                file != NULL ? "it does not have the 32 hexadecimal digits of a key" : "it cannot be read");
        return false;
    }
    return true;
}

void epg_host_udp_random(void *data, size_t size)
{
    unsigned char *bytes = data;
    for (size_t i = 0; i < size; i++) {
        unsigned int number = 0;
        while (rand_s(&number) != 0) {
        }
        bytes[i] = (unsigned char)number;
    }
}
