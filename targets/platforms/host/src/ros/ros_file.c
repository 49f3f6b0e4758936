/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Reader of files of parameters, in the part of YAML that `ros2 param dump` and launch files write:
 *
 *     /robot_1/JIWY_node:
 *       ros__parameters:
 *         Pan:
 *           PID:
 *             kp: 2.5
 *         Tilt.PID.kp: 1.0   # the same with dots
 *
 * The keys above `ros__parameters` are the name of a node.  They may be nested, and may have wildcards.  Parameters of
 * other nodes are skipped, in whatever YAML they are written.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "ros_parameters.h"

enum { LINE_SIZE = 1024, DEPTH = 16, PATH_SIZE = 512, NO_LEVEL = -1 };

/** A mapping that is open at the present line. */
typedef struct level {
    size_t indent;   /* of the key */
    size_t children; /* indent of the keys in the mapping; 0: none yet */
    unsigned line;
    size_t length; /* of the joined keys above it */
} level_t;

typedef struct reader {
    const char *path; /* of the file */
    const char *node;
    unsigned line;
    int depth;
    level_t levels[DEPTH];
    char pattern[PATH_SIZE]; /* the keys above ros__parameters, joined by '/' */
    char prefix[PATH_SIZE];  /* the keys below it, joined by '.' */
    int parameters;          /* the level of ros__parameters; NO_LEVEL above it */
    bool for_all;            /* the name of the node has a wildcard */
    bool skips;              /* the lines that are indented deeper than `skipped` belong to another node */
    size_t skipped;
    bool good;
} reader_t;

/* The name of a node ------------------------------------------------------------------------------------------- */

/** Length of the part of a name at `text`, up to the next '/'. */
static size_t part(const char *text)
{
    return strcspn(text, "/");
}

bool epg_host_ros_is_node(const char *pattern, const char *node)
{
    pattern += strspn(pattern, "/");
    node += strspn(node, "/");
    if (*pattern == '\0' || *node == '\0') {
        return *node == '\0' && (*pattern == '\0' || strcmp(pattern, "**") == 0);
    }
    const size_t wanted = part(pattern);
    const size_t length = part(node);
    if (wanted == 2 && strncmp(pattern, "**", 2) == 0) {
        return epg_host_ros_is_node(pattern + 2, node) || epg_host_ros_is_node(pattern, node + length);
    }
    const bool any = wanted == 1 && *pattern == '*';
    return (any || (wanted == length && strncmp(pattern, node, length) == 0)) &&
           epg_host_ros_is_node(pattern + wanted, node + length);
}

/* Lines -------------------------------------------------------------------------------------------------------- */

/** Reports a line that cannot be read.  Always returns false, which ends the reading. */
static bool fail(reader_t *reader, unsigned line, const char *problem, const char *hint)
{
    fprintf(stderr, "%s:%u: error: %s\nhint: %s\n", reader->path, line, problem, hint);
    reader->good = false;
    return false;
}

static char *trim(char *text)
{
    text += strspn(text, " ");
    size_t length = strlen(text);
    while (length > 0 && strchr(" \t\r\n", text[length - 1]) != NULL) {
        length--;
    }
    text[length] = '\0';
    return text;
}

/** The text in the quotation marks at `text`; `*rest` is the text after them.  Returns NULL if they are not closed. */
static char *unquote(char *text, char **rest)
{
    char *end = strchr(text + 1, *text);
    if (end == NULL) {
        return NULL;
    }
    *end = '\0';
    *rest = end + 1;
    return text + 1;
}

static bool is_quote(char c)
{
    return c == '\'' || c == '"';
}

/** Splits "key: value".  Returns false if `text` does not have this form. */
static bool split(char *text, char **key, char **value)
{
    char *colon = text;
    *key = text;
    if (is_quote(*text)) {
        *key = unquote(text, &colon);
    } else {
        while (*colon != '\0' && !(*colon == ':' && (colon[1] == ' ' || colon[1] == '\0'))) {
            colon++;
        }
    }
    if (*key == NULL || *colon != ':') {
        return false;
    }
    *colon = '\0';
    *value = trim(colon + 1);
    return **key != '\0';
}

