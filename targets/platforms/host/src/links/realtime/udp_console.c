/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The console by UDP: the address that uses the target, and its datagrams.
 */
#define _POSIX_C_SOURCE 200809L

#include "links/udp_console.h"

#include <stdio.h>
#include <string.h>

#include "epg/control.h"
#include "port/clock.h"
#include "udp_key.h"
#include "udp_peer.h"
#include "udp_seal.h"
#include "udp_session.h"

enum {
    PACKETS = 256,     /* datagrams that are taken in one poll */
    ANSWERS = 16,      /* answers in one poll to others than the user; those to a stop are not counted */
    LONGEST = 2048,    /* bytes of a datagram; a longer one is ignored */
    LINE = 300,        /* bytes of a person's datagram: a command has at most 256 characters */
    ENDED = 8,         /* sessions that must not begin again */
    SILENCE_MS = 2000, /* a user that is silent for this time leaves the target to another one, */
    PERSON_MS = 60000, /* and a person after this time in any case */
    HELD_MS = 20,      /* an open frame in which no byte arrives for this time will not become whole */
    MS = 1000 * 1000   /* ns */
};

typedef enum user { NOBODY, PROGRAM, PERSON } user_t;

/** The datagram that was received last. */
typedef struct packet {
    epg_host_peer_t sender;
    unsigned char data[LONGEST];
    size_t length;
    bool sealed;              /**< it has the form of a sealed one */
    bool proven;              /**< its sender has the key, or needs none */
    epg_host_udp_seal_t seal; /**< of a sealed one */
    epg_host_udp_header_t header;
    const unsigned char *body; /**< the bytes behind the header */
    size_t body_size;
} packet_t;

struct epg_host_udp_console {
    epg_stream_t stream;
    int file;
    epg_control_t *control;
    user_t user;
    bool parting;         /**< a connection has ended in this poll, and the middleware must notice it */
    epg_host_peer_t peer; /**< address of the user */
    uint64_t heard_ns;
    uint64_t body_ns; /**< arrival of the newest bytes for the console */
    epg_host_udp_session_t session;
    uint32_t ended[ENDED];
    size_t ended_next;

    bool keyed; /**< only programs with the key may use the target */
    unsigned char key[EPG_HOST_UDP_KEY];
    unsigned char nonce[EPG_HOST_UDP_NONCE]; /**< the number with which the next session must begin */
    epg_host_udp_seal_t seal;                /**< of the user */
    uint64_t sent;                           /**< sealed datagrams that were sent, to all programs */

    packet_t packet;
    unsigned int answers; /**< in this poll */
};

static epg_host_udp_console_t console;
static packet_t *const packet = &console.packet;

/* Sending ------------------------------------------------------------------------------------------------------ */

static bool send_plain(const epg_host_peer_t *peer, const void *data, size_t size)
{
    return epg_host_peer_send(console.file, peer, data, size);
}

static bool send_sealed(const epg_host_peer_t *peer, const epg_host_udp_seal_t *seal, const void *data, size_t size)
{
    static unsigned char sealed[EPG_HOST_UDP_SEAL + EPG_HOST_UDP_HEADER + EPG_HOST_UDP_FRAME];
    memcpy(sealed + EPG_HOST_UDP_SEAL, data, size);
    console.sent++;
    epg_host_udp_seal_write(seal, EPG_HOST_UDP_FROM_TARGET, console.sent, sealed, size);
    return send_plain(peer, sealed, EPG_HOST_UDP_SEAL + size);
}

static bool send_to_user(void *context, const unsigned char *data, size_t size)
{
    const epg_host_udp_console_t *self = context;
    return self->keyed ? send_sealed(&self->peer, &self->seal, data, size) : send_plain(&self->peer, data, size);
}

/** Sends an answer, sealed if `seal` is not NULL. */
static void send_flags(const epg_host_peer_t *peer, const epg_host_udp_seal_t *seal, uint8_t flags, uint32_t session,
                       const char *text)
{
    unsigned char data[EPG_HOST_UDP_HEADER + EPG_HOST_PEER_NAME];
    const epg_host_udp_header_t header = {.flags = flags, .session = session};
    const size_t length = strnlen(text, EPG_HOST_PEER_NAME);
    epg_host_udp_write_header(data, &header);
    memcpy(data + EPG_HOST_UDP_HEADER, text, length);
    if (seal != NULL) {
        (void)send_sealed(peer, seal, data, EPG_HOST_UDP_HEADER + length);
    } else {
        (void)send_plain(peer, data, EPG_HOST_UDP_HEADER + length);
    }
}

/** Answers the program that has sent the packet. */
static void answer(uint8_t flags, const char *text)
{
    const bool seals = console.keyed && packet->sealed && flags != EPG_HOST_UDP_LOCKED;
    send_flags(&packet->sender, seals ? &packet->seal : NULL, flags, packet->header.session, text);
}

