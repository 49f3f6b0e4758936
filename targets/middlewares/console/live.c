/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Messages in frames, streams of signals, and enabling on a lease.
 */
#include <string.h>

#include "console.h"
#include "epg/port.h"
#include "session.h"

enum {
    SILENCE_MS = 2000, /* a program that sends no frame for this time is gone */
    BYTE_MS = 100,     /* a frame in which no byte arrives for this time has ended */
    LEASE_MS = 300,    /* a lease ends this time after the sending of the newest number that came back */
    NUMBER_MS = 50,    /* time between two numbers */
    FRAMES = 2,        /* frames of several rows per poll */
    LONG_FRAMES = 8,   /* frames of one row per poll */
    ROWS_SIZE = 216,   /* largest number of bytes of values in a frame of several rows */
    ROWS_OVERHEAD = 1 + 4 + 8 + EPG_CONSOLE_FRAME_CRC + 4, /* bytes of a frame of rows without the values */
    RESERVE = 256,                                         /* bytes of output that rows leave free for answers */
    EXACT = 0xFFFF, /* in the place of the first signal's index: the values are doubles */
    MS = 1000000    /* ns */
};

static uint32_t whole_number(const uint8_t *bytes, size_t count)
{
    uint32_t number = 0;
    for (size_t i = 0; i < count; i++) {
        number |= (uint32_t)bytes[i] << 8U * i;
    }
    return number;
}

/* Streams ------------------------------------------------------------------------------------------------------ */

/** Ends the stream, and gives its memory back to recordings. */
static void end_stream(epg_console_session_t *session)
{
    if (session->live.streaming) {
        session->live.streaming = false;
        epg_telemetry_stop(session->target->application->telemetry);
    }
}

/**
 * Returns the value with this index in the answer of `ports`: a signal, a value of loop or replay, the duty of an
 * actuator or the position of an encoder; NULL: there is none.
 */
static const double *value_at(const epg_target_t *target, size_t index)
{
    if (index < target->signal_count) {
        return target->signals[index].value;
    }
    index -= target->signal_count;
    if (index < EPG_LOOP_VALUES) {
        return &target->control->loop[index];
    }
    index -= EPG_LOOP_VALUES;
    if (index < EPG_REPLAY_VALUES) {
        return &target->control->replay[index];
    }
    index -= EPG_REPLAY_VALUES;
    const epg_jog_t *jog = target->application->jog;
    if (jog == NULL || index >= jog->actuator_count + jog->encoder_count) {
        return NULL;
    }
    return index >= jog->actuator_count || jog->actuators[index].applied != NULL ? &jog->values[index] : NULL;
}

/** A stream that a program asks for. */
typedef struct stream {
    epg_telemetry_request_t request;
    size_t value_size; /**< bytes of a value */
    size_t most;       /**< largest number of rows in a frame */
} stream_t;

/** Reads the message of a stream.  Reports a mistake and returns false. */
static bool read_stream(epg_console_session_t *session, const uint8_t *bytes, size_t length, stream_t *stream)
{
    const epg_target_t *target = session->target;
    epg_telemetry_request_t *request = &stream->request;
    const bool exact = length >= 6 && whole_number(&bytes[4], 2) == EXACT;
    const uint32_t every = length >= 4 ? whole_number(bytes, 4) : 0U;
    if (exact) {
        bytes += 2;
        length -= 2;
    }
    if (length < 6 || length % 2 != 0 || (length - 4) / 2 > EPG_TELEMETRY_SIGNALS || every == 0) {
        epg_console_error(session, "stream", "a stream has 1 to 32 signals, and a row in at least every cycle", NULL);
        return false;
    }
    request->every = every;
    request->columns = (length - 4) / 2;
    for (size_t i = 0; i < request->columns; i++) {
        request->signals[i] = value_at(target, whole_number(&bytes[4 + 2 * i], 2));
        if (request->signals[i] == NULL) {
            epg_console_error(session, "stream", "there is no signal with this index", NULL);
            return false;
        }
    }
    stream->value_size = exact ? sizeof(double) : sizeof(float);
    const size_t row_size = stream->value_size * request->columns;
    stream->most = row_size < ROWS_SIZE ? ROWS_SIZE / row_size : 1U;
    return true;
}

/** Bytes of output that must be free before a frame of rows is written. */
static size_t needed_room(size_t most, size_t row_size)
{
    return RESERVE + (size_t)ROWS_OVERHEAD + (most > 1U ? (size_t)ROWS_SIZE : row_size);
}

