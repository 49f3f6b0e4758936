/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A Windows program that lets the compiler of Debian do its work, for programs that run under Wine.
 *
 * Its file name is the name of the tool: gcc.exe starts x86_64-w64-mingw32-gcc.  Wine does not wait for a program of
 * Linux and gives it no working folder.  So this program writes its arguments into a file, starts `forward.sh` with it,
 * and waits for the file with the status.  The variable EPG_FORWARD names the folder with `forward.sh`, as Linux sees it.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

enum { LONGEST = 2048 };

static char job[LONGEST]; /* the beginning of the names of this call's files, with Wine's drive */

/** Opens a file of this call; without a mode, removes it. */
static FILE *open_file(const char *end, const char *mode)
{
    char path[LONGEST + 16];
    snprintf(path, sizeof path, "%s.%s", job, end);
    return mode != NULL ? fopen(path, mode) : (remove(path), NULL);
}

/** Writes a text in UTF-8 with its final 0. */
static void put(const wchar_t *text, FILE *file)
{
    static char bytes[1 << 16];
    WideCharToMultiByte(CP_UTF8, 0, text, -1, bytes, sizeof bytes, NULL, NULL);
    fwrite(bytes, 1, strlen(bytes) + 1, file);
}

int wmain(int count, wchar_t **arguments)
{
    wchar_t text[LONGEST];
    char command[2 * LONGEST];
    const char *folder = getenv("EPG_FORWARD");
    FILE *file = NULL;
    snprintf(job, sizeof job, "Z:%s/jobs/%lu", folder != NULL ? folder : "", GetCurrentProcessId());
    if (folder == NULL || (file = open_file("arguments", "wb")) == NULL) {
        fputs("EPG_FORWARD does not name the folder of forward.sh\n", stderr);
        return 1;
    }
    open_file("status", NULL); /* of an earlier call with this number */
    GetModuleFileNameW(NULL, text, LONGEST);
    put(wcsrchr(text, L'\\') + 1, file);
    GetCurrentDirectoryW(LONGEST, text);
    put(text, file);
    for (int i = 1; i < count; i++) {
        put(arguments[i], file);
    }
    fclose(file);
    STARTUPINFOA start = {.cb = sizeof start};
    PROCESS_INFORMATION process;
    snprintf(command, sizeof command, "Z:\\bin\\bash %s/forward.sh %s", folder, job + 2);
    if (!CreateProcessA(NULL, command, NULL, NULL, FALSE, 0, NULL, NULL, &start, &process)) {
        fprintf(stderr, "bash cannot be started: error %lu\n", GetLastError());
        return 1;
    }
    while ((file = open_file("status", "r")) == NULL) {
        Sleep(2);
    }
    int status = 1;
    if (fscanf(file, "%d", &status) != 1) {
        status = 1;
    }
    fclose(file);
    if ((file = open_file("output", "rb")) != NULL) {
        for (int byte = getc(file); byte != EOF; byte = getc(file)) {
            putchar(byte);
        }
        fclose(file);
    }
    open_file("arguments", NULL);
    open_file("output", NULL);
    open_file("status", NULL);
    return status;
}
