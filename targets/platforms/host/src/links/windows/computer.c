/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What distinguishes this computer and this program from others.
 */
#include "links/realtime/computer.h"

#include <stdio.h>

#include <windows.h>

enum { TEXT_SIZE = 512 };

const char *const *epg_host_computer_words(void)
{
    static char machine[TEXT_SIZE];
    static char program[TEXT_SIZE];
    static const char *const words[] = {machine, program, NULL};
    DWORD size = sizeof machine;
    if (!GetComputerNameA(machine, &size)) {
        machine[0] = '\0';
    }
    if (GetModuleFileNameA(NULL, program, sizeof program) == 0) {
        program[0] = '\0';
    }
    return words;
}

/** The name is that of a mutex. */
bool epg_host_computer_reserve(const char *name)
{
    static HANDLE reserved;
    char text[TEXT_SIZE];
    (void)snprintf(text, sizeof text, "epg-%s", name);
    if (reserved != NULL) {
        CloseHandle(reserved); /* a program can start its target again */
    }
    reserved = CreateMutexA(NULL, FALSE, text);
    return reserved == NULL || GetLastError() != ERROR_ALREADY_EXISTS;
}