/** Returns true if the stream's bytes fit into 70 % of the transport's rate, else reports the mistake. */
static bool fits(epg_console_session_t *session, const stream_t *stream)
{
    const epg_telemetry_request_t *request = &stream->request;
    const size_t row_size = stream->value_size * request->columns;
    if (needed_room(stream->most, row_size) > session->options->output_size) {
        epg_console_error(session, "stream", "a row is too long for the target's output of answers", NULL);
        return false;
    }
    const uint64_t rate = session->options->transport_rate;
    const uint64_t row_ns = request->every * session->target->application->period_ns;
    const uint64_t frame = ROWS_OVERHEAD + stream->most * row_size;
    const uint64_t bytes = frame * 1000000000U / (stream->most * row_ns);
    if (rate == 0 || bytes <= rate / 10U * 7U) {
        return true;
    }
    epg_console_begin(&session->output, "error stream needs ");
    epg_console_integer(&session->output, (int64_t)bytes);
    epg_console_text(&session->output, " bytes per second of ");
    epg_console_integer(&session->output, (int64_t)(rate / 10U * 7U));
    epg_console_text(&session->output, " that the transport has for streams");
    epg_console_end_or_drop(&session->output);
    return false;
}

static void start_stream(epg_console_session_t *session, const uint8_t *bytes, size_t length)
{
    const epg_application_t *application = session->target->application;
    epg_telemetry_t *telemetry = application->telemetry;
    stream_t stream;
    const epg_telemetry_request_t *request = &stream.request;
    if (telemetry != NULL && length == 0) {
        end_stream(session);
        epg_console_wait_for(session, "stream", EPG_CONSOLE_ENDING_STREAM);
        return;
    }
    if (telemetry == NULL) {
        epg_console_error(session, "stream", "this target has no memory for streams", NULL);
    } else if (!epg_telemetry_idle(telemetry)) {
        epg_console_error(session, "stream", "a stream runs: end it first", NULL);
    } else if (read_stream(session, bytes, length, &stream) && fits(session, &stream)) {
        size_t room;
        double *memory = epg_capture_lend(application->capture, &room);
        if (memory == NULL || epg_telemetry_depth(request->columns, room) == 0) {
            epg_console_error(session, "stream", "a recording has the memory: end it first", NULL);
            return;
        }
        session->live.streaming = epg_telemetry_start(telemetry, request, memory, room);
        session->live.columns = request->columns;
        session->live.value_size = stream.value_size;
        session->live.most = stream.most;
        session->live.row_ns = request->every * application->period_ns;
        epg_console_ok(session, "stream");
        epg_console_count(&session->output, "rows", epg_telemetry_depth(request->columns, room));
        epg_console_end_or_drop(&session->output);
    }
}

static void put_value(epg_console_output_t *output, double value, bool exact)
{
    if (exact) {
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        epg_console_whole_number(output, bits, sizeof bits);
    } else {
        const float rounded = (float)value;
        uint32_t bits;
        memcpy(&bits, &rounded, sizeof bits);
        epg_console_whole_number(output, bits, sizeof bits);
    }
}

/** Sends one frame of rows whose ticks follow each other.  Returns false if there is none, or no room. */
static bool send_rows(epg_console_session_t *session)
{
    epg_telemetry_t *telemetry = session->target->application->telemetry;
    epg_console_output_t *output = &session->output;
    const epg_console_live_t *live = &session->live;
    const bool exact = live->value_size == sizeof(double);
    epg_telemetry_row_t row;
    if (epg_console_output_room(output) < needed_room(live->most, live->value_size * live->columns) ||
        !epg_telemetry_row(telemetry, &row)) {
        return false;
    }
    uint64_t number = row.number;
    uint64_t tick_ns = row.tick_ns;
    epg_console_begin_frame(output, exact ? EPG_CONSOLE_EXACT_ROWS : EPG_CONSOLE_ROWS);
    epg_console_whole_number(output, number, 4);
    epg_console_whole_number(output, tick_ns, 8);
    for (size_t rows = 0; rows < live->most && row.number == number && row.tick_ns == tick_ns; rows++) {
        for (size_t i = 0; i < live->columns; i++) {
            put_value(output, row.values[i], exact);
        }
        epg_telemetry_drop(telemetry);
        if (!epg_telemetry_row(telemetry, &row)) {
            break;
        }
        number++;
        tick_ns += live->row_ns;
    }
    epg_console_end_or_drop(output);
    return true;
}

static void poll_stream(epg_console_session_t *session)
{
    const epg_application_t *application = session->target->application;
    if (application->telemetry == NULL) {
        return;
    }
    const int frames = session->live.most > 1U ? FRAMES : LONG_FRAMES;
    for (int i = 0; i < frames && session->live.streaming && send_rows(session); i++) {
    }
    if (!session->live.streaming && epg_telemetry_idle(application->telemetry)) {
        epg_capture_take_back(application->capture);
    }
}

/* Leases ------------------------------------------------------------------------------------------------------- */

void epg_console_begin_lease(epg_console_session_t *session)
{
    session->live.leased = true;
    memset(session->live.sent_ns, 0, sizeof session->live.sent_ns);
    session->live.number_ns = session->now_ns;
    epg_control_extend(session->target->control, session->now_ns + (uint64_t)LEASE_MS * MS);
}

