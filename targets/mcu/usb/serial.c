/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The transport `usb`: serial ports over USB (CDC ACM).  No function waits for the host.
 */
#include "epg/usb.h"

const char *epg_usb_titles[EPG_USB_PORTS];

/** The number of a port in TinyUSB.  The transport's `context` contains it in place of a pointer. */
static uint8_t number_of(const void *context)
{
    return (uint8_t)(uintptr_t)context;
}

static bool start(void *context, const char *title)
{
    epg_usb_titles[number_of(context)] = title;
    /* The device can run already: for the other port, or since an earlier start of the target. */
    return tud_inited() || epg_usb_family_start();
}

static void poll(void *context)
{
    if (number_of(context) == 0U) {
        tud_task(); /* for both ports */
    }
}

static void flush(void *context)
{
    tud_cdc_n_write_flush(number_of(context));
}

/* True if a program on the host reads the port: most terminals and agents set the DTR line when they open it. */
static bool connected(void *context)
{
    return tud_cdc_n_connected(number_of(context));
}

static size_t read(void *context, void *data, size_t size)
{
    return tud_cdc_n_read(number_of(context), data, size);
}

static size_t write(void *context, const void *data, size_t size)
{
    const uint8_t number = number_of(context);
    return tud_cdc_n_connected(number) ? tud_cdc_n_write(number, data, size) : 0U;
}

static size_t writable(void *context)
{
    const uint8_t number = number_of(context);
    return tud_cdc_n_connected(number) ? tud_cdc_n_write_available(number) : 0U;
}

/**
 * Called by TinyUSB.  When a program closes the port, the bytes that it has not read are dropped: they are not for the
 * next program.  The bytes that it has sent are kept, because they can be a stop.
 */
void tud_cdc_line_state_cb(uint8_t number, bool dtr, bool rts)
{
    (void)rts;
    if (!dtr) {
        tud_cdc_n_write_clear(number);
    }
}

const epg_transport_t epg_usb = {
    .start = start,
    .poll = poll,
    .flush = flush,
    .stream = {.connected = connected, .read = read, .write = write, .writable = writable, .context = NULL},
};

#if EPG_USB_PORTS == 2
const epg_transport_t epg_usb_second = {
    .start = start,
    .poll = poll,
    .flush = flush,
    .stream = {.connected = connected, .read = read, .write = write, .writable = writable, .context = (void *)1},
};
#endif
