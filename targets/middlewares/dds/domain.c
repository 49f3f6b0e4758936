/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The DDS domain and the discovery of other nodes, from the environment variables of ROS 2.
 *
 * Source: rmw_cyclonedds_cpp 2.2 (ROS 2 Jazzy), rmw_node.cpp, check_create_domain(); rcl 9.2, discovery_options.c.
 */
#if defined(__linux__)
#define _POSIX_C_SOURCE 200809L
#endif

#include "domain.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if defined(__linux__)
#include <unistd.h>
#endif

#include "dds/features.h"
#include "epg/target.h"

enum { DOMAIN_LARGEST = 232 }; /* higher domains would have ports above 65535: RTPS 2.5, 9.6.2 */

typedef struct text {
    char *data;
    size_t size;
    size_t length;
    bool failed; /* the text did not fit */
} text_t;

static void add_bytes(text_t *text, const char *bytes, size_t count)
{
    text->failed = text->failed || count >= text->size - text->length;
    if (!text->failed) {
        memcpy(text->data + text->length, bytes, count);
        text->length += count;
        text->data[text->length] = '\0';
    }
}

static void add(text_t *text, const char *more)
{
    add_bytes(text, more, strlen(more));
}

/** Returns an environment variable; "" if it is not set. */
static const char *variable(const char *name)
{
    const char *value = getenv(name);
    return value == NULL ? "" : value;
}

bool epg_dds_domain(uint8_t configured, uint32_t *domain)
{
    const char *text = variable("ROS_DOMAIN_ID");
    if (configured != EPG_DOMAIN_DEFAULT) {
        *domain = configured;
        return true;
    }
    char *end;
    errno = 0;
    const unsigned long value = strtoul(text, &end, 10);
    if (text[0] != '\0' && (!isdigit((unsigned char)text[0]) || *end != '\0' || errno != 0 || value > DOMAIN_LARGEST)) {
        fprintf(stderr, "error: ROS_DOMAIN_ID is '%s'\nhint: a domain must be a whole number from 0 to %d\n", text,
                DOMAIN_LARGEST);
        return false;
    }
    *domain = (uint32_t)value;
    return true;
}

/** Returns true if `text` consists of the characters of addresses.  None of them has a meaning in XML. */
static bool is_address(const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if (!isalnum((unsigned char)text[i]) && strchr(".:-_%[]", text[i]) == NULL) {
            return false;
        }
    }
    return length > 0;
}

static void add_peer(text_t *text, const char *address, size_t length)
{
    add(text, "<Peer address=\"");
    add_bytes(text, address, length);
    add(text, "\"/>");
}

/** Adds the addresses in ROS_STATIC_PEERS, which are separated by semicolons. */
static bool add_peers(text_t *text, const char *peers)
{
    while (*peers != '\0') {
        const size_t length = strcspn(peers, ";");
        if (length > 0 && !is_address(peers, length)) {
            fprintf(
                stderr,
                "error: ROS_STATIC_PEERS contains '%.*s'\nhint: it must be a list of addresses with ';' between them\n",
                (int)length, peers);
            return false;
        }
        if (length > 0) {
            add_peer(text, peers, length);
        }
        peers += length + (peers[length] == ';' ? 1U : 0U);
    }
    return true;
}

/** Switches discovery off: the tag is unique, and participants find only others with the same tag. */
static void add_discovery_off(text_t *text)
{
    char tag[64];
#if defined(__linux__)
    const long process = (long)getpid();
#else
    const long process = 0;
#endif
    snprintf(tag, sizeof tag, "<Tag>ros_discovery_off_%ld</Tag>", process);
    add(text, "<General><AllowMulticast>false</AllowMulticast></General>"
              "<Discovery><ParticipantIndex>none</ParticipantIndex>");
    add(text, tag);
    add(text, "</Discovery>");
}

static bool add_discovery(text_t *text, bool localhost, const char *peers)
{
    if (localhost) {
        add(text, "<General><AllowMulticast>false</AllowMulticast></General>");
    }
    add(text, "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
              "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex><Peers>");
    if (localhost) {
        add(text, "<Peer address=\"localhost\"/>");
    }
    const bool good = add_peers(text, peers);
    add(text, "</Peers></Discovery>");
    return good;
}

/** Adds the part of the configuration that ROS 2 puts before CYCLONEDDS_URI. */
static bool add_range(text_t *text)
{
    const char *range = variable("ROS_AUTOMATIC_DISCOVERY_RANGE");
    const bool localhost_only = strcmp(variable("ROS_LOCALHOST_ONLY"), "1") == 0;
    if (strcmp(range, "SYSTEM_DEFAULT") == 0 && !localhost_only) {
        return true;
    }
    bool good = true;
    add(text, "<CycloneDDS><Domain>");
    if (localhost_only) { /* this deprecated variable still has priority, and peers are ignored then */
        good = add_discovery(text, true, "");
    } else if (strcmp(range, "OFF") == 0) {
        add_discovery_off(text);
    } else if (strcmp(range, "LOCALHOST") == 0) {
        good = add_discovery(text, true, variable("ROS_STATIC_PEERS"));
    } else if (range[0] == '\0' || strcmp(range, "SUBNET") == 0) {
        good = add_discovery(text, false, variable("ROS_STATIC_PEERS"));
    } else {
        fprintf(
            stderr,
            "error: ROS_AUTOMATIC_DISCOVERY_RANGE is '%s'\nhint: it must be SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT\n",
            range);
        good = false;
    }
    add(text, "</Domain></CycloneDDS>,");
    return good;
}

bool epg_dds_configuration(char *data, size_t size)
{
    text_t text = {.data = data, .size = size};
    data[0] = '\0';
    if (!add_range(&text)) {
        return false;
    }
    add(&text, variable("CYCLONEDDS_URI"));
#ifdef DDS_HAS_SHM
    /* Messages without a described type (message.h) cannot use shared memory. */
    add(&text, ",<CycloneDDS><Domain><SharedMemory><Enable>false</Enable></SharedMemory></Domain></CycloneDDS>");
#endif
    if (text.failed) {
        fputs("error: CYCLONEDDS_URI or ROS_STATIC_PEERS is too long\nhint: CYCLONEDDS_URI can name a file\n", stderr);
    }
    return !text.failed;
}
