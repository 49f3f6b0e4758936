/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Files of POSIX.
 */
#define _XOPEN_SOURCE 700 /* realpath() */

#include "port/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool epg_host_file_is_one(const char *path, bool *exists)
{
    struct stat found;
    *exists = stat(path, &found) == 0;
    return !*exists || S_ISREG(found.st_mode);
}

/** Closes `file`, if its contents and its place have reached the disk.  Returns 0 or the error number. */
static int sync_and_close(int file)
{
    const int synced = fsync(file) == 0 || errno == EINVAL ? 0 : errno;
    return close(file) == 0 || synced != 0 ? synced : errno;
}

int epg_host_file_write(const char *path, const void *data, size_t size)
{
    (void)unlink(path); /* of a run that was interrupted */
    const int file = open(path, O_WRONLY | O_CREAT | O_EXCL, 0666);
    if (file < 0) {
        return errno;
    }
    const ssize_t written = write(file, data, size);
    const int error = written < 0 ? errno : (size_t)written < size ? ENOSPC : 0;
    const int closed = sync_and_close(file);
    return error != 0 ? error : closed;
}

int epg_host_file_replace(const char *from, char *path)
{
    struct stat before;
    if (stat(path, &before) == 0) {
        (void)chmod(from, before.st_mode & 0777U);
    }
    if (rename(from, path) != 0) {
        return errno;
    }
    char *end = strrchr(path, '/');
    if (end == NULL) {
        return 0;
    }
    end[1] = '\0';
    const int folder = open(path, O_RDONLY); /* the new name is in the folder */
    return folder < 0 ? 0 : sync_and_close(folder);
}

int epg_host_file_resolve(const char *name, char *path, size_t size)
{
    struct stat found;
    char *real = realpath(name, NULL);
    if (real == NULL && lstat(name, &found) == 0) {
        return errno; /* a link that leads nowhere */
    }
    const int length = snprintf(path, size, "%s", real != NULL ? real : name);
    free(real);
    return length >= 0 && (size_t)length < size ? 0 : ENAMETOOLONG;
}