static void answer_line(const char *line)
{
    (void)send_plain(&packet->sender, line, strlen(line));
}

/** Returns true if one more answer may be sent in this poll.  A flood must not keep the console from receiving. */
static bool may_answer(void)
{
    console.answers++;
    return console.answers <= ANSWERS;
}

/** Sends the whole lines of text that wait for a person. */
static void send_text(void)
{
    epg_host_udp_session_t *session = &console.session;
    size_t length = session->once_length;
    while (length > 0 && session->once[length - 1] != '\n') {
        length--;
    }
    if (length == 0 && session->once_length == sizeof session->once) {
        length = session->once_length; /* a part of a very long line */
    }
    if (length > 0 && send_plain(&console.peer, session->once, length)) {
        session->once_length -= length;
        memmove(session->once, session->once + length, session->once_length);
    }
}

/* Users -------------------------------------------------------------------------------------------------------- */

static void begin(user_t user, uint32_t session, uint64_t now_ns)
{
    console.user = user;
    console.peer = packet->sender;
    console.heard_ns = now_ns;
    epg_host_udp_session_begin(&console.session, session);
    if (console.keyed) {
        console.seal = packet->seal;
        epg_host_udp_random(console.nonce, sizeof console.nonce);
    }
}

static void end(void)
{
    if (console.user == PROGRAM) {
        console.ended[console.ended_next] = console.session.id;
        console.ended_next = (console.ended_next + 1) % ENDED;
    }
    console.user = NOBODY;
    console.parting = true;
}

static bool has_ended(uint32_t session)
{
    for (size_t i = 0; i < ENDED; i++) {
        if (console.ended[i] == session) {
            return true;
        }
    }
    return false;
}

/** Ends the connection of a user that is silent.  `wanted` is true if another address wants to use the target. */
static void end_if_silent(uint64_t now_ns, bool wanted)
{
    const uint64_t longest_ms = console.user == PERSON && !wanted ? PERSON_MS : SILENCE_MS;
    if (console.user != NOBODY && now_ns - console.heard_ns > longest_ms * MS) {
        end();
    }
}

/** Returns true if the sender of the packet can become the user. */
static bool is_free(uint64_t now_ns)
{
    end_if_silent(now_ns, true);
    return console.user == NOBODY;
}

/* Stopping ----------------------------------------------------------------------------------------------------- */

/** Stops the target for a sender that does not use it. */
static void stop_for_other(void)
{
    epg_stop(console.control, EPG_STOP_OTHER);
    epg_host_udp_session_stop(&console.session);
}

static void stop_for_user(epg_console_found_t found)
{
    if (found != EPG_CONSOLE_FOUND_NOTHING) {
        epg_stop(console.control, found == EPG_CONSOLE_FOUND_FRAME ? EPG_STOP_FRAME : EPG_STOP_LINE);
    }
}

/**
 * Returns true if a line or a frame of these bytes is a stop.  The end of a datagram ends a line and a frame.  Only the
 * beginning of a long datagram is searched, so that a flood does not take long.
 */
static bool has_stop(const unsigned char *data, size_t size)
{
    epg_console_scan_t scan = {0};
    bool found = false;
    for (size_t i = 0; i < size && i < LINE; i++) {
        found = epg_console_scan(&scan, data[i]) != EPG_CONSOLE_FOUND_NOTHING || found;
    }
    found = epg_console_scan(&scan, '\n') != EPG_CONSOLE_FOUND_NOTHING || found;
    return epg_console_scan_end_frame(&scan) || found;
}

/* Datagrams of programs ---------------------------------------------------------------------------------------- */

/** Finds out whether the sender of the packet has the key. */
static void check_seal(void)
{
    packet->proven = packet->sealed == console.keyed;
    if (packet->sealed && console.keyed) {
        if (console.user == PROGRAM && epg_host_udp_seal_is_of(&console.seal, packet->data)) {
            packet->seal = console.seal;
        } else {
            epg_host_udp_seal_derive(&packet->seal, console.key, epg_host_udp_seal_of_program(packet->data),
                                     epg_host_udp_seal_of_target(packet->data));
        }
        packet->proven = epg_host_udp_seal_proves(&packet->seal, EPG_HOST_UDP_TO_TARGET, packet->data, packet->length);
    }
}

static bool is_of_user(void)
{
    return console.user == PROGRAM && packet->proven && packet->header.session == console.session.id &&
           epg_host_peer_equal(&packet->sender, &console.peer) &&
           (!console.keyed || epg_host_udp_seal_is_of(&console.seal, packet->data));
}

