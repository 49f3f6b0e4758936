/**
 * @file
 * An honest XRCE agent for one board.  It is the board's peer before and after the hostile bytes.
 *
 * It grants everything, acknowledges, and repeats frames that the board misses.  It has no clock: the caller reports
 * when 200 ms have passed.
 */
#ifndef AGENT_H
#define AGENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { AGENT_FRAME = 1200, AGENT_WINDOW = 16, AGENT_QUEUE = 64, AGENT_READERS = 16, AGENT_MTU = 512 };

/** Bytes of the largest submessage that the agent collects from fragments. */
enum { AGENT_MESSAGE = 16384 };

typedef struct agent_frame {
    size_t size;
    uint8_t bytes[AGENT_FRAME];
} agent_frame_t;

/** A reliable stream in both directions. */
typedef struct agent_stream {
    uint16_t expected;                /**< number of the board's next frame */
    uint16_t next;                    /**< number of the agent's next frame */
    uint16_t unacknowledged;          /**< number of the oldest frame that the board has not acknowledged */
    agent_frame_t sent[AGENT_WINDOW]; /**< the agent's frames, by number modulo the window */
} agent_stream_t;

typedef struct agent {
    bool session;                     /**< a client has connected */
    agent_stream_t topics;            /**< stream 0x80 */
    agent_stream_t services;          /**< stream 0x81 */
    uint16_t best_effort;             /**< number of the next best-effort frame */
    agent_frame_t queue[AGENT_QUEUE]; /**< frames on their way to the board */
    size_t queued;
    size_t taken;
    uint8_t requests[AGENT_READERS][4]; /**< request and object id of each reader whose samples are wanted */
    uint8_t streams[AGENT_READERS];     /**< stream for the samples of each of these readers */
    size_t readers;
    size_t written;                     /**< samples that the board has sent */
    uint8_t repliers[AGENT_READERS][4]; /**< request and object id of each replier whose requests are wanted */
    size_t replier_count;
    uint8_t message[AGENT_MESSAGE]; /**< the fragments of a reply */
    size_t message_size;
    size_t replies;                    /**< replies that the board has sent */
    uint32_t last_request;             /**< number of the request that was answered last */
    uint8_t last_reply[AGENT_MESSAGE]; /**< its reply */
    size_t last_reply_size;
} agent_t;

/** Forgets the board. */
void agent_forget(agent_t *agent);

/** Handles a frame from the board. */
void agent_receive(agent_t *agent, const uint8_t *frame, size_t size);

/** The next frame for the board; NULL if there is none. */
agent_frame_t *agent_next(agent_t *agent);

/** Queues a frame for the board. */
void agent_queue(agent_t *agent, const uint8_t *frame, size_t size);

/** Sends a sample to reader `reader`, on the stream that the board has requested for it. */
void agent_sample(agent_t *agent, size_t reader, const uint8_t *data, size_t size);

/**
 * Sends request `number` to service `service`, in fragments if it is large.  Returns false if the window is full or the
 * service does not exist.
 */
bool agent_request(agent_t *agent, size_t service, uint32_t number, const uint8_t *data, size_t size);

/** Reports that 200 ms have passed. */
void agent_beat(agent_t *agent);

#endif
