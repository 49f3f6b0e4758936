/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The connection of the console to a program by UDP.
 */
#include "udp_session.h"

#include <string.h>

enum {
    MS = 1000 * 1000,
    RESEND_NS = 40 * MS,        /* lines are sent again after this time, */
    PATIENCE_NS = 200 * MS,     /* and later after up to this time */
    HOLD_NS = 5 * MS,           /* rows wait for others to fill their datagram for up to this time */
    TYPE_AT = 2,                /* place of the message's type in a frame: after the zero byte and the first code */
    SMALLEST_FRAME = 1 + 6 + 1, /* a type and its CRC in COBS, between zero bytes */
    BITS = 32
};

static const unsigned char magic[] = {0x01, 'E', 'P', 'G'};

/* Headers ------------------------------------------------------------------------------------------------------ */

static uint32_t get_number(const unsigned char *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8U | (uint32_t)bytes[2] << 16U | (uint32_t)bytes[3] << 24U;
}

static void put_number(unsigned char *bytes, uint32_t number)
{
    for (unsigned int i = 0; i < 4; i++) {
        bytes[i] = (unsigned char)(number >> 8U * i);
    }
}

bool epg_host_udp_read_header(const unsigned char *data, size_t size, epg_host_udp_header_t *header)
{
    if (size < EPG_HOST_UDP_HEADER || memcmp(data, magic, sizeof magic) != 0) {
        return false;
    }
    *header = (epg_host_udp_header_t){
        .flags = data[4],
        .session = get_number(data + 5),
        .number = get_number(data + 9),
        .received = get_number(data + 13),
        .more = get_number(data + 17),
    };
    return true;
}

void epg_host_udp_write_header(unsigned char *data, const epg_host_udp_header_t *header)
{
    memcpy(data, magic, sizeof magic);
    data[4] = header->flags;
    put_number(data + 5, header->session);
    put_number(data + 9, header->number);
    put_number(data + 13, header->received);
    put_number(data + 17, header->more);
}

/* To the console ----------------------------------------------------------------------------------------------- */

void epg_host_udp_session_begin(epg_host_udp_session_t *session, uint32_t id)
{
    session->id = id;
    session->confirm = false;
    session->newest = 0;
    session->seen = 0;
    session->lowest = 0;
    session->input_length = 0;
    session->scan = (epg_console_scan_t){0};
    session->before_stop = 0; /* `overtaken` stays: the console can still have bytes of the last session */
    session->frame_length = 0;
    session->frame_whole = false;
    session->lines_length = 0;
    session->first_line = 0;
    session->next_line = 0;
    session->sent_length = 0;
    session->sent_line = 0;
    session->patience_ns = RESEND_NS;
    session->once_length = 0;
    session->once_urgent = false;
    session->once_number = 1;
}

bool epg_host_udp_session_is_old(const epg_host_udp_session_t *session, uint32_t number)
{
    if (number < session->lowest) {
        return true;
    }
    if (number >= session->newest) {
        return number == session->newest;
    }
    const uint32_t before = session->newest - number;
    return before > BITS || (session->seen >> (before - 1U) & 1U) != 0;
}

static void mark_as_seen(epg_host_udp_session_t *session, uint32_t number)
{
    if (number < session->newest) {
        session->seen |= 1U << (session->newest - number - 1U);
        return;
    }
    const uint32_t step = number - session->newest;
    const uint32_t before = step < BITS ? session->seen << step : 0U;
    session->seen = step <= BITS ? before | 1U << (step - 1U) : 0U;
    session->newest = number;
}

/** Drops the lines before the one with the number `next`, which the program waits for. */
static void confirm_lines(epg_host_udp_session_t *session, uint32_t next)
{
    const uint32_t count = next - session->first_line;
    if (count == 0 || count > session->next_line - session->first_line) {
        return;
    }
    size_t length = 0;
    for (uint32_t i = 0; i < count; i++) {
        const unsigned char *frame = session->lines + length;
        const unsigned char *end = memchr(frame + 1, 0, session->lines_length - length - 1);
        length += (size_t)(end - frame) + 1;
    }
    memmove(session->lines, session->lines + length, session->lines_length - length);
    session->lines_length -= length;
    session->first_line = next;
    const bool sent = session->sent_length > length;
    session->sent_length = sent ? session->sent_length - length : 0;
    session->sent_line = sent ? session->sent_line : next;
    session->patience_ns = RESEND_NS;
}

