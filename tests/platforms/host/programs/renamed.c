/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Prints the full names of a node, of its topics and of its service, one per line, for the arguments of a command line.
 */
#include <stdio.h>

#include "epg/node.h"
#include "epg/store.h"
#include "port/store.h"
#include "ros/ros.h"

static unsigned char store_bytes[EPG_STORE_SIZE(0)];
static epg_store_t store = {.bytes = store_bytes};
static epg_application_t application = {.name = "arm"};
static const epg_topic_t topics[] = {{.name = "~"}, {.name = "pan"}, {.name = "~/enable"}, {.name = "/diagnostics"}};
static epg_node_t node;

static bool send(size_t publication, const void *data, size_t size)
{
    (void)publication;
    (void)data;
    (void)size;
    return false;
}

int main(int argc, char **argv)
{
    epg_target_t target = {
        .application = &application, .node = "arm_node", .name_space = "/robot_$serial", .store = &store};
    epg_host_ros_t ros = {.given = false};
    int i = 1;
    epg_host_store_open("names.store");
    if (!epg_host_ros_take(&ros, argc, argv, &i) || !epg_host_ros_prepare(&ros, &target)) {
        return 2;
    }
    epg_node_start(&node, &target, send);
    for (size_t k = 0; k < sizeof topics / sizeof topics[0]; k++) {
        char name[EPG_NODE_TOPIC_SIZE];
        printf("%s\n", epg_node_topic(&node, &topics[k], name, sizeof name) > 0 ? name : "too long");
    }
    char service[EPG_NODE_TOPIC_SIZE];
    printf("%s\n", epg_node_name(&node, "~/enable", true, service, sizeof service) > 0 ? service : "too long");
    return 0;
}
