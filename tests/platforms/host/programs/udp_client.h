/**
 * @file
 * Clients of a console by UDP on a test bench: real sockets, simulated time.
 *
 * A send() that has returned has arrived, because both sockets are on the loopback.  So a test knows the order in which
 * datagrams have arrived.
 */
#ifndef UDP_CLIENT_H
#define UDP_CLIENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "links/realtime/udp_seal.h"
#include "links/realtime/udp_session.h"

enum { CLIENT_LONGEST = 8192 };

typedef struct client {
    int file;
    uint32_t session;
    uint32_t number; /**< of the newest command */
    bool seals;
    epg_host_udp_seal_t seal;
    uint64_t counter;
    unsigned char sent[CLIENT_LONGEST]; /**< the newest datagram */
    size_t sent_size;
    unsigned char got[CLIENT_LONGEST + 1]; /**< the newest datagram from the target, ended by a zero */
    size_t got_size;
} client_t;

/** The key of a console with a key, as text. */
#define CLIENT_KEY "00112233-44556677-8899aabb-ccddeeff"

/** Starts a disabled target with a console on a free port of the loopback, with the key or without. */
void target_open(bool keyed);

/** Ends the console. */
void target_close(void);

/** Returns a new client. */
client_t client_join(void);

void client_send(client_t *client, const void *data, size_t size);

/** Sends a line of a person, without its end. */
void client_say(client_t *client, const char *line);

/** Sends a datagram of a program with these bytes, sealed if the client has a seal. */
void client_send_program(client_t *client, uint8_t flags, uint32_t number, const void *body, size_t size);

/** Sends a command in a frame, with the next number. */
void client_command(client_t *client, const char *line);

/** Takes the next datagram of the target.  Returns its size; 0: there is none. */
size_t client_receive(client_t *client);

/** Takes the next datagram, which must be for a program.  Returns its flags; -1: there is none, or its seal is wrong. */
int client_flags(client_t *client);

/** Takes the datagrams of the target up to one that contains `text`.  Returns false if there is none. */
bool client_hears(client_t *client, const char *text);

/** Begins a session of a program, which must succeed. */
void client_begin(client_t *client);

/** Gives the client a seal with the key `key` (as text). */
void client_take_key(client_t *client, const char *key);

/** Sends the command that enables the target, after its newest stop. */
void client_enable(client_t *client);

#endif