/** Returns true if the packet begins a session with the number that the target has chosen for the next one. */
static bool has_nonce(void)
{
    return !console.keyed ||
           memcmp(epg_host_udp_seal_of_target(packet->data), console.nonce, sizeof console.nonce) == 0;
}

static bool begins(void)
{
    return packet->proven && has_nonce() && (packet->header.flags & EPG_HOST_UDP_BEGIN) != 0 &&
           !has_ended(packet->header.session);
}

static void take_of_user(uint64_t now_ns)
{
    if (console.keyed && !epg_host_udp_seal_accept(&console.seal, packet->data)) {
        return; /* it was repeated by the network, or by somebody else */
    }
    console.heard_ns = now_ns;
    console.body_ns = packet->body_size > 0 ? now_ns : console.body_ns;
    stop_for_user(epg_host_udp_session_take(&console.session, &packet->header, packet->body, packet->body_size));
    if ((packet->header.flags & EPG_HOST_UDP_END) != 0) {
        end();
    }
}

/** Answers a datagram that stops nothing, of a program that does not use the target. */
static void answer_other(void)
{
    const uint8_t flags = packet->header.flags;
    if (!packet->proven) {
        if (console.keyed && (flags & EPG_HOST_UDP_BEGIN) != 0) {
            answer(EPG_HOST_UDP_LOCKED, "");
        }
    } else if ((flags & EPG_HOST_UDP_BEGIN) != 0 && !has_nonce()) {
        epg_host_udp_seal_derive(&packet->seal, console.key, packet->seal.nonces, console.nonce);
        answer(EPG_HOST_UDP_AGAIN, "");
    } else if (begins()) {
        char name[EPG_HOST_PEER_NAME];
        epg_host_peer_name(&console.peer, name);
        answer(EPG_HOST_UDP_TAKEN, name);
    } else if ((flags & EPG_HOST_UDP_END) == 0) {
        answer(EPG_HOST_UDP_OVER, "");
    }
}

static void take_of_program(uint64_t now_ns)
{
    check_seal();
    if (!is_of_user() && begins() && is_free(now_ns)) {
        begin(PROGRAM, packet->header.session, now_ns);
    }
    if (is_of_user()) {
        take_of_user(now_ns);
    } else if ((packet->header.flags & EPG_HOST_UDP_DISABLE) != 0 || has_stop(packet->body, packet->body_size)) {
        stop_for_other(); /* stopping needs neither the target nor the key */
        answer(EPG_HOST_UDP_DISABLED, "");
    } else if (may_answer()) {
        answer_other();
    }
}

/* Datagrams of persons ----------------------------------------------------------------------------------------- */

/** True if the packet consists of lines of text, of which at least one is not empty. */
static bool is_text(void)
{
    bool empty = true;
    for (size_t i = 0; i < packet->length; i++) {
        const unsigned char byte = packet->data[i];
        if ((byte < ' ' && byte != '\t' && byte != '\r' && byte != '\n') || byte > '~') {
            return false;
        }
        empty = empty && byte <= ' ';
    }
    const unsigned char last = packet->length > 0 ? packet->data[packet->length - 1] : 0;
    return !empty && packet->length <= LINE && (last == '\n' || last == '\r');
}

static void take_of_person(uint64_t now_ns)
{
    const bool text = is_text();
    const bool mine = console.user == PERSON && epg_host_peer_equal(&packet->sender, &console.peer);
    if (text && !mine && !console.keyed && is_free(now_ns)) {
        begin(PERSON, 0, now_ns);
    } else if (!text || !mine) {
        if (has_stop(packet->data, packet->length)) {
            stop_for_other();
            answer_line("ok disable\r\n");
        } else if (text && may_answer()) {
            char line[EPG_HOST_PEER_NAME + 64] = "error line this console needs a key: only disable acts\r\n";
            if (!console.keyed) {
                char name[EPG_HOST_PEER_NAME];
                epg_host_peer_name(&console.peer, name);
                (void)snprintf(line, sizeof line, "error line %s has this target: only disable acts\r\n", name);
            }
            answer_line(line);
        }
        return;
    }
    bool fits;
    console.heard_ns = now_ns;
    stop_for_user(epg_host_udp_session_put(&console.session, packet->data, packet->length, &fits));
}

/* The stream --------------------------------------------------------------------------------------------------- */

/** Receives a datagram.  Returns false if there is none. */
static bool receive(void)
{
    const long count = epg_host_peer_receive(console.file, &packet->sender, packet->data, LONGEST);
    packet->length = count > 0 && count <= LONGEST ? (size_t)count : 0;
    return count >= 0;
}

