/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Services: requests from the agent, and the replies to them.
 *
 * Source: OMG, "DDS for Extremely Resource Constrained Environments" 1.0, 8.3.5 (submessages), 8.4 (streams).
 */
#include "xrce_services.h"

#include <string.h>

#include <uxr/client/client.h>

#include "epg/service.h"

enum {
    HEADER = 4, /* bytes of a frame's header: session, stream, number */
    SUBHEADER = 4,
    IDS = 4,              /* of the request and of the object */
    LARGEST_HISTORY = 16, /* number of frames that an ACKNACK can name */
    WINDOW = 2,           /* frames of a reply on their way at once; more would delay publications on a serial line */
    LARGEST_SUBMESSAGE = 0xFFFF,
};

enum { WRITE_DATA = 0x07, DATA = 0x09, ACKNACK = 0x0A, HEARTBEAT = 0x0B, FRAGMENT = 0x0D };
enum { LITTLE_ENDIAN_FLAG = 0x01, LAST_FRAGMENT_FLAG = 0x02, FORMAT_FLAGS = 0x0E };

/** Interval between two requests for an acknowledgement. */
static const uint64_t HEARTBEAT_NS = 50000000;

static uint16_t number_at(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] | bytes[1] << 8);
}

static void put_number(uint8_t *bytes, uint16_t number)
{
    bytes[0] = (uint8_t)(number & 0xFFU);
    bytes[1] = (uint8_t)(number >> 8);
}

/** Returns how far frame `number` is ahead of frame `from`; more than 0x7FFF if it is behind. */
static uint16_t ahead(uint16_t from, uint16_t number)
{
    return (uint16_t)(number - from);
}

void epg_xrce_services_start(epg_xrce_services_t *services)
{
    if (services->node->target->service_count > 0 && !epg_service_idle(services->node)) {
        epg_service_done(services->node);
    }
    *services = (epg_xrce_services_t){
        .node = services->node,
        .link = services->link,
        .frame = services->frame,
        .frame_size = services->frame_size,
        .opening = true,
        .count = 1,
    };
}

/* Requests ----------------------------------------------------------------------------------------------------- */

/** Adds bytes to the submessage that is being collected.  Bytes beyond the node's buffer are only counted. */
static void collect(epg_xrce_services_t *services, const uint8_t *bytes, size_t size)
{
    const epg_service_state_t *state = services->node->target->service_state;
    for (size_t i = 0; i < size; i++, services->collected++) {
        if (services->collected < EPG_XRCE_SERVICE_HEAD) {
            services->head[services->collected] = bytes[i];
        } else if (services->collected - EPG_XRCE_SERVICE_HEAD < state->request_size) {
            state->request[services->collected - EPG_XRCE_SERVICE_HEAD] = bytes[i];
        }
    }
}

/** Returns true if a submessage of `size` bytes that begins with `head` is a request.  `service` is its service then. */
static bool is_request(const epg_xrce_services_t *services, const uint8_t *head, size_t size, size_t *service)
{
    if (size < EPG_XRCE_SERVICE_HEAD || head[0] != DATA || (head[1] & LITTLE_ENDIAN_FLAG) == 0 ||
        (head[1] & FORMAT_FLAGS) != 0 || number_at(head + 2) != size - SUBHEADER ||
        (head[7] & 0x0FU) != UXR_REPLIER_ID) {
        return false;
    }
    const size_t id = (size_t)head[6] << 4 | head[7] >> 4;
    *service = id - epg_xrce_services_id(0);
    return id >= epg_xrce_services_id(0) && *service < services->node->target->service_count;
}

/** Hands the collected request to the node. */
static void finish_request(epg_xrce_services_t *services)
{
    const epg_service_state_t *state = services->node->target->service_state;
    const size_t size = services->collected - EPG_XRCE_SERVICE_HEAD;
    size_t service = 0;
    if (!is_request(services, services->head, services->collected, &service) || size > state->request_size) {
        services->node->malformed++;
    } else if (epg_service_request(services->node, service, state->request, size, services->now_ns) ==
               EPG_SERVICE_TAKEN) {
        memcpy(services->request, services->head, sizeof services->request);
    }
    services->collected = 0;
}

/** Takes the only submessage of a frame: a request, or a fragment of one.  Returns false if it is neither. */
static bool take(epg_xrce_services_t *services, const uint8_t *submessage, size_t size)
{
    const size_t length = size >= SUBHEADER ? number_at(submessage + 2) : SIZE_MAX;
    if (size < SUBHEADER || length > size - SUBHEADER || (submessage[1] & LITTLE_ENDIAN_FLAG) == 0 ||
        (submessage[0] != DATA && submessage[0] != FRAGMENT)) {
        return false;
    }
    if (submessage[0] == DATA) {
        services->node->malformed += services->collected > 0 ? 1U : 0U; /* a request without its last fragment */
        services->collected = 0;
        collect(services, submessage, SUBHEADER + length);
        finish_request(services);
    } else {
        collect(services, submessage + SUBHEADER, length);
        if ((submessage[1] & LAST_FRAGMENT_FLAG) != 0) {
            finish_request(services);
        }
    }
    return true;
}

