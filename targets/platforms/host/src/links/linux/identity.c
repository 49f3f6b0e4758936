/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The identity of a program, by which an agent distinguishes it from all other programs.
 */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "epg/host_log.h"
#include "epg/names.h"
#include "epg/node.h"
#include "epg/port.h"
#include "links/blake2s.h"
#include "links/services.h"

enum { TEXT_SIZE = 512, HASH_SIZE = 16 };

/** Adds a text with its end, so that "a", "bc" and "ab", "c" give different hashes. */
static void add_text(epg_host_blake2s_t *hash, const char *text)
{
    epg_host_blake2s_add(hash, text, strlen(text) + 1);
}

/** Adds the computer and the file of this program: the same after each start. */
static void add_program(epg_host_blake2s_t *hash)
{
    char text[TEXT_SIZE] = "";
    FILE *file = fopen("/etc/machine-id", "r");
    if (file != NULL) {
        text[fread(text, 1, sizeof text - 1, file)] = '\0';
        (void)fclose(file);
    }
    add_text(hash, text);
    memset(text, 0, sizeof text); /* the name, too: containers of one image can have one machine-id */
    add_text(hash, gethostname(text, sizeof text - 1) == 0 ? text : "");
    memset(text, 0, sizeof text);
    add_text(hash, readlink("/proc/self/exe", text, sizeof text - 1) > 0 ? text : "");
}

static void write_hex(epg_host_blake2s_t *hash, char *text)
{
    unsigned char bytes[HASH_SIZE];
    epg_host_blake2s_end(hash, bytes);
    for (size_t i = 0; i < sizeof bytes; i++) {
        (void)snprintf(text + 2 * i, 3, "%02x", bytes[i]);
    }
}

/**
 * Reserves a name on this computer until this program ends.  Returns false if another program has it.  The system frees
 * the name of a program that was killed: it is that of a socket that is not in the file system.
 */
static bool reserve(const char *name)
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

/** Says which commands do not work with this namespace. */
static void check_namespace(const epg_host_services_t *services, const char *name_space, const char *node)
{
    const char *rest = name_space[0] == '/' ? strchr(name_space + 1, '/') : NULL;
    if (services->target->middleware->one_part && rest != NULL) {
        fprintf(stderr,
                "%s: 'ros2 node info' does not find this node: an agent takes '%.*s' for its namespace and '%s/%s' for "
                "its name; topics, services and parameters work\n",
                services->target->application->name, (int)(rest - name_space), name_space, rest + 1, node);
    }
}

int epg_host_services_identify(const epg_host_services_t *services)
{
    static char program[2 * HASH_SIZE + 1];
    if (services->link == NULL) {
        return DONE;
    }
    epg_host_blake2s_t hash;
    epg_host_blake2s_begin(&hash, HASH_SIZE, NULL, 0);
    add_program(&hash);
    write_hex(&hash, program);
    services->target->node_state->program = program;

    char node[EPG_NODE_NAME_SIZE];
    char name_space[EPG_NODE_SPACE_SIZE];
    (void)epg_names_expand(epg_names_node(services->target), node, sizeof node);
    (void)epg_names_expand(epg_names_space(services->target), name_space, sizeof name_space);
    char session[2 * HASH_SIZE + 1];
    const char *const parts[] = {program, epg_port_serial(), name_space, node, services->agent};
    epg_host_blake2s_begin(&hash, HASH_SIZE, NULL, 0);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        add_text(&hash, parts[i]);
    }
    write_hex(&hash, session);
    if (!reserve(session)) {
        fprintf(stderr,
                "error: this program already runs, as the node %s/%s of the agent at %s\n"
                "hint: a second copy needs another name, for example --ros-args -r __ns:=/robot_2\n",
                name_space, node, services->agent);
        return FAILED;
    }
    if (services->agent != NULL && epg_host_logs(EPG_HOST_LOG_WARN)) {
        check_namespace(services, name_space, node);
    }
    return DONE;
}