/** Remembers a stop: `position` bytes of the input arrived before it, or belong to it. */
static void mark_stop(epg_host_udp_session_t *session, size_t position)
{
    session->before_stop = position;
    session->overtaken = true;
}

void epg_host_udp_session_stop(epg_host_udp_session_t *session)
{
    mark_stop(session, session->input_length);
}

bool epg_host_udp_session_end_frame(epg_host_udp_session_t *session)
{
    const bool stop = session->scan.frame.open && epg_console_scan_end_frame(&session->scan);
    if (stop) {
        epg_host_udp_session_stop(session);
    }
    return stop;
}

epg_console_found_t epg_host_udp_session_take(epg_host_udp_session_t *session, const epg_host_udp_header_t *header,
                                              const unsigned char *body, size_t size)
{
    epg_console_found_t found = EPG_CONSOLE_FOUND_NOTHING;
    confirm_lines(session, header->received);
    if (header->more > session->lowest) {
        session->lowest = header->more;
    }
    if (header->number == 0 || !epg_host_udp_session_is_old(session, header->number)) {
        bool fits;
        found = epg_host_udp_session_put(session, body, size, &fits);
        if (found == EPG_CONSOLE_FOUND_NOTHING && (header->flags & EPG_HOST_UDP_DISABLE) != 0) {
            found = EPG_CONSOLE_FOUND_FRAME;
            epg_host_udp_session_stop(session);
        }
        if (fits && header->number != 0) {
            mark_as_seen(session, header->number);
        }
    }
    session->confirm = session->confirm || size > 0 || (header->flags & EPG_HOST_UDP_BEGIN) != 0;
    return found;
}

epg_console_found_t epg_host_udp_session_put(epg_host_udp_session_t *session, const unsigned char *data, size_t size,
                                             bool *fits)
{
    epg_console_found_t found = EPG_CONSOLE_FOUND_NOTHING;
    epg_console_scan_t scan = session->scan;
    const size_t before = session->input_length;
    *fits = size <= sizeof session->input - before;
    for (size_t i = 0; i < size; i++) {
        const epg_console_found_t one = epg_console_scan(&scan, data[i]);
        if (one != EPG_CONSOLE_FOUND_NOTHING) {
            found = one;
            mark_stop(session, *fits ? before + i + 1 : before);
        }
    }
    if (*fits) {
        memcpy(session->input + before, data, size);
        session->input_length += size;
        session->scan = scan;
    }
    return found;
}

size_t epg_host_udp_session_read(epg_host_udp_session_t *session, void *data, size_t size)
{
    const bool before = session->before_stop > 0;
    const size_t most = before ? session->before_stop : session->input_length;
    const size_t count = size < most ? size : most;
    if (count == 0) {
        return 0; /* the bytes that were read last are the same */
    }
    memcpy(data, session->input, count);
    session->input_length -= count;
    memmove(session->input, session->input + count, session->input_length);
    session->before_stop -= before ? count : 0;
    session->overtaken = before;
    return count;
}

/* From the console --------------------------------------------------------------------------------------------- */

static bool send_datagram(epg_host_udp_session_t *session, uint8_t flags, uint32_t number, const unsigned char *body,
                          size_t size)
{
    unsigned char data[EPG_HOST_UDP_HEADER + EPG_HOST_UDP_FRAME];
    const epg_host_udp_header_t header = {
        .flags = flags, .session = session->id, .number = number, .received = session->newest, .more = session->seen};
    epg_host_udp_write_header(data, &header);
    memcpy(data + EPG_HOST_UDP_HEADER, body, size);
    if (!session->send(session->context, data, EPG_HOST_UDP_HEADER + size)) {
        return false;
    }
    session->confirm = false;
    return true;
}

