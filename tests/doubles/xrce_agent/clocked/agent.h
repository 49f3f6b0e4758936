/**
 * @file
 * A minimal agent in the clock of a test: it answers as the protocol requires, and has the faults that the test sets.
 *
 * It is the other end of a stream of datagrams.  The test can see every frame.
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

/** A message with a stamp. */
typedef struct agent_stamp {
    uint64_t time_ns;  /**< board time at which it was sent */
    uint64_t stamp_ns; /**< its stamp */
} agent_stamp_t;

typedef struct agent {
    /* set by the test */
    bool absent;         /**< the agent does not answer */
    bool busy;           /**< frames wait in both directions */
    bool unplugged;      /**< the stream reports that no agent is connected */
    bool acknowledges;   /**< acknowledges frames of the reliable stream at once */
    uint8_t status;      /**< status of every request to create */
    size_t room;         /**< bytes that the stream takes */
    unsigned int losing; /**< number of reliable frames that are lost on their way to the agent */
    bool loses_every;    /**< all reliable frames are lost */
    uint64_t there_ns;   /**< duration of a frame's way to the agent */
    uint64_t back_ns;    /**< duration of a frame's way to the board */
    uint64_t ahead_ns;   /**< the agent's clock is ahead of the board's time by this much */
    bool mute_clock;     /**< the agent does not answer requests for the time */

    /* seen by the test */
    agent_frame_t sent[AGENT_FRAMES]; /**< frames of the board */
    size_t sent_count;
    size_t read_count; /**< frames that the board has read */
    bool known;        /**< the board has a session */
    unsigned int sessions;
    unsigned int goodbyes;
    unsigned int created;
    unsigned int readers; /**< readers whose samples the board has requested */
    unsigned int pings;
    unsigned int heartbeats;
    unsigned int samples;
    double values[AGENT_FRAMES];        /**< values of the samples of the first publication */
    agent_stamp_t stamps[AGENT_FRAMES]; /**< of the messages of the second publication */
    unsigned int stamp_count;
    uint32_t key;
    uint16_t mtu;

    /* internal to the agent */
    uint16_t expected; /**< the next frame of the board's reliable stream */
    uint16_t next;     /**< the next frame of the agent's reliable stream */
    size_t unread;     /**< newest frames in `sent` that it has not read, because it was busy */
    agent_frame_t waiting[128];
    size_t waiting_first;
    size_t waiting_count;
    uint8_t request[2]; /**< id of the last request to read, and the number of its reader */
    uint8_t reader[2];
} agent_t;

extern agent_t agent;

/** Resets everything: the agent is present and has no faults. */
void agent_reset(void);

/** Like a new process: the agent does not know any client. */
void agent_restart(void);

/** The stream to the agent. */
extern const epg_stream_t agent_stream;

/** Sends the board a frame with one submessage; `reliable` frames get the next number. */
void agent_say(bool reliable, uint8_t id, const void *payload, size_t size);

/** Sends the board these bytes as a frame. */
void agent_say_raw(const void *data, size_t size);

/** Sends a sample to the reader of the last request to read. */
void agent_publish(double value);

/** The number of frames from the board whose first submessage is `id`. */
unsigned int agent_count(uint8_t id);

#endif
