/**
 * @file
 * Clients of a console by UDP on a test bench.
 */
#define _POSIX_C_SOURCE 200809L

#include "udp_client.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "check.h"
#include "console_bench.h"
#include "fake_application.h"
#include "fake_port.h"
#include "links/udp_console.h"
#include "port/clock.h"

static epg_host_udp_console_t *target;
static uint32_t sessions;

uint64_t epg_host_monotonic_ns(void)
{
    static uint64_t latest_ns; /* the time of the bench goes back at the end of `frozen` */
    const uint64_t now_ns = fake_port.now_ns + 1000000000U;
    latest_ns = now_ns > latest_ns ? now_ns : latest_ns;
    return latest_ns;
}

void target_open(bool keyed)
{
    static char file[] = "/tmp/epg_key_XXXXXX";
    epg_host_options_t options = {.console_udp = "0"};
    if (keyed) {
        char name[sizeof file];
        memcpy(name, file, sizeof file);
        const int made = mkstemp(name); /* with mode 0600 */
        CHECK(made >= 0 && write(made, CLIENT_KEY, sizeof CLIENT_KEY - 1) > 0);
        close(made);
        options.console_key = name;
        bench_start(false);
        target = epg_host_udp_console_open(&options, &bench.target);
        unlink(name);
    } else {
        bench_start(false);
        target = epg_host_udp_console_open(&options, &bench.target);
    }
    CHECK(target != NULL);
    epg_console.start(&bench.target, epg_host_udp_console_stream(target));
    bench_run(5);
}

void target_close(void)
{
    epg_host_udp_console_close(target);
}

client_t client_join(void)
{
    struct sockaddr_in address;
    socklen_t size = sizeof address;
    CHECK(getsockname(epg_host_udp_console_file(target), (struct sockaddr *)&address, &size) == 0);
    client_t client = {.file = socket(AF_INET, SOCK_DGRAM, 0), .session = ++sessions};
    CHECK(client.file >= 0 && connect(client.file, (struct sockaddr *)&address, size) == 0);
    return client;
}

void client_send(client_t *client, const void *data, size_t size)
{
    CHECK(send(client->file, data, size, 0) == (ssize_t)size);
}

void client_say(client_t *client, const char *line)
{
    char text[400];
    client_send(client, text, (size_t)snprintf(text, sizeof text, "%s\n", line));
}

void client_send_program(client_t *client, uint8_t flags, uint32_t number, const void *body, size_t size)
{
    const size_t head = client->seals ? EPG_HOST_UDP_SEAL : 0;
    const epg_host_udp_header_t header = {.flags = flags, .session = client->session, .number = number};
    epg_host_udp_write_header(client->sent + head, &header);
    if (size > 0) {
        memcpy(client->sent + head + EPG_HOST_UDP_HEADER, body, size);
    }
    if (client->seals) {
        client->counter++;
        epg_host_udp_seal_write(&client->seal, EPG_HOST_UDP_TO_TARGET, client->counter, client->sent,
                                EPG_HOST_UDP_HEADER + size);
    }
    client->sent_size = head + EPG_HOST_UDP_HEADER + size;
    client_send(client, client->sent, client->sent_size);
}

/** Encodes the message of a command.  Returns the size of the frame. */
static size_t encode(const char *line, unsigned char *frame)
{
    unsigned char message[300] = {'C', 1};
    const size_t length = 2 + strlen(line);
    memcpy(message + 2, line, length - 2);
    uint32_t crc = EPG_CONSOLE_CRC_START;
    for (size_t i = 0; i < length; i++) {
        crc = epg_console_crc(crc, message[i]);
    }
    for (size_t i = 0; i < EPG_CONSOLE_FRAME_CRC; i++) {
        message[length + i] = (unsigned char)(~crc >> 8U * i);
    }
    size_t size = 1;
    size_t code = size++;
    frame[0] = 0;
    for (size_t i = 0; i < length + EPG_CONSOLE_FRAME_CRC; i++) {
        if (message[i] == 0) {
            frame[code] = (unsigned char)(size - code);
            code = size++;
        } else {
            frame[size++] = message[i];
        }
    }
    frame[code] = (unsigned char)(size - code);
    frame[size++] = 0;
    return size;
}

void client_command(client_t *client, const char *line)
{
    unsigned char frame[320];
    const size_t size = encode(line, frame);
    const bool stops = strncmp(line, "disable", 7) == 0;
    client->number++;
    client_send_program(client, stops ? EPG_HOST_UDP_DISABLE : 0, client->number, frame, size);
}

size_t client_receive(client_t *client)
{
    const ssize_t count = recv(client->file, client->got, CLIENT_LONGEST, MSG_DONTWAIT);
    client->got_size = count > 0 ? (size_t)count : 0;
    client->got[client->got_size] = 0;
    return client->got_size;
}

int client_flags(client_t *client)
{
    epg_host_udp_header_t header;
    const size_t size = client_receive(client);
    const size_t head = client->seals && epg_host_udp_is_sealed(client->got, size) ? EPG_HOST_UDP_SEAL : 0;
    if (!epg_host_udp_read_header(client->got + head, size - head, &header) || header.session != client->session) {
        return -1;
    }
    if (head > 0 && (header.flags & EPG_HOST_UDP_AGAIN) == 0 &&
        (!epg_host_udp_seal_is_of(&client->seal, client->got) ||
         !epg_host_udp_seal_proves(&client->seal, EPG_HOST_UDP_FROM_TARGET, client->got, size))) {
        return -1;
    }
    return header.flags;
}

bool client_hears(client_t *client, const char *text)
{
    while (client_receive(client) > 0) {
        for (size_t i = 0; i + strlen(text) <= client->got_size; i++) {
            if (memcmp(client->got + i, text, strlen(text)) == 0) {
                return true;
            }
        }
    }
    return false;
}

void client_take_key(client_t *client, const char *key)
{
    static const unsigned char unknown[EPG_HOST_UDP_NONCE];
    unsigned char own[EPG_HOST_UDP_NONCE] = "a client's";
    unsigned char bytes[EPG_HOST_UDP_KEY];
    own[15] = (unsigned char)client->session;
    CHECK(epg_host_udp_key_read(key, bytes));
    client->seals = true;
    epg_host_udp_seal_derive(&client->seal, bytes, own, unknown);
}

void client_begin(client_t *client)
{
    client_send_program(client, EPG_HOST_UDP_BEGIN, 0, NULL, 0);
    bench_run(1);
    if (client->seals) {
        unsigned char key[EPG_HOST_UDP_KEY];
        CHECK(client_flags(client) == EPG_HOST_UDP_AGAIN);
        CHECK(epg_host_udp_key_read(CLIENT_KEY, key));
        epg_host_udp_seal_derive(&client->seal, key, epg_host_udp_seal_of_program(client->got),
                                 epg_host_udp_seal_of_target(client->got));
        CHECK(epg_host_udp_seal_proves(&client->seal, EPG_HOST_UDP_FROM_TARGET, client->got, client->got_size));
        client_send_program(client, EPG_HOST_UDP_BEGIN, 0, NULL, 0);
        bench_run(1);
    }
    CHECK(client_flags(client) == EPG_HOST_UDP_RUNNING);
}

void client_enable(client_t *client)
{
    char line[80];
    const uint64_t number = fake_status().stop_number;
    (void)snprintf(line, sizeof line, "enable unattended after=%08x-%u", (unsigned int)(number >> 32U),
                   (unsigned int)number);
    client_command(client, line);
}
