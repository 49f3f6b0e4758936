/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Services of a ROS 2 node without their transport: requests that arrive, and the replies to them.
 *
 * A service belongs to `target->services`, and its state to `target->service_state`.  The generator defines both for a
 * middleware whose `uses` names `services`; other middlewares ignore them.  The node works on one request at a time:
 *
 * 1. The middleware makes one replier for each service, with the names that epg_service_topic() gives.
 * 2. It passes each whole request to epg_service_request().  A request that is EPG_SERVICE_BUSY must wait or be dropped.
 * 3. It calls epg_service_poll() until the reply is ready.  Some replies wait for the next control cycles.
 * 4. It sends epg_service_reply_size() bytes, in as many pieces as it likes: epg_service_reply() gives any part of the
 *    reply, and the reply stays the same until epg_service_done().
 * 5. It calls epg_service_done(), also if the connection is lost or the reply cannot be sent.
 *
 *     if (epg_service_request(node, i, data, size, now_ns) == EPG_SERVICE_TAKEN) { requester = ...; }
 *     if (epg_service_poll(node, now_ns)) {
 *         sent += epg_service_reply(node, sent, buffer, sizeof buffer); // and pass it to the transport
 *         if (sent == epg_service_reply_size(node)) { epg_service_done(node); }
 *     }
 *
 * A request to disable does not wait for the replies before it.  The middleware looks at each request that waits:
 *
 *     if (epg_service_is_stop(node, i, data, size)) { epg_stop(node->target->control, EPG_STOP_SERVICE); }
 *
 * A request to enable that waits while something else stops the target must not act afterwards.  In a poll in which
 * `node->services_clean` is false, the middleware marks all requests that wait; each of them is `overtaken`.
 *
 * A middleware that receives a request in fragments can collect them in the buffer `target->service_state->request`,
 * while epg_service_idle().  It remembers the requester itself.
 *
 * Requests and replies are little-endian CDR (epg/cdr.h) without an encapsulation header, as messages are.  All
 * functions belong to the communication side and return at once.
 */
#ifndef EPG_SERVICE_H
#define EPG_SERVICE_H

#include "epg/cdr.h"
#include "epg/node.h"

struct epg_reply; /* the writer of a reply: src/reply.h */

/** The type of a request or of a reply. */
typedef struct epg_service_type {
    const char *type; /**< its name in DDS */
    const char *hash; /**< EPG_TYPE_HASH() of "RIHS01_" and 64 hexadecimal digits */
} epg_service_type_t;

/** The behaviour of a service. */
typedef struct epg_service_kind {
    epg_service_type_t request;
    epg_service_type_t reply;
    /** Reads a request, which comes from the network, and begins to carry it out.  Returns false if it is malformed. */
    bool (*take)(epg_node_t *node, epg_cdr_reader_t *request);
    /** Returns true if the reply can be written.  `late` is true if the control loop does not run.  NULL: at once. */
    bool (*ready)(epg_node_t *node, bool late);
    /** Writes part `part` (0, 1, ...) of the reply.  Returns false, and writes nothing, after the last part. */
    bool (*write)(epg_node_t *node, struct epg_reply *reply, size_t part);
} epg_service_kind_t;

typedef struct epg_service {
    const char *name; /**< as that of a topic: "~/enable" */
    const epg_service_kind_t *kind;
    size_t request_size; /**< bytes of the largest request */
} epg_service_t;

/** Bytes of the longest message in a reply, with the terminating zero. */
#define EPG_SERVICE_MESSAGE_SIZE 96

typedef struct epg_service_state {
    /* The generator sets these members. */
    unsigned char *request;                 /**< room for the largest request of all services */
    size_t request_size;                    /**< its size in bytes */
    const struct epg_parameter_text *texts; /**< texts of the parameters (epg/parameter_services.h); NULL: none */
    double *copy; /**< room for the values of all parameters, so that those of one reply are consistent */

    /* These members belong to the services. */
    const epg_service_t *service; /**< the service whose request is in work; NULL: none */
    size_t length;                /**< bytes of that request */
    uint64_t taken_ns;            /**< board time at which it was taken */
    bool ready;                   /**< the reply can be written; it has `reply_size` bytes */
    size_t reply_size;
    size_t part; /**< the reply is continued at this part, which begins at byte `position` */
    size_t position;

    bool observed;   /**< `cycles` is valid */
    bool enable;     /**< the request to enable or to disable */
    uint64_t cycles; /**< number of control cycles when the request was taken */

    /* The middleware sets these members before it passes a request that has waited; epg_service_request() clears them. */
    bool stopped;   /**< the request is to disable, and has stopped the target while it waited */
    bool overtaken; /**< something has stopped the target after this request has arrived */

    bool success;   /**< the result that the reply reports */
    bool staged;    /**< changes of parameters have been requested, or refused as a whole */
    size_t entries; /**< number of elements in the reply */
    size_t entry;   /**< the request is read on at this element, at byte `entry_position` */
    size_t entry_position;
    char message[EPG_SERVICE_MESSAGE_SIZE]; /**< its reason, or its number */
} epg_service_state_t;

typedef enum epg_service_result {
    EPG_SERVICE_TAKEN,    /**< the request is in work */
    EPG_SERVICE_BUSY,     /**< another request is in work */
    EPG_SERVICE_MALFORMED /**< the request does not fit its type or is too large; it is counted in `node->malformed` */
} epg_service_result_t;

/** std_srvs/srv/SetBool: enables or disables the target as the topic does.  The reply says if it is so. */
extern const epg_service_kind_t epg_service_enable;

/** std_srvs/srv/Trigger: clears a latched fault.  The target stays disabled. */
extern const epg_service_kind_t epg_service_reset;

/**
 * Writes the DDS topic of service `service`: "rq/robot1/JIWY_node/enableRequest", or with `reply`
 * "rr/robot1/JIWY_node/enableReply".  Returns its length, 0 if it does not fit into `size` bytes.
 */
size_t epg_service_topic(const epg_node_t *node, size_t service, bool reply, char *name, size_t size);

/** Returns true if no request is in work. */
bool epg_service_idle(const epg_node_t *node);

/** Returns true if a whole request for service `service` is one to disable the target. */
bool epg_service_is_stop(const epg_node_t *node, size_t service, const void *request, size_t size);

/** Takes a whole request for service `service`.  `request` may be the buffer of the state itself. */
epg_service_result_t epg_service_request(epg_node_t *node, size_t service, const void *request, size_t size,
                                         uint64_t now_ns);

/** Returns true if the reply to the request in work is ready.  Must be called in each poll while one is in work. */
bool epg_service_poll(epg_node_t *node, uint64_t now_ns);

/** Returns the size of the reply in bytes.  The reply must be ready. */
size_t epg_service_reply_size(const epg_node_t *node);

/**
 * Copies at most `size` bytes of the reply from byte `offset` on.  Returns their number; it is less than `size` only at
 * the end of the reply.  Ascending offsets are fastest.  The reply must be ready.
 */
size_t epg_service_reply(epg_node_t *node, size_t offset, void *to, size_t size);

/** Ends the work on the request.  A change that it has requested stays requested. */
void epg_service_done(epg_node_t *node);

#endif
