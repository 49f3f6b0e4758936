/* Echoes the bytes of each serial port, with the port's number before each line. */
#include "epg/pico.h"
#include "parts.h"

#define LINE 256

typedef struct port {
    const epg_transport_t *transport;
    const char *title;
    char name;
    char line[LINE];
    size_t length;
} port_t;

static port_t ports[] = {
    {.transport = &epg_pico_usb, .title = "EPG ROS 2", .name = '1'},
#if EPG_PICO_USB_PORTS == 2
    {.transport = &epg_pico_usb_second, .title = "EPG console", .name = '2'},
#endif
};
enum { PORTS = sizeof ports / sizeof ports[0] };

/* The parts of the port layer that the device uses. */
volatile uint32_t outputs_off;

void epg_pico_outputs_off(void)
{
    outputs_off++;
}

void epg_mcu_service_wake(void)
{
    __sev();
}

static void serve(port_t *port)
{
    const epg_stream_t *stream = &port->transport->stream;
    port->transport->poll(stream->context);
    char letter;
    while (port->length < LINE && stream->read(stream->context, &letter, 1) == 1) {
        port->line[port->length++] = letter;
        if (letter == '\n' || port->length == LINE) {
            const char head[] = {port->name, ':'};
            if (stream->writable(stream->context) >= port->length + sizeof head) {
                stream->write(stream->context, head, sizeof head);
                stream->write(stream->context, port->line, port->length);
            }
            port->length = 0;
        }
    }
    port->transport->flush(stream->context);
}

int main(void)
{
    for (int i = 0; i < PORTS; i++) {
        if (!ports[i].transport->start(ports[i].transport->stream.context, ports[i].title)) {
            panic("no USB");
        }
    }
    for (;;) {
        for (int i = 0; i < PORTS; i++) {
            serve(&ports[i]);
        }
        __wfe(); /* not WFI: the interrupt may have come already */
    }
}
