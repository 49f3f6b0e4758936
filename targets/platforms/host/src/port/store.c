/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The port layer's store: a file.
 */
#if !defined(_WIN32)
#define _XOPEN_SOURCE 700 /* realpath() */
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

#include "store.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "epg/port.h"

static const char *store_path;

void epg_host_store_open(const char *path)
{
    store_path = path;
}

static const char *because(int error)
{
    static char text[128];
    snprintf(text, sizeof text, "the file of --store cannot be written: %s", strerror(error));
    return text;
}

#if defined(_WIN32)

static bool is_file(const char *path, bool *exists)
{
    FILE *file = fopen(path, "rb");
    *exists = file != NULL;
    if (file != NULL) {
        fclose(file);
    }
    return true;
}

/** Writes the file `path`.  Returns 0 or the error number. */
static int write_file(const char *path, const void *data, size_t size)
{
    FILE *file = fopen(path, "wb");
    if (file == NULL) {
        return errno;
    }
    errno = 0;
    const bool written = fwrite(data, 1, size, file) == size;
    return fclose(file) == 0 && written ? 0 : errno != 0 ? errno : EIO;
}

/** Replaces the file `path` by the file `from`.  Returns 0 or the error number. */
static int replace(const char *from, const char *path)
{
    remove(path); /* rename() does not replace a file there */
    return rename(from, path) == 0 ? 0 : errno;
}

#else

/** Returns true unless `path` is something other than a file, such as a device or a folder. */
static bool is_file(const char *path, bool *exists)
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

/** Writes the new file `path` to the disk.  Returns 0 or the error number. */
static int write_file(const char *path, const void *data, size_t size)
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

/** Replaces the file `path` by the file `from`, with its permissions.  Returns 0 or the error number. */
static int replace(const char *from, char *path)
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

#endif

size_t epg_port_store_read(void *data, size_t size)
{
    bool exists;
    FILE *file = store_path == NULL || !is_file(store_path, &exists) ? NULL : fopen(store_path, "rb");
    if (file == NULL) {
        return 0;
    }
    const size_t length = fread(data, 1, size, file);
    fclose(file);
    return length;
}

/** Copies the path of the file to `path`; that of the file to which it leads, if it is a link.  Returns an error number. */
static int resolve(char *path, size_t size)
{
#if !defined(_WIN32)
    struct stat found;
    char *real = realpath(store_path, NULL);
    if (real == NULL && lstat(store_path, &found) == 0) {
        return errno; /* a link that leads nowhere */
    }
    const int length = snprintf(path, size, "%s", real != NULL ? real : store_path);
    free(real);
#else
    const int length = snprintf(path, size, "%s", store_path);
#endif
    return length >= 0 && (size_t)length < size ? 0 : ENAMETOOLONG;
}

/**
 * Writes a second file, and renames it when it is on the disk.  After an interruption, either the old or the new file
 * exists.
 */
const char *epg_port_store_write(const void *data, size_t size)
{
    enum { LONGEST = 4096 };
    char path[LONGEST];
    char fresh[LONGEST + sizeof ".new"];
    bool exists;
    if (store_path == NULL) {
        return "this program was started without --store FILE";
    }
    if (!is_file(store_path, &exists)) {
        return "the path of --store is not a file, but a folder or a device";
    }
    int error = resolve(path, sizeof path);
    if (error != 0) {
        return because(error);
    }
    snprintf(fresh, sizeof fresh, "%s.new", path);
    error = write_file(fresh, data, size);
    if (error == 0) {
        error = replace(fresh, path);
    }
    if (error != 0) {
        (void)remove(fresh);
        return because(error);
    }
    return NULL;
}

void epg_host_store_tell(const epg_store_t *store)
{
    bool exists;
    if (store_path == NULL || store == NULL) {
        return;
    }
    if (!is_file(store_path, &exists)) {
        fprintf(stderr, "%s: warning: this is not a file, but a folder or a device: nothing can be stored\n",
                store_path);
        return;
    }
    if (store->parameters == NULL) {
        return;
    }
    const char *all = NULL;
    switch (store->parameters->stored) {
    case EPG_STORED_DAMAGED:
        all = "the stored parameters are damaged";
        break;
    case EPG_STORED_FOR_OTHER:
        all = "the stored parameters are those of another model";
        break;
    case EPG_STORED_NOTHING: /* an empty file, or one that cannot be read */
        all = exists ? "there are no stored parameters in this file" : NULL;
        break;
    default:
        break;
    }
    if (all != NULL) {
        fprintf(stderr, "%s: warning: %s: all have their generated values, and 'save' replaces the file\n", store_path,
                all);
    }
    for (size_t i = 0; epg_store_refused(store, i) != NULL; i++) {
        fprintf(stderr, "%s: warning: the stored value of %s is outside of its limits: it has its generated value\n",
                store_path, epg_store_refused(store, i));
    }
}