/** Removes the comment after `value`, or its quotation marks.  Returns NULL if they are not closed. */
static char *clean(char *value, bool *quoted)
{
    *quoted = is_quote(*value);
    if (*quoted) {
        char *rest = value;
        return unquote(value, &rest);
    }
    char *comment = *value == '#' ? value : strstr(value, " #");
    if (comment != NULL) {
        *comment = '\0';
    }
    return trim(value);
}

/* The mappings ------------------------------------------------------------------------------------------------- */

/** The joined keys of the present level. */
static char *keys(reader_t *reader)
{
    return reader->parameters == NO_LEVEL ? reader->pattern : reader->prefix;
}

/** Ends the mappings that a key with this indent does not belong to.  Returns false if one of them is empty. */
static bool close_levels(reader_t *reader, size_t indent)
{
    while (reader->depth > 0 && reader->levels[reader->depth - 1].indent >= indent) {
        const level_t *level = &reader->levels[--reader->depth];
        if (reader->depth == reader->parameters) {
            reader->parameters = NO_LEVEL;
        } else if (level->children == 0) {
            return fail(reader, level->line, "this key has no value", "write a number after it, or remove the line");
        } else {
            keys(reader)[level->length] = '\0';
        }
    }
    return true;
}

/** Ends the mappings that a line with this indent does not belong to.  Returns false after a message if it fits none. */
static bool take_indent(reader_t *reader, size_t indent)
{
    if (!close_levels(reader, indent)) {
        return false;
    }
    level_t *level = reader->depth > 0 ? &reader->levels[reader->depth - 1] : NULL;
    if (level != NULL && level->children == 0) {
        level->children = indent;
    }
    if (indent != (level != NULL ? level->children : 0)) {
        return fail(reader, reader->line, "this line is indented wrongly",
                    "indent the keys of a mapping by the same number of blanks");
    }
    return true;
}

/** Begins the mapping of `key`. */
static bool open_level(reader_t *reader, const char *key, size_t indent)
{
    char *joined = keys(reader);
    const size_t length = strlen(joined);
    const int room = (int)(PATH_SIZE - length);
    const char *separator = length == 0 ? "" : reader->parameters == NO_LEVEL ? "/" : ".";
    if (reader->depth == DEPTH || snprintf(joined + length, (size_t)room, "%s%s", separator, key) >= room) {
        return fail(reader, reader->line, "the keys are nested too deeply",
                    "write the name of the parameter with dots");
    }
    reader->levels[reader->depth++] = (level_t){.indent = indent, .line = reader->line, .length = length};
    return true;
}

/** Begins the parameters of a node, or skips them if it is another node. */
static bool open_parameters(reader_t *reader, size_t indent, const char *value)
{
    if (*value != '\0' && strcmp(value, "{}") != 0) {
        return fail(reader, reader->line, "'ros__parameters' must be a mapping",
                    "write each parameter into its own line below it, indented, as 'name: value'");
    }
    if (reader->depth == DEPTH) {
        return fail(reader, reader->line, "the keys are nested too deeply", "write the name of the node with slashes");
    }
    reader->for_all = strchr(reader->pattern, '*') != NULL;
    reader->skips = !epg_host_ros_is_node(reader->pattern, reader->node);
    reader->skipped = indent;
    reader->parameters = reader->depth;
    reader->prefix[0] = '\0';
    reader->levels[reader->depth++] = (level_t){.indent = indent, .line = reader->line};
    return true;
}