/** Sends the lines that were not sent, as many as possible in each datagram. */
static void send_lines(epg_host_udp_session_t *session, uint64_t now_ns)
{
    while (session->sent_length < session->lines_length) {
        const unsigned char *begin = session->lines + session->sent_length;
        const size_t left = session->lines_length - session->sent_length;
        size_t length = 0;
        uint32_t count = 0;
        while (length < left) {
            const unsigned char *end = memchr(begin + length + 1, 0, left - length - 1);
            const size_t with_next = (size_t)(end - begin) + 1;
            if (count > 0 && with_next > EPG_HOST_UDP_DATAGRAM - EPG_HOST_UDP_HEADER) {
                break;
            }
            length = with_next;
            count++;
        }
        if (!send_datagram(session, EPG_HOST_UDP_RUNNING, session->sent_line, begin, length)) {
            return;
        }
        session->sent_length += length;
        session->sent_line += count;
        session->resend_ns = now_ns + session->patience_ns;
    }
}

static void send_once(epg_host_udp_session_t *session)
{
    if (session->once_length > 0 && send_datagram(session, EPG_HOST_UDP_RUNNING | EPG_HOST_UDP_ONCE,
                                                  session->once_number, session->once, session->once_length)) {
        session->once_number++;
        session->once_length = 0;
        session->once_urgent = false;
    }
}

void epg_host_udp_session_poll(epg_host_udp_session_t *session, uint64_t now_ns)
{
    if (session->once_length > 0 && session->once_ns == 0) {
        session->once_ns = now_ns;
    }
    if (session->once_urgent || (session->once_length > 0 && now_ns - session->once_ns >= HOLD_NS)) {
        send_once(session);
    }
    if (session->sent_length > 0 && now_ns >= session->resend_ns) {
        session->sent_length = 0;
        session->sent_line = session->first_line;
        session->patience_ns = session->patience_ns < PATIENCE_NS / 2 ? 2 * session->patience_ns : PATIENCE_NS;
    }
    send_lines(session, now_ns);
    if (session->confirm) {
        (void)send_datagram(session, EPG_HOST_UDP_RUNNING, session->next_line, session->lines, 0);
    }
}

/** Keeps the complete frame for a datagram.  Returns false if there is no room. */
static bool keep_frame(epg_host_udp_session_t *session)
{
    const size_t length = session->frame_length;
    if (session->frame[TYPE_AT] == 'A') {
        if (length > sizeof session->lines - session->lines_length) {
            return false;
        }
        memcpy(session->lines + session->lines_length, session->frame, length);
        session->lines_length += length;
        session->next_line++;
    } else if (length <= sizeof session->once) {
        if (length > sizeof session->once - session->once_length) {
            send_once(session);
        }
        if (length > sizeof session->once - session->once_length) {
            return false;
        }
        session->once_ns = session->once_length == 0 ? 0 : session->once_ns;
        memcpy(session->once + session->once_length, session->frame, length);
        session->once_length += length;
        const bool rows = session->frame[TYPE_AT] == 'D' || session->frame[TYPE_AT] == 'E';
        session->once_urgent = session->once_urgent || !rows;
    }
    session->frame_whole = false;
    session->frame_length = 0;
    return true;
}

/** Takes a byte of a frame.  Text is left out: it is from the time before the first frame. */
static void take_byte(epg_host_udp_session_t *session, unsigned char byte)
{
    if (session->frame_length == 0 && byte != 0) {
        return;
    }
    if (byte == 0 && session->frame_length > 0) {
        session->frame_whole =
            session->frame_length + 1 >= SMALLEST_FRAME && session->frame_length < EPG_HOST_UDP_FRAME;
        if (!session->frame_whole) {
            session->frame_length = session->frame_length == 1 ? 1 : 0; /* the second zero byte can begin a frame */
            return;
        }
    }
    if (session->frame_length < EPG_HOST_UDP_FRAME) {
        session->frame[session->frame_length++] = byte;
    }
}

size_t epg_host_udp_session_write(epg_host_udp_session_t *session, const unsigned char *data, size_t size)
{
    size_t done = 0;
    while (done < size && (!session->frame_whole || keep_frame(session))) {
        take_byte(session, data[done++]);
    }
    if (session->frame_whole) {
        (void)keep_frame(session);
    }
    return done;
}
