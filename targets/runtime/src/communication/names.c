/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The name and the namespace of a node.
 */
#include "epg/names.h"

#include <string.h>

#include "epg/port.h"
#include "epg/store.h"

static const char serial_word[] = "$serial";

/**
 * Appends `count` characters of `text` to the `*length` characters of `name`.  Returns false if not all of them fit.
 */
static bool append(char *name, size_t size, size_t *length, const char *text, size_t count)
{
    const size_t room = size - 1 - *length;
    const bool fits = count <= room;
    const size_t taken = fits ? count : room;
    memcpy(name + *length, text, taken);
    *length += taken;
    return fits;
}

bool epg_names_expand(const char *pattern, char *name, size_t size)
{
    size_t length = 0;
    bool fits = true;
    while (*pattern != '\0') {
        if (strncmp(pattern, serial_word, sizeof serial_word - 1) == 0) {
            const char *serial = epg_port_serial();
            fits = append(name, size, &length, serial, strlen(serial)) && fits;
            pattern += sizeof serial_word - 1;
        } else {
            fits = append(name, size, &length, pattern, 1) && fits;
            pattern++;
        }
    }
    name[length] = '\0';
    return fits;
}

static bool is_letter(char c)
{
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/** Returns the length of the part of a name at the start of `text`; 0 if there is none. */
static size_t part(const char *text)
{
    size_t length = 0;
    while (is_letter(text[length]) || (length > 0 && is_digit(text[length])) ||
           (length > 0 && strncmp(text + length, serial_word, sizeof serial_word - 1) == 0)) {
        length += text[length] == '$' ? sizeof serial_word - 1 : 1;
    }
    return length;
}

/** Returns true if `text` is short enough, both as it is written and with the serial number. */
static bool has_room(const char *text)
{
    char name[EPG_STORE_NAME_SIZE];
    return strlen(text) < EPG_STORE_NAME_SIZE && epg_names_expand(text, name, sizeof name);
}

bool epg_names_is_node(const char *text)
{
    const size_t length = part(text);
    return length > 0 && text[length] == '\0' && has_room(text);
}

/** Returns true if there are two underscores in a row in `text`, which names of ROS 2 must not have. */
static bool has_double_underscore(const char *text)
{
    for (; *text != '\0'; text++) {
        if (text[0] == '_' && text[1] == '_') {
            return true;
        }
    }
    return false;
}

bool epg_names_is_space(const char *text)
{
    if (strcmp(text, "/") == 0) {
        return true;
    }
    const char *rest = text;
    size_t length = 0;
    while (*rest == '/') {
        length = part(rest + 1);
        if (length == 0) {
            return false;
        }
        rest += 1 + length;
    }
    return *rest == '\0' && length > 0 && !has_double_underscore(text) && has_room(text);
}

const char *epg_names_node(const epg_target_t *target)
{
    if (target->given_node != NULL) {
        return target->given_node;
    }
    return target->store != NULL && target->store->node[0] != '\0' ? target->store->node : target->node;
}

const char *epg_names_space(const epg_target_t *target)
{
    const char *stored = target->store != NULL ? target->store->name_space : "";
    if (target->given_space != NULL) {
        return target->given_space;
    }
    if (stored[0] == '\0') {
        return target->name_space;
    }
    return strcmp(stored, "/") == 0 ? "" : stored;
}

/** Copies `text`, which must fit, to `name`; clears `name` if `text` equals the generated name. */
static void keep(char *name, const char *text, const char *generated)
{
    const size_t size = strlen(text) + 1;
    if (strcmp(text, generated) == 0) {
        name[0] = '\0';
    } else {
        memcpy(name, text, size);
    }
}

bool epg_names_set_node(const epg_target_t *target, const char *text)
{
    const bool good = target->store != NULL && epg_names_is_node(text);
    if (good) {
        keep(target->store->node, text, target->node);
    }
    return good;
}

bool epg_names_set_space(const epg_target_t *target, const char *text)
{
    const bool good = target->store != NULL && epg_names_is_space(text);
    if (good) {
        keep(target->store->name_space, text, target->name_space[0] == '\0' ? "/" : target->name_space);
    }
    return good;
}
