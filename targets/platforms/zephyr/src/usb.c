/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The transport `usb`: serial ports over USB (CDC ACM).  No function waits for the host.
 *
 * The purpose of a port is the property `label` of its devicetree node.  USB shows it as the name of the interface.
 */
#include "usb.h"

#include <zephyr/devicetree.h>
#include <zephyr/drivers/uart.h>
#include <zephyr/kernel.h>

#include "parts.h"

typedef struct port {
    epg_ring_t received;
    epg_ring_t sent;
    epg_zephyr_lines_t lines;
    bool open; /* a program on the host had the port open at the last poll */
} port_t;

static bool is_open(const port_t *port)
{
    uint32_t dtr = 0;
    return uart_line_ctrl_get(port->lines.device, UART_LINE_CTRL_DTR, &dtr) == 0 && dtr != 0U;
}

static bool start(void *context, const char *title)
{
    port_t *port = context;
    ARG_UNUSED(title);
    port->open = false;
    return epg_zephyr_ready(port->lines.device) && epg_zephyr_usb_device_start() &&
           epg_zephyr_lines_start(&port->lines);
}

/**
 * Drops the bytes that a program has not read when it closed the port: they are not for the next program.  Bytes in
 * Zephyr's own buffer (tx-fifo-size of the node) remain.  The bytes that it has sent are kept, because they can be a stop.
 */
static void drop_sent(port_t *port)
{
    const unsigned int key = irq_lock(); /* the interrupt takes bytes from this ring, too */
    port->sent.taken_at = port->sent.put_at;
    atomic_store(&port->sent.taken, atomic_load(&port->sent.put));
    irq_unlock(key);
}

static void poll(void *context)
{
    port_t *port = context;
    const bool open = is_open(port);
    if (port->open && !open) {
        drop_sent(port);
    }
    port->open = open;
    epg_zephyr_lines_go_on(&port->lines);
}

static void flush(void *context)
{
    const port_t *port = context;
    epg_zephyr_lines_send(&port->lines);
}

/* True if a program on the host reads the port: most terminals and agents set the DTR line when they open it. */
static bool connected(void *context)
{
    const port_t *port = context;
    return port->open;
}

static size_t read(void *context, void *data, size_t size)
{
    port_t *port = context;
    const size_t count = epg_ring_read(&port->received, data, size);
    epg_zephyr_lines_go_on(&port->lines);
    return count;
}

static size_t write(void *context, const void *data, size_t size)
{
    port_t *port = context;
    return port->open ? epg_ring_write(&port->sent, data, size) : 0U;
}

static size_t writable(void *context)
{
    const port_t *port = context;
    return port->open ? epg_ring_room(&port->sent) : 0U;
}

#define PORT_DEFINE(name, node)                                                                                        \
    static unsigned char name##_received[CONFIG_EPG_USB_RECEIVE_SIZE];                                                 \
    static unsigned char name##_sent[CONFIG_EPG_USB_SEND_SIZE];                                                        \
    static port_t name##_port = {                                                                                      \
        .received = {.bytes = name##_received, .size = sizeof name##_received},                                        \
        .sent = {.bytes = name##_sent, .size = sizeof name##_sent},                                                    \
        .lines = {.device = DEVICE_DT_GET(node),                                                                       \
                  .received = &name##_port.received,                                                                   \
                  .sent = &name##_port.sent,                                                                           \
                  .back_pressure = true},                                                                              \
    };                                                                                                                 \
    const epg_transport_t epg_zephyr_##name = {                                                                        \
        .start = start,                                                                                                \
        .poll = poll,                                                                                                  \
        .flush = flush,                                                                                                \
        .stream =                                                                                                      \
            {.connected = connected, .read = read, .write = write, .writable = writable, .context = &name##_port},     \
    }

PORT_DEFINE(usb, DT_NODELABEL(epg_usb));
#if DT_NODE_HAS_STATUS_OKAY(DT_NODELABEL(epg_usb_second))
PORT_DEFINE(usb_second, DT_NODELABEL(epg_usb_second));
#endif