/** Returns the time LEASE_MS after the sending of `number`; 0: it has passed, or the number was not sent. */
static uint64_t end_of(const epg_console_session_t *session, uint32_t number)
{
    const epg_console_live_t *live = &session->live;
    const uint64_t sent_ns = live->sent_ns[number % EPG_CONSOLE_NUMBERS];
    const uint64_t until_ns = sent_ns + (uint64_t)LEASE_MS * MS;
    const bool counts = sent_ns != 0U && live->number - number < EPG_CONSOLE_NUMBERS && session->now_ns < until_ns;
    return counts ? until_ns : 0U;
}

/** Extends the lease, if `number` was sent less than LEASE_MS ago. */
static void take_response(epg_console_session_t *session, uint32_t number)
{
    epg_console_live_t *live = &session->live;
    const uint64_t until_ns = end_of(session, number);
    const bool newer = (int32_t)(number - live->returned) > 0; /* a network can repeat and reorder numbers */
    if (live->leased && newer && until_ns != 0U) {
        live->returned = number;
        epg_control_extend(session->target->control, until_ns);
    }
}

uint64_t epg_console_may_move_until(epg_console_session_t *session, uint32_t number)
{
    session->live.moved_ns = session->now_ns + (uint64_t)LEASE_MS * MS;
    return end_of(session, number);
}

static void poll_lease(epg_console_session_t *session)
{
    epg_console_live_t *live = &session->live;
    if (session->has_status && !session->status.enabled && session->wait == EPG_CONSOLE_READY) {
        live->leased = false;
    }
    if ((!live->leased && session->now_ns >= live->moved_ns) || session->now_ns < live->number_ns) {
        return;
    }
    epg_console_begin_frame(&session->output, EPG_CONSOLE_NUMBER);
    epg_console_whole_number(&session->output, live->number + 1U, 4);
    if (epg_console_end(&session->output)) {
        live->number++;
        live->sent_ns[live->number % EPG_CONSOLE_NUMBERS] = session->now_ns;
        live->number_ns = session->now_ns + (uint64_t)NUMBER_MS * MS;
    }
}

/* Messages ----------------------------------------------------------------------------------------------------- */

static void take_message(epg_console_session_t *session)
{
    epg_console_input_t *input = &session->input;
    uint8_t *bytes = (uint8_t *)input->line;
    const size_t length = session->live.frame.length;
    session->live.heard_ns = session->now_ns;
    session->output.framed = true;
    switch (bytes[0]) {
    case EPG_CONSOLE_COMMAND:
        if (length > 2) {
            input->tag = bytes[1];
            input->length = length - 2;
            memmove(input->line, input->line + 2, input->length);
            input->complete = true;
            for (size_t i = 0; i < input->length; i++) {
                input->no_text = input->no_text || (unsigned char)input->line[i] < ' ' || input->line[i] == 127;
            }
        }
        break;
    case EPG_CONSOLE_STREAM:
        if (length >= 2) {
            session->output.tag = bytes[1];
            start_stream(session, bytes + 2, length - 2);
            session->output.tag = 0;
        }
        break;
    case EPG_CONSOLE_RESPONSE:
        if (length == 5) {
            take_response(session, whole_number(&bytes[1], 4));
        }
        break;
    case EPG_CONSOLE_KEEP:
    default: /* a message of a later version */
        break;
    }
}

static bool is_for_console(char type)
{
    return type == EPG_CONSOLE_COMMAND || type == EPG_CONSOLE_STREAM || type == EPG_CONSOLE_RESPONSE ||
           type == EPG_CONSOLE_KEEP;
}

void epg_console_take_framed(epg_console_session_t *session, uint8_t byte)
{
    session->live.byte_ns = session->now_ns;
    if (byte == 0 && !session->live.frame.open) {
        epg_console_input_clear(&session->input);
    }
    switch (epg_console_frame_take(&session->live.frame, (uint8_t *)session->input.line, sizeof session->input.line,
                                   byte)) {
    case EPG_CONSOLE_FRAME_MORE:
        if (session->live.frame.length > 0 && !is_for_console(session->input.line[0])) {
            session->live.frame = (epg_console_frame_t){0}; /* noise: text can follow at once */
            epg_console_input_clear(&session->input);
            session->input.no_text = true;
        }
        break;
    case EPG_CONSOLE_FRAME_WHOLE:
        take_message(session);
        break;
    case EPG_CONSOLE_FRAME_TOO_LONG:
    case EPG_CONSOLE_FRAME_DAMAGED:
        break;
    }
}

void epg_console_end_frames(epg_console_session_t *session)
{
    end_stream(session);
    session->output.framed = false;
    session->live.leased = false; /* the lease ends by itself */
    session->live.moved_ns = 0;
}

void epg_console_poll_live(epg_console_session_t *session)
{
    epg_console_live_t *live = &session->live;
    if (live->frame.open && session->now_ns - live->byte_ns > (uint64_t)BYTE_MS * MS) {
        live->frame = (epg_console_frame_t){0};
        epg_console_input_clear(&session->input);
    }
    if (session->output.framed && session->now_ns - live->heard_ns > (uint64_t)SILENCE_MS * MS) {
        epg_console_end_frames(session);
    }
    poll_lease(session);
    poll_stream(session);
}
