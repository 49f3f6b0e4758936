/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The connection of the console to a program by UDP, whose datagrams can be lost, repeated and reordered.
 *
 * A datagram is a header and whole frames of the console (docs/live.md).  Each command of the program has a number, and
 * acts once.  Lines of answers have numbers, too; they are sent again until the program has them.  All other frames are
 * sent once: a row of a stream that is lost stays lost, and its number shows the gap.
 *
 * All datagrams that wait are taken before the console acts on one of them, and searched for stops.  The console must
 * know which bytes arrived before the newest stop, because they must not move the target any more.  So read() never
 * returns bytes from both sides of it in one call.
 */
#ifndef EPG_HOST_UDP_SESSION_H
#define EPG_HOST_UDP_SESSION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scan.h"

enum {
    EPG_HOST_UDP_HEADER = 21,     /**< bytes of a header */
    EPG_HOST_UDP_DATAGRAM = 1340, /**< bytes of a datagram with several frames: it fits into a packet of Ethernet, with
                                       the head of a sealed one (udp_seal.h) */
    EPG_HOST_UDP_INPUT = 4096,    /**< bytes that wait for the console */
    EPG_HOST_UDP_FRAME = 4096,    /**< bytes of the longest frame */
    EPG_HOST_UDP_LINES = 16384    /**< bytes of lines that the program has not confirmed */
};

/** Flags of a datagram to the target. */
enum {
    EPG_HOST_UDP_BEGIN = 1,  /**< the program wants to use the target, and has no answer yet */
    EPG_HOST_UDP_END = 2,    /**< the program does not use the target any more */
    EPG_HOST_UDP_DISABLE = 4 /**< disables the target, also while another program uses it */
};

/** Flags of a datagram from the target. */
enum {
    EPG_HOST_UDP_RUNNING = 1,  /**< the program uses the target; the datagram has frames */
    EPG_HOST_UDP_OVER = 2,     /**< the program does not use the target any more */
    EPG_HOST_UDP_DISABLED = 4, /**< the stop was taken: the answer to a program that does not use the target */
    EPG_HOST_UDP_TAKEN = 8,    /**< another address, which is the rest of the datagram, uses the target */
    EPG_HOST_UDP_ONCE = 16,    /**< the frames are sent once; without the flag, they are lines */
    EPG_HOST_UDP_AGAIN = 32,   /**< the program must begin with the number in the head of this sealed datagram */
    EPG_HOST_UDP_LOCKED = 64   /**< the console has a key, which the datagram was not sealed with */
};

/** The header of a datagram, after four fixed bytes. */
typedef struct epg_host_udp_header {
    uint8_t flags;
    uint32_t session;  /**< chosen by the program at random */
    uint32_t number;   /**< of the commands, of the first line, or of the frames that are sent once; 0: no commands */
    uint32_t received; /**< to the target: number of the next line; from it: newest number of commands */
    uint32_t more;     /**< to the target: commands with a lower number must not act any more;
                            from it: the 32 numbers before the newest one, as bits; the lowest bit is the newest */
} epg_host_udp_header_t;

/** Reads a header.  Returns false if the datagram does not begin with one. */
bool epg_host_udp_read_header(const unsigned char *data, size_t size, epg_host_udp_header_t *header);

void epg_host_udp_write_header(unsigned char *data, const epg_host_udp_header_t *header);

typedef struct epg_host_udp_session {
    /** Sends a datagram.  Returns false if it must be tried again later. */
    bool (*send)(void *context, const unsigned char *data, size_t size);
    void *context;
    uint32_t id;
    bool confirm; /**< the program waits for a datagram */

    uint32_t newest; /**< newest number of commands that have arrived */
    uint32_t seen;   /**< those before it, as in the header */
    uint32_t lowest; /**< commands with a lower number must not act any more */
    unsigned char input[EPG_HOST_UDP_INPUT];
    size_t input_length;
    epg_console_scan_t scan; /**< the search for stops in the input */
    size_t before_stop;      /**< bytes of the input that arrived before the newest stop */
    bool overtaken;          /**< a stop has arrived after the bytes that were read last */

    unsigned char frame[EPG_HOST_UDP_FRAME]; /**< frame of the console so far */
    size_t frame_length;
    bool frame_whole;

    unsigned char lines[EPG_HOST_UDP_LINES]; /**< frames of lines that are not confirmed */
    size_t lines_length;
    uint32_t first_line; /**< number of the first of them */
    uint32_t next_line;  /**< number of the next new one */
    size_t sent_length;  /**< bytes of them that were sent */
    uint32_t sent_line;  /**< number of the first one that was not sent */
    uint64_t resend_ns;
    uint64_t patience_ns;

    unsigned char once[EPG_HOST_UDP_DATAGRAM - EPG_HOST_UDP_HEADER]; /**< frames that are sent once */
    size_t once_length;
    bool once_urgent;
    uint64_t once_ns;     /**< arrival of the first of them */
    uint32_t once_number; /**< number of the next datagram with them */
} epg_host_udp_session_t;

/** Begins the session `id`. */
void epg_host_udp_session_begin(epg_host_udp_session_t *session, uint32_t id);

/** True if commands with this number have arrived already, or must not act any more. */
bool epg_host_udp_session_is_old(const epg_host_udp_session_t *session, uint32_t number);

/** Takes a datagram with this header.  Returns the kind of stop in it. */
epg_console_found_t epg_host_udp_session_take(epg_host_udp_session_t *session, const epg_host_udp_header_t *header,
                                              const unsigned char *body, size_t size);

/** Adds bytes for the console.  `*fits` is false if there is no room.  Returns the kind of stop in them, all the same. */
epg_console_found_t epg_host_udp_session_put(epg_host_udp_session_t *session, const unsigned char *data, size_t size,
                                             bool *fits);

/** Must be called when a stop has arrived that is not in the bytes of the session. */
void epg_host_udp_session_stop(epg_host_udp_session_t *session);

/** Ends an open frame in which no byte has arrived for a while.  Returns true if a line in it is a stop. */
bool epg_host_udp_session_end_frame(epg_host_udp_session_t *session);

/** Gives up to `size` bytes to the console; returns their number. */
size_t epg_host_udp_session_read(epg_host_udp_session_t *session, void *data, size_t size);

/** Takes bytes of the console; returns their number. */
size_t epg_host_udp_session_write(epg_host_udp_session_t *session, const unsigned char *data, size_t size);

/** Sends the datagrams that are due. */
void epg_host_udp_session_poll(epg_host_udp_session_t *session, uint64_t now_ns);

#endif
