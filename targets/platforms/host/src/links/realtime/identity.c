/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The identity of a program, by which an agent distinguishes it from all other programs.
 */
#include <stdio.h>
#include <string.h>

#include "computer.h"

#include "epg/host_log.h"
#include "epg/names.h"
#include "epg/node.h"
#include "epg/port.h"
#include "links/blake2s.h"
#include "links/services.h"

enum { HASH_SIZE = 16 };

/** Adds a text with its end, so that "a", "bc" and "ab", "c" give different hashes. */
static void add_text(epg_host_blake2s_t *hash, const char *text)
{
    epg_host_blake2s_add(hash, text, strlen(text) + 1);
}

static void write_hex(epg_host_blake2s_t *hash, char *text)
{
    unsigned char bytes[HASH_SIZE];
    epg_host_blake2s_end(hash, bytes);
    for (size_t i = 0; i < sizeof bytes; i++) {
        (void)snprintf(text + 2 * i, 3, "%02x", bytes[i]);
    }
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
    const char *const *words = epg_host_computer_words();
    for (size_t i = 0; words[i] != NULL; i++) {
        add_text(&hash, words[i]);
    }
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
    if (!epg_host_computer_reserve(session)) {
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