static void take(uint64_t now_ns)
{
    packet->sealed = epg_host_udp_is_sealed(packet->data, packet->length);
    const size_t head = packet->sealed ? EPG_HOST_UDP_SEAL : 0;
    if (epg_host_udp_read_header(packet->data + head, packet->length - head, &packet->header)) {
        packet->body = packet->data + head + EPG_HOST_UDP_HEADER;
        packet->body_size = packet->length - head - EPG_HOST_UDP_HEADER;
        take_of_program(now_ns);
    } else if (!packet->sealed) {
        take_of_person(now_ns);
    }
}

/** Takes all datagrams that wait, so that the stops among them act before the console takes the next command. */
static bool connected(void *context)
{
    (void)context;
    const uint64_t now_ns = epg_host_monotonic_ns();
    console.parting = false;
    console.answers = 0;
    for (int i = 0; i < PACKETS && receive(); i++) {
        take(now_ns);
    }
    end_if_silent(now_ns, false);
    if (console.user != NOBODY && now_ns - console.body_ns > (uint64_t)HELD_MS * MS &&
        epg_host_udp_session_end_frame(&console.session)) {
        epg_stop(console.control, EPG_STOP_LINE);
    }
    if (console.user == PROGRAM) {
        epg_host_udp_session_poll(&console.session, now_ns);
    } else if (console.user == PERSON) {
        send_text();
    }
    return console.user != NOBODY && !console.parting;
}

static size_t read_bytes(void *context, void *data, size_t size)
{
    (void)context;
    return console.user == NOBODY || console.parting ? 0 : epg_host_udp_session_read(&console.session, data, size);
}

static bool overtaken(void *context)
{
    (void)context;
    return console.session.overtaken;
}

static size_t write_bytes(void *context, const void *data, size_t size)
{
    (void)context;
    if (console.user == NOBODY || console.parting) {
        return size; /* it is for the last user */
    }
    if (console.user == PROGRAM) {
        const size_t count = epg_host_udp_session_write(&console.session, data, size);
        epg_host_udp_session_poll(&console.session, epg_host_monotonic_ns());
        return count;
    }
    const size_t room = sizeof console.session.once - console.session.once_length;
    const size_t count = size < room ? size : room;
    memcpy(console.session.once + console.session.once_length, data, count);
    console.session.once_length += count;
    send_text();
    return count;
}

static size_t writable(void *context)
{
    (void)context;
    return EPG_HOST_UDP_DATAGRAM;
}

/* Opening ------------------------------------------------------------------------------------------------------ */

/** Makes or reads the key, if the socket needs one.  Returns false after a message. */
static bool open_access(const epg_host_options_t *options)
{
    console.keyed = options->console_key != NULL || (!options->console_open && !epg_host_peer_is_local(console.file));
    epg_host_udp_random(console.nonce, sizeof console.nonce);
    if (options->console_key != NULL) {
        return epg_host_udp_key_load(options->console_key, console.key);
    }
    epg_host_udp_random(console.key, sizeof console.key);
    return true;
}

/** Prints the address, and who may use the target. */
static void print_access(const epg_host_options_t *options, const char *name)
{
    epg_host_peer_print(console.file, name);
    if (options->console_open) {
        fprintf(stderr, "%s: warning: %s can move the robot\n", name,
                epg_host_peer_is_local(console.file) ? "every program of this computer"
                                                     : "anyone who can send datagrams to this address");
    } else if (console.keyed && options->console_key == NULL) {
        char text[EPG_HOST_UDP_KEY_TEXT];
        epg_host_udp_key_write(console.key, text);
        fprintf(stderr, "%s: the key of the console, until this program ends: %s\n", name, text);
    }
}

epg_host_udp_console_t *epg_host_udp_console_open(const epg_host_options_t *options, const epg_target_t *target)
{
    memset(&console, 0, sizeof console);
    console.stream = (epg_stream_t){.connected = connected,
                                    .read = read_bytes,
                                    .write = write_bytes,
                                    .writable = writable,
                                    .overtaken = overtaken,
                                    .context = &console};
    console.session.send = send_to_user;
    console.session.context = &console;
    console.control = target->control;
    console.file = epg_host_peer_listen(options->console_udp);
    if (console.file < 0) {
        return NULL;
    }
    if (!open_access(options)) {
        epg_host_socket_close(console.file);
        return NULL;
    }
    print_access(options, target->application->name);
    return &console;
}

const epg_stream_t *epg_host_udp_console_stream(const epg_host_udp_console_t *self)
{
    return &self->stream;
}

int epg_host_udp_console_file(const epg_host_udp_console_t *self)
{
    return self->file;
}

void epg_host_udp_console_close(epg_host_udp_console_t *self)
{
    if (self->user == PROGRAM) {
        send_flags(&self->peer, self->keyed ? &self->seal : NULL, EPG_HOST_UDP_OVER, self->session.id, "");
    }
    epg_host_socket_close(self->file);
}
