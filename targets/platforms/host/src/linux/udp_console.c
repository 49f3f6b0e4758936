/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The console by UDP: the address that uses the target, and its datagrams.
 */
#define _POSIX_C_SOURCE 200809L

#include "../udp_console.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "../clock.h"
#include "epg/control.h"
#include "udp_peer.h"
#include "udp_session.h"

enum {
    PACKETS = 64,      /* datagrams that are taken at once */
    LONGEST = 2048,    /* bytes of a datagram; a longer one is ignored */
    LINE = 300,        /* bytes of a person's datagram: a command has at most 256 characters */
    OTHERS = 4,        /* users of `disable` that wait for their answer */
    ENDED = 8,         /* sessions that must not begin again */
    SILENCE_MS = 2000, /* a user that is silent for this time leaves the target to another one, */
    PERSON_MS = 60000, /* and a person after this time in any case */
    ANSWER_MS = 1000,  /* a `disable` that had no effect for this time is not answered */
    MS = 1000 * 1000   /* ns */
};

typedef enum user { NOBODY, PROGRAM, PERSON } user_t;

/** A `disable` of an address that does not use the target. */
typedef struct other {
    bool waiting;
    epg_host_peer_t peer;
    bool person;
    uint32_t session;
    bool has_cycles;
    uint32_t cycles; /**< number of control cycles at its arrival */
    uint64_t since_ns;
} other_t;

struct epg_host_udp_console {
    epg_stream_t stream;
    int file;
    epg_control_t *control;
    user_t user;
    bool parting;         /**< a connection has ended, and the middleware does not know it yet */
    epg_host_peer_t peer; /**< address of the user */
    uint64_t heard_ns;
    epg_host_udp_session_t session;
    uint32_t ended[ENDED];
    size_t ended_next;
    other_t others[OTHERS];

    epg_host_peer_t sender; /**< of the packet */
    unsigned char packet[LONGEST];
    size_t packet_length;
    bool packet_waits; /**< the packet must be taken after the end of the last connection */
};

static epg_host_udp_console_t console;

/* Sending ------------------------------------------------------------------------------------------------------ */

static bool send_to(const epg_host_peer_t *peer, const void *data, size_t size)
{
    return epg_host_peer_send(console.file, peer, data, size);
}

static bool send_to_user(void *context, const unsigned char *data, size_t size)
{
    const epg_host_udp_console_t *self = context;
    return send_to(&self->peer, data, size);
}

static void send_flags(const epg_host_peer_t *peer, uint8_t flags, uint32_t session, const char *text)
{
    unsigned char data[EPG_HOST_UDP_HEADER + EPG_HOST_PEER_NAME];
    const epg_host_udp_header_t header = {.flags = flags, .session = session};
    const size_t length = strnlen(text, EPG_HOST_PEER_NAME);
    epg_host_udp_write_header(data, &header);
    memcpy(data + EPG_HOST_UDP_HEADER, text, length);
    (void)send_to(peer, data, EPG_HOST_UDP_HEADER + length);
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
    if (length > 0 && send_to(&console.peer, session->once, length)) {
        session->once_length -= length;
        memmove(session->once, session->once + length, session->once_length);
    }
}

/** Tells the sender which address uses the target. */
static void send_taken(bool person, uint32_t session)
{
    char name[EPG_HOST_PEER_NAME];
    epg_host_peer_name(&console.peer, name);
    if (person) {
        char line[EPG_HOST_PEER_NAME + 64];
        const int length = snprintf(line, sizeof line, "error line %s has this target: only disable acts\r\n", name);
        (void)send_to(&console.sender, line, (size_t)length);
    } else {
        send_flags(&console.sender, EPG_HOST_UDP_TAKEN, session, name);
    }
}

/* Users -------------------------------------------------------------------------------------------------------- */

