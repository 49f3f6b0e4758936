/**
 * @file
 * The transport `usb`: a serial port over USB (CDC ACM).  Nothing here waits for the host.
 */
#include "parts.h"
#include "usb.h"

static void on_interrupt(void)
{
    epg_pico_service_wake();
}

static bool start(void)
{
    if (tud_inited()) {
        return true; /* started before and stopped since: the device stays */
    }
    if (!tusb_init()) {
        return false;
    }
    /* Behind TinyUSB's own handler, which has put the event in its queue. */
    irq_add_shared_handler(USBCTRL_IRQ, on_interrupt, PICO_SHARED_IRQ_HANDLER_LOWEST_ORDER_PRIORITY);
    return true;
}

static void poll(void)
{
    tud_task();
}

static void flush(void)
{
    tud_cdc_write_flush();
}

/* Somebody has opened the port: terminals and agents set DTR. */
static bool connected(void *context)
{
    (void)context;
    return tud_cdc_connected();
}

static size_t read(void *context, void *data, size_t size)
{
    (void)context;
    return tud_cdc_read(data, size);
}

static size_t write(void *context, const void *data, size_t size)
{
    (void)context;
    return tud_cdc_connected() ? tud_cdc_write(data, size) : 0U;
}

static size_t writable(void *context)
{
    (void)context;
    return tud_cdc_connected() ? tud_cdc_write_available() : 0U;
}

/** Who opens the port next gets nothing that was meant for who has closed it. */
void tud_cdc_line_state_cb(uint8_t interface, bool dtr, bool rts)
{
    (void)interface;
    (void)rts;
    if (!dtr) {
        tud_cdc_write_clear();
        tud_cdc_read_flush();
    }
}

const epg_pico_transport_t epg_pico_usb = {
    .start = start,
    .poll = poll,
    .flush = flush,
    .stream = {.connected = connected, .read = read, .write = write, .writable = writable},
};
