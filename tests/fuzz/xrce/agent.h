/**
 * @file
 * An honest XRCE agent, as far as a board can tell, for one board: what comes before and after hostile bytes.
 *
 * It grants everything, acknowledges, and sends again what the board misses.  No clock: the caller says when 200 ms
 * have passed.
 */
#ifndef AGENT_H
#define AGENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { AGENT_FRAME = 1200, AGENT_WINDOW = 16, AGENT_QUEUE = 64, AGENT_READERS = 16 };

typedef struct agent_frame {
    size_t size;
    uint8_t bytes[AGENT_FRAME];
} agent_frame_t;

typedef struct agent {
    bool session;                     /**< a client has connected */
    uint16_t expected;                /**< number of the board's next reliable frame */
    uint16_t next;                    /**< of the agent's */
    uint16_t unacknowledged;          /**< the oldest that the board has not acknowledged */
    uint16_t best_effort;             /**< number of the next best-effort frame */
    agent_frame_t sent[AGENT_WINDOW]; /**< reliable frames, by number modulo the window */
    agent_frame_t queue[AGENT_QUEUE]; /**< on their way to the board */
    size_t queued;
    size_t taken;
    uint8_t requests[AGENT_READERS][4]; /**< request and object id of each reader whose samples are wanted */
    uint8_t streams[AGENT_READERS];     /**< on which they are wanted */
    size_t readers;
    size_t written; /**< samples that the board has sent */
} agent_t;

/** A frame from the board. */
void agent_receive(agent_t *agent, const uint8_t *frame, size_t size);

/** The next frame for the board; NULL: none. */
agent_frame_t *agent_next(agent_t *agent);

/** Puts a frame on its way to the board. */
void agent_queue(agent_t *agent, const uint8_t *frame, size_t size);

/** A sample for reader `reader`, on the stream it wants it on. */
void agent_sample(agent_t *agent, size_t reader, const uint8_t *data, size_t size);

/** 200 ms have passed. */
void agent_beat(agent_t *agent);

#endif
