/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Datagrams of the console that prove that their sender has the key.  They are not encrypted: who can read the network
 * can read the values, but cannot move the robot.
 *
 * A sealed datagram is an ordinary one after a head: four fixed bytes, a number that the program chose at random, one
 * that the target chose, a counter, and a tag.  All datagrams with the same two numbers have the same key, which is
 * derived from the console's key.  The tag is the keyed BLAKE2s of the direction, the counter and the datagram.  So a
 * datagram of another connection, of an earlier start of the program, of the other direction, or with a changed bit is
 * noticed; the counter shows one that was sent a second time.
 *
 * docs/live-protocol.md defines the bytes.  epg/live/udp_seal.py is the other side.
 */
#ifndef EPG_HOST_UDP_SEAL_H
#define EPG_HOST_UDP_SEAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    EPG_HOST_UDP_KEY = 16,                                   /**< bytes of the console's key */
    EPG_HOST_UDP_KEY_TEXT = 40,                              /**< its text, with the final 0 */
    EPG_HOST_UDP_NONCE = 16,                                 /**< bytes of a number that is chosen at random */
    EPG_HOST_UDP_SEAL = 4 + 2 * EPG_HOST_UDP_NONCE + 8 + 16, /**< bytes of the head of a sealed datagram */
    EPG_HOST_UDP_SESSION_KEY = 32
};

/** The direction of a datagram. */
typedef enum epg_host_udp_direction {
    EPG_HOST_UDP_TO_TARGET = 'P',
    EPG_HOST_UDP_FROM_TARGET = 'T',
} epg_host_udp_direction_t;

/** The key of a connection, and the counters that have arrived. */
typedef struct epg_host_udp_seal {
    unsigned char nonces[2 * EPG_HOST_UDP_NONCE]; /**< that of the program, then that of the target */
    unsigned char key[EPG_HOST_UDP_SESSION_KEY];
    uint64_t newest; /**< newest counter that has arrived */
    uint64_t seen;   /**< the 64 before it, as bits; the lowest bit is the newest */
} epg_host_udp_seal_t;

/** Reads a key: 32 hexadecimal digits, with '-' and blanks between them.  Returns false if it has another form. */
bool epg_host_udp_key_read(const char *text, unsigned char key[EPG_HOST_UDP_KEY]);

/** Writes a key as text, in groups of four digits. */
void epg_host_udp_key_write(const unsigned char key[EPG_HOST_UDP_KEY], char text[EPG_HOST_UDP_KEY_TEXT]);

/** Returns true if the datagram has the form of a sealed one. */
bool epg_host_udp_is_sealed(const unsigned char *data, size_t size);

/** Returns the number in the head of a sealed datagram that the program has chosen. */
const unsigned char *epg_host_udp_seal_of_program(const unsigned char *data);

/** Returns the number in the head of a sealed datagram that the target has chosen; all 0: the program has none yet. */
const unsigned char *epg_host_udp_seal_of_target(const unsigned char *data);

/** Derives the key of the connection with these two numbers from the console's key. */
void epg_host_udp_seal_derive(epg_host_udp_seal_t *seal, const unsigned char key[EPG_HOST_UDP_KEY],
                              const unsigned char program[EPG_HOST_UDP_NONCE],
                              const unsigned char target[EPG_HOST_UDP_NONCE]);

/** Returns true if the head of a sealed datagram has the numbers of this connection. */
bool epg_host_udp_seal_is_of(const epg_host_udp_seal_t *seal, const unsigned char *data);

/** Returns true if the tag of a sealed datagram is right, so that its sender has the key. */
bool epg_host_udp_seal_proves(const epg_host_udp_seal_t *seal, epg_host_udp_direction_t direction,
                              const unsigned char *data, size_t size);

/** Takes the counter of a datagram whose tag is right.  Returns false if it has arrived already, or is too old. */
bool epg_host_udp_seal_accept(epg_host_udp_seal_t *seal, const unsigned char *data);

/** Writes the head before a datagram of `size` bytes, which begins at `data` + EPG_HOST_UDP_SEAL. */
void epg_host_udp_seal_write(const epg_host_udp_seal_t *seal, epg_host_udp_direction_t direction, uint64_t counter,
                             unsigned char *data, size_t size);

#endif