static void begin(user_t user, uint32_t session, uint64_t now_ns)
{
    console.user = user;
    console.peer = console.sender;
    console.heard_ns = now_ns;
    epg_host_udp_session_begin(&console.session, session);
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

/**
 * True if the sender of the packet can become the user.  If the middleware must notice the end of the last connection
 * first, the packet waits.
 */
static bool is_free(uint64_t now_ns)
{
    end_if_silent(now_ns, true);
    console.packet_waits = console.user == NOBODY && console.parting;
    return console.user == NOBODY && !console.parting;
}

/* Disabling ---------------------------------------------------------------------------------------------------- */

/** Answers the sender's `disable` later, when it has acted. */
static void answer_later(bool person, uint32_t session, uint64_t now_ns)
{
    other_t *chosen = NULL;
    for (size_t i = 0; i < OTHERS; i++) {
        other_t *other = &console.others[i];
        if (other->waiting && other->session == session && epg_host_peer_equal(&other->peer, &console.sender)) {
            return; /* it was repeated */
        }
        chosen = other->waiting ? chosen : other;
    }
    if (chosen != NULL) {
        epg_status_t status;
        *chosen = (other_t){
            .waiting = true, .peer = console.sender, .person = person, .session = session, .since_ns = now_ns};
        chosen->has_cycles = epg_control_observe(console.control, &status);
        chosen->cycles = chosen->has_cycles ? status.statistics.cycles : 0U;
    }
}

static void answer_others(uint64_t now_ns)
{
    for (size_t i = 0; i < OTHERS; i++) {
        other_t *other = &console.others[i];
        epg_status_t status;
        if (!other->waiting) {
            continue;
        }
        if (epg_control_observe(console.control, &status) && !status.enabled &&
            (!other->has_cycles || status.statistics.cycles - other->cycles >= 2U)) {
            static const char line[] = "ok disable\r\n";
            if (other->person) {
                (void)send_to(&other->peer, line, sizeof line - 1);
            } else {
                send_flags(&other->peer, EPG_HOST_UDP_DISABLED, other->session, "");
            }
            other->waiting = false;
        } else if (now_ns - other->since_ns > (uint64_t)ANSWER_MS * MS) {
            other->waiting = false;
        }
    }
}

/* Datagrams ---------------------------------------------------------------------------------------------------- */

static void take_of_program(const epg_host_udp_header_t *header, uint64_t now_ns)
{
    const unsigned char *body = console.packet + EPG_HOST_UDP_HEADER;
    const size_t size = console.packet_length - EPG_HOST_UDP_HEADER;
    const bool disables = (header->flags & EPG_HOST_UDP_DISABLE) != 0;
    bool own = console.user == PROGRAM && header->session == console.session.id &&
               epg_host_peer_equal(&console.sender, &console.peer);
    if (disables && !(own && epg_host_udp_session_is_old(&console.session, header->number))) {
        epg_control_request(console.control, false);
    }
    if (!own && (header->flags & EPG_HOST_UDP_BEGIN) != 0 && !has_ended(header->session) && is_free(now_ns)) {
        begin(PROGRAM, header->session, now_ns);
        own = true;
    }
    if (own) {
        console.heard_ns = now_ns;
        epg_host_udp_session_take(&console.session, header, body, size);
        if ((header->flags & EPG_HOST_UDP_END) != 0) {
            end();
        }
    } else if (disables) {
        answer_later(false, header->session, now_ns);
    } else if (console.user != NOBODY && (header->flags & EPG_HOST_UDP_BEGIN) != 0 && !has_ended(header->session)) {
        send_taken(false, header->session);
    } else if (!console.packet_waits && (header->flags & EPG_HOST_UDP_END) == 0) {
        send_flags(&console.sender, EPG_HOST_UDP_OVER, header->session, "");
    }
}

/** True if the packet consists of lines of text, of which at least one is not empty. */
static bool is_text(void)
{
    bool empty = true;
    for (size_t i = 0; i < console.packet_length; i++) {
        const unsigned char byte = console.packet[i];
        if ((byte < ' ' && byte != '\t' && byte != '\r' && byte != '\n') || byte > '~') {
            return false;
        }
        empty = empty && byte <= ' ';
    }
    const unsigned char last = console.packet_length > 0 ? console.packet[console.packet_length - 1] : 0;
    return !empty && console.packet_length <= LINE && (last == '\n' || last == '\r');
}

/** True if a line of the packet has the first word `disable`. */
static bool has_disable(void)
{
    static const char word[] = "disable";
    const char *text = (const char *)console.packet;
    size_t left = console.packet_length;
    while (left > 0) {
        if (left >= sizeof word && memcmp(text, word, sizeof word - 1) == 0 && text[sizeof word - 1] <= ' ') {
            return true;
        }
        /* The next line, or the next character after a blank at the start of this one. */
        const size_t skipped = *text == ' ' || *text == '\t' ? 1 : strcspn(text, "\r\n") + 1;
        text += skipped;
        left -= skipped;
    }
    return false;
}

static void take_of_person(uint64_t now_ns)
{
    const bool disables = has_disable();
    if (disables) {
        epg_control_request(console.control, false);
    }
    bool own = console.user == PERSON && epg_host_peer_equal(&console.sender, &console.peer);
    if (!own && is_free(now_ns)) {
        begin(PERSON, 0, now_ns);
        own = true;
    }
    if (own) {
        console.heard_ns = now_ns;
        (void)epg_host_udp_session_put(&console.session, console.packet, console.packet_length);
    } else if (disables && !console.packet_waits) {
        answer_later(true, 0, now_ns);
    } else if (console.user != NOBODY) {
        send_taken(true, 0);
    }
}

/** Receives a datagram, or takes the one that waits.  Returns false if there is none. */
static bool receive(void)
{
    if (console.packet_waits) {
        console.packet_waits = false;
        return true;
    }
    const ssize_t count = epg_host_peer_receive(console.file, &console.sender, console.packet, LONGEST - 1);
    console.packet_length = count > 0 && count < LONGEST ? (size_t)count : 0;
    console.packet[console.packet_length] = 0;
    return count >= 0;
}

static bool connected(void *context)
{
    (void)context;
    const uint64_t now_ns = epg_host_monotonic_ns();
    bool more = receive();
    for (int i = 1; more; i++) {
        epg_host_udp_header_t header;
        if (epg_host_udp_read_header(console.packet, console.packet_length, &header)) {
            take_of_program(&header, now_ns);
        } else if (is_text()) {
            take_of_person(now_ns);
        }
        more = i < PACKETS && !console.packet_waits && receive();
    }
    end_if_silent(now_ns, false);
    answer_others(now_ns);
    if (console.user == PROGRAM) {
        epg_host_udp_session_poll(&console.session, now_ns);
    } else if (console.user == PERSON) {
        send_text();
    }
    const bool uses = console.user != NOBODY && !console.parting;
    console.parting = false;
    return uses;
}

static size_t read_bytes(void *context, void *data, size_t size)
{
    (void)context;
    return console.user == NOBODY ? 0 : epg_host_udp_session_read(&console.session, data, size);
}

static size_t write_bytes(void *context, const void *data, size_t size)
{
    (void)context;
    if (console.user == PROGRAM) {
        const size_t count = epg_host_udp_session_write(&console.session, data, size);
        epg_host_udp_session_poll(&console.session, epg_host_monotonic_ns());
        return count;
    }
    if (console.user == NOBODY) {
        return size;
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

epg_host_udp_console_t *epg_host_udp_console_open(const char *address, const epg_target_t *target)
{
    memset(&console, 0, sizeof console);
    console.stream = (epg_stream_t){
        .connected = connected, .read = read_bytes, .write = write_bytes, .writable = writable, .context = &console};
    console.session.send = send_to_user;
    console.session.context = &console;
    console.control = target->control;
    console.file = epg_host_peer_listen(address);
    if (console.file < 0) {
        return NULL;
    }
    epg_host_peer_print(console.file, target->application->name);
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
        send_flags(&self->peer, EPG_HOST_UDP_OVER, self->session.id, "");
    }
    close(self->file);
}