/** Looks at a frame that must wait, `distance` after the expected one.  A request to disable does not wait. */
static void look_ahead(epg_xrce_services_t *services, unsigned int distance, const uint8_t *body, size_t size)
{
    const epg_node_t *node = services->node;
    const uint16_t mark = (uint16_t)(1U << distance);
    size_t service = 0;
    if ((services->stopped & mark) == 0 && is_request(services, body, size, &service) &&
        epg_service_is_stop(node, service, body + EPG_XRCE_SERVICE_HEAD, size - EPG_XRCE_SERVICE_HEAD)) {
        services->stopped |= mark;
        epg_stop(node->target->control, EPG_STOP_SERVICE);
    }
}

bool epg_xrce_services_receive(epg_xrce_services_t *services, uint16_t number, const uint8_t *body, size_t size,
                               bool ignore)
{
    const uint16_t distance = ahead(services->expected, number);
    services->acknowledge = true;
    if (distance >= 0x8000U) {
        return true; /* it was received before */
    }
    if (distance >= LARGEST_HISTORY) {
        return false;
    }
    if (ahead(services->announced, number) < 0x8000U) {
        services->announced = (uint16_t)(number + 1U);
    }
    if (distance > 0 || (!ignore && !epg_service_idle(services->node))) {
        if (!ignore) {
            look_ahead(services, distance, body, size); /* the agent sends it again after the frames before it */
        }
        services->held = services->held || distance == 0;
        return true;
    }
    services->expected++;
    services->node->target->service_state->stopped = (services->stopped & 1U) != 0;
    services->stopped = (uint16_t)(services->stopped >> 1);
    services->node->target->service_state->overtaken = services->stopped != 0 || services->stale > 0;
    if (services->stale > 0) {
        services->stale--;
    }
    return ignore || take(services, body, size);
}

void epg_xrce_services_heartbeat(epg_xrce_services_t *services, uint16_t last)
{
    const uint16_t distance = ahead(services->expected, (uint16_t)(last + 1U));
    services->acknowledge = true;
    if (distance < 0x8000U) {
        services->announced =
            (uint16_t)(services->expected + (distance < LARGEST_HISTORY ? distance : LARGEST_HISTORY));
    }
}

bool epg_xrce_services_lack_frames(const epg_xrce_services_t *services)
{
    return services->expected != services->announced && epg_service_idle(services->node);
}

/* Frames to the agent ------------------------------------------------------------------------------------------ */

/** Sends an ACKNACK or a HEARTBEAT: two numbers of two bytes, and the stream.  Returns false if there was no room. */
static bool send_numbers(const epg_xrce_services_t *services, uint8_t id, uint16_t first, const uint8_t *second)
{
    uint8_t frame[HEADER + SUBHEADER + 5] = {EPG_XRCE_SESSION_ID, 0, 0, 0, id, LITTLE_ENDIAN_FLAG, 5, 0};
    put_number(frame + 8, first);
    memcpy(frame + 10, second, 2);
    frame[12] = EPG_XRCE_SERVICE_STREAM;
    return epg_xrce_link_send(services->link, frame, sizeof frame);
}

/** Acknowledges the frames before `expected`, and asks for the missing ones unless a request is in work. */
static void send_acknack(epg_xrce_services_t *services)
{
    const bool idle = epg_service_idle(services->node);
    const unsigned int count = idle ? ahead(services->expected, services->announced) : 0U;
    const unsigned int missing = count > LARGEST_HISTORY ? 0U : (1U << count) - 1U;
    const uint8_t bits[2] = {(uint8_t)(missing >> 8 & 0xFFU), (uint8_t)(missing & 0xFFU)};
    services->acknowledge = !send_numbers(services, ACKNACK, services->expected, bits);
    services->held = services->held && !idle;
}

static void send_heartbeat(epg_xrce_services_t *services)
{
    uint8_t last[2];
    put_number(last, (uint16_t)(services->next - 1U));
    if (send_numbers(services, HEARTBEAT, services->unacknowledged, last)) {
        services->heartbeat_ns = services->now_ns + HEARTBEAT_NS;
    }
}

/* The reply ---------------------------------------------------------------------------------------------------- */

/** Returns the bytes of the reply's submessage. */
static size_t reply_length(const epg_xrce_services_t *services)
{
    return EPG_XRCE_SERVICE_HEAD + epg_service_reply_size(services->node);
}

/** Returns the bytes of the submessage that one frame carries, and the bytes before them in the frame. */
static size_t reply_share(const epg_xrce_services_t *services, size_t *before)
{
    const size_t length = reply_length(services);
    const bool whole = HEADER + length <= services->frame_size;
    *before = whole ? HEADER : HEADER + SUBHEADER;
    return whole ? length : services->frame_size - *before;
}