static void take_value(reader_t *reader, const char *key, const char *text, bool quoted)
{
    char name[PATH_SIZE + LINE_SIZE];
    char place[LINE_SIZE];
    snprintf(place, sizeof place, "%s:%u", reader->path, reader->line);
    snprintf(name, sizeof name, "%s%s%s", reader->prefix, reader->prefix[0] != '\0' ? "." : "", key);
    const epg_host_ros_value_t value = {
        .place = place, .name = name, .text = text, .quoted = quoted, .for_all = reader->for_all};
    reader->good = epg_host_ros_take_value(&value) && reader->good;
}

/** Takes the line "key: value", in the mapping of the present level. */
static bool take_pair(reader_t *reader, char *text, size_t indent)
{
    char *key;
    char *value;
    bool quoted = false;
    if (!split(text, &key, &value)) {
        return fail(reader, reader->line, "this line must have the form 'key: value'",
                    "a file of parameters is nested mappings: 'ros2 param dump' writes one");
    }
    value = clean(value, &quoted);
    if (value == NULL) {
        return fail(reader, reader->line, "the quotation marks of this value are not closed", "close them");
    }
    const bool empty = *value == '\0' && !quoted;
    if (reader->parameters == NO_LEVEL && strcmp(key, "ros__parameters") == 0) {
        return open_parameters(reader, indent, value);
    }
    if (empty) {
        return open_level(reader, key, indent);
    }
    if (reader->parameters == NO_LEVEL) {
        return fail(reader, reader->line, "a value must be below 'ros__parameters'",
                    "write '/**:', below it '  ros__parameters:', and below that the parameters");
    }
    take_value(reader, key, value, quoted);
    return true;
}

/** Handles one line.  Returns false after a message if the rest cannot be read. */
static bool take_line(reader_t *reader, char *line)
{
    const size_t indent = strspn(line, " ");
    char *text = trim(line);
    if (*text == '\0' || *text == '#' || strcmp(text, "---") == 0) {
        return true;
    }
    if (reader->skips && indent > reader->skipped) {
        return true;
    }
    reader->skips = false;
    if (*text == '\t') {
        return fail(reader, reader->line, "this line is indented by a tab", "YAML indents by blanks: replace the tab");
    }
    if (text[0] == '-' && reader->for_all && reader->depth > reader->parameters + 1) {
        reader->levels[reader->depth - 1].children = indent + 1;
        return true; /* an element of a list, which is a parameter of another node */
    }
    if (strchr("-{[&*!|>%@`", text[0]) != NULL) {
        return fail(reader, reader->line, "this form of YAML is not supported",
                    "a parameter of the model is a number: write 'name: value'");
    }
    return take_indent(reader, indent) && take_pair(reader, text, indent);
}

/* Files -------------------------------------------------------------------------------------------------------- */

static void read_lines(reader_t *reader, FILE *file)
{
    static const char mark[] = "\xEF\xBB\xBF"; /* the byte order mark of some editors */
    char line[LINE_SIZE];
    while (fgets(line, sizeof line, file) != NULL) {
        const bool marked = reader->line++ == 0 && strncmp(line, mark, sizeof mark - 1) == 0;
        if (strlen(line) == sizeof line - 1 && line[sizeof line - 2] != '\n') {
            (void)fail(reader, reader->line, "this line is too long", "a line can have 1022 characters");
            return;
        }
        if (!take_line(reader, marked ? line + sizeof mark - 1 : line)) {
            return;
        }
    }
    if (ferror(file)) {
        fprintf(stderr, "%s: error: cannot read the file of parameters: %s\n", reader->path, strerror(errno));
        reader->good = false;
        return;
    }
    (void)close_levels(reader, 0);
}

bool epg_host_ros_read_file(const char *path, const char *node)
{
    reader_t reader = {.path = path, .node = node, .parameters = NO_LEVEL, .good = true};
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        fprintf(stderr, "%s: error: cannot read the file of parameters: %s\n", path, strerror(errno));
        return false;
    }
    read_lines(&reader, file);
    fclose(file);
    return reader.good;
}
