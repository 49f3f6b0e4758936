/**
 * @file
 * The least of an agent, in the clock of a test: it answers as it must, and does what the test tells it to.
 *
 * It is at the other end of a stream of datagrams whose every frame the test can see.
 */
#ifndef XRCE_TEST_AGENT_H
#define XRCE_TEST_AGENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/stream.h"

enum { AGENT_FRAMES = 2048, AGENT_FRAME = 600, AGENT_ENTITIES = 64 };

typedef struct agent_frame {
    uint64_t time_ns;
    size_t size;
    unsigned char data[AGENT_FRAME];
} agent_frame_t;

typedef struct agent {
    /* set by the test */
    bool absent;         /**< nothing is answered */
    bool unplugged;      /**< the stream says that nobody is there */
    bool acknowledges;   /**< frames of the reliable stream, at once */
    uint8_t status;      /**< of whatever is to be created */
    size_t room;         /**< bytes that the stream takes */
    unsigned int losing; /**< so many reliable frames are lost on their way to the agent */
    bool loses_every;    /**< all of them */

    /* seen by the test */
    agent_frame_t sent[AGENT_FRAMES]; /**< by the board */
    size_t sent_count;
    size_t read_count; /**< frames that the board has read */
    bool known;        /**< the board has a session */
    unsigned int sessions;
    unsigned int goodbyes;
    unsigned int created;
    unsigned int readers; /**< whose samples are wanted */
    unsigned int pings;
    unsigned int heartbeats;
    unsigned int samples;
    double values[AGENT_FRAMES]; /**< of the samples */
    uint32_t key;
    uint16_t mtu;

    /* the agent's */
    uint16_t expected; /**< the next frame of the board's reliable stream */
    uint16_t next;     /**< of its own */
    agent_frame_t waiting[64];
    size_t waiting_first;
    size_t waiting_count;
    uint8_t request[2]; /**< of the reader asked for last, and its number */
    uint8_t reader[2];
} agent_t;

extern agent_t agent;

/** Everything to its start: an agent that is there. */
void agent_reset(void);

/** As a process that is started anew: it knows nobody. */
void agent_restart(void);

/** The stream to it. */
extern const epg_stream_t agent_stream;

/** A frame for the board: header and one submessage; `reliable` frames get the next number. */
void agent_say(bool reliable, uint8_t id, const void *payload, size_t size);

/** A frame for the board as it is. */
void agent_say_raw(const void *data, size_t size);

/** A sample for the reader asked for last. */
void agent_publish(double value);

/** How many frames the board has sent that have submessage `id` first. */
unsigned int agent_count(uint8_t id);

#endif