/** Numbers the frames of a reply that is ready. */
static void begin_reply(epg_xrce_services_t *services)
{
    const size_t length = reply_length(services);
    size_t before = 0;
    const size_t share = reply_share(services, &before);
    if (length - SUBHEADER > LARGEST_SUBMESSAGE) {
        epg_service_done(services->node); /* XRCE cannot carry it */
        return;
    }
    services->count = (uint16_t)((length + share - 1) / share);
    services->first = services->next;
    services->missing = 0;
}

/** Writes `size` bytes of the reply's submessage from byte `offset` on. */
static void write_reply(const epg_xrce_services_t *services, size_t offset, uint8_t *to, size_t size)
{
    uint8_t head[EPG_XRCE_SERVICE_HEAD];
    memcpy(head, services->request, sizeof head); /* the ids of request and replier, and the identity */
    head[0] = WRITE_DATA;
    head[1] = LITTLE_ENDIAN_FLAG;
    put_number(head + 2, (uint16_t)(reply_length(services) - SUBHEADER));
    const size_t left = offset < sizeof head ? sizeof head - offset : 0;
    const size_t ours = left < size ? left : size;
    if (ours > 0) {
        memcpy(to, head + offset, ours);
    }
    if (size > ours) {
        (void)epg_service_reply(services->node, offset + ours - sizeof head, to + ours, size - ours);
    }
}

/** Sends frame `number` of the reply.  Returns false if the transport has no room for it. */
static bool send_reply_frame(epg_xrce_services_t *services, uint16_t number)
{
    size_t before = HEADER + SUBHEADER;
    const size_t share = services->opening ? 0 : reply_share(services, &before);
    const size_t offset = share * ahead(services->first, number);
    const size_t left = services->opening ? 0 : reply_length(services) - offset;
    const size_t size = left < share ? left : share;
    uint8_t *frame = services->frame;
    frame[0] = EPG_XRCE_SESSION_ID;
    frame[1] = EPG_XRCE_SERVICE_STREAM;
    put_number(frame + 2, number);
    if (before > HEADER) {
        frame[4] = FRAGMENT;
        frame[5] = (uint8_t)(LITTLE_ENDIAN_FLAG | (size == left ? LAST_FRAGMENT_FLAG : 0));
        put_number(frame + 6, (uint16_t)size);
    }
    if (size > 0) {
        write_reply(services, offset, frame + before, size);
    }
    return epg_xrce_link_send(services->link, frame, before + size);
}

void epg_xrce_services_acknowledge(epg_xrce_services_t *services, uint16_t first_missing, uint16_t missing)
{
    const uint16_t sent = ahead(services->unacknowledged, services->next);
    if (ahead(services->unacknowledged, first_missing) > sent) {
        return; /* a late one, or of frames that were never sent */
    }
    if (services->unacknowledged != first_missing) {
        services->unacknowledged = first_missing;
        services->heartbeat_ns = services->now_ns + HEARTBEAT_NS;
    }
    services->missing = (uint16_t)(missing & ((1U << ahead(first_missing, services->next)) - 1U));
}

/** Sends the frames for which the agent has asked again, then new ones within the window. */
static void send_reply(epg_xrce_services_t *services)
{
    for (uint16_t i = 0; services->missing != 0; i++) {
        if ((services->missing & 1U << i) != 0) {
            if (!send_reply_frame(services, (uint16_t)(services->unacknowledged + i))) {
                return;
            }
            services->missing = (uint16_t)(services->missing & ~(1U << i));
        }
    }
    const uint16_t end = (uint16_t)(services->first + services->count);
    if (services->next != end && ahead(services->unacknowledged, services->next) < WINDOW &&
        send_reply_frame(services, services->next)) {
        if (services->unacknowledged == services->next) {
            services->heartbeat_ns = services->now_ns + HEARTBEAT_NS;
        }
        services->next++;
    }
}

/** Ends a reply that the agent has acknowledged as a whole. */
static void end_reply(epg_xrce_services_t *services)
{
    if (!services->opening) {
        epg_service_done(services->node);
    }
    services->opening = false;
    services->count = 0;
}

void epg_xrce_services_poll(epg_xrce_services_t *services, uint64_t now_ns)
{
    services->now_ns = now_ns;
    if (!services->node->services_clean) {
        services->stale = ahead(services->expected, services->announced);
    }
    if (services->count == 0 && epg_service_poll(services->node, now_ns)) {
        begin_reply(services);
    }
    if (services->count > 0) {
        send_reply(services);
        if (services->unacknowledged != services->next && now_ns >= services->heartbeat_ns) {
            send_heartbeat(services);
        }
        if (services->unacknowledged == (uint16_t)(services->first + services->count)) {
            end_reply(services);
        }
    }
    if (services->acknowledge || (services->held && epg_service_idle(services->node))) {
        send_acknack(services);
    }
}
