/**
 * @file
 * A port layer whose clock and signals a test sets and reads.  Using a peripheral that was not started fails the test.
 */
#ifndef FAKE_PORT_H
#define FAKE_PORT_H

#include "epg/outputs.h"
#include "epg/port.h"
#include "epg/port_uart.h"

enum { FAKE_UNITS = 8, FAKE_PINS = 32, FAKE_STORE = 1024, FAKE_BOOT_ID = 0x1234567 };

typedef struct fake_port {
    uint64_t now_ns;             /**< result of epg_port_time_ns() */
    uint32_t counts[FAKE_UNITS]; /**< counts of the quadrature decoders */
    uint32_t levels[FAKE_UNITS]; /**< levels of the PWM outputs, as written last */
    uint32_t tops[FAKE_UNITS];   /**< TOP values with which the outputs were started */
    bool outputs[FAKE_PINS];
    bool inputs[FAKE_PINS];
    epg_port_pull_t pulls[FAKE_PINS];
    bool decoders_started[FAKE_UNITS];
    bool decoders_failed[FAKE_UNITS]; /**< decoders that report a failure */
    bool pwms_started[FAKE_UNITS];
    bool outputs_started[FAKE_PINS];
    bool inputs_started[FAKE_PINS];
    unsigned char store[FAKE_STORE];
    size_t store_size;      /**< number of stored bytes; 0: nothing is stored */
    bool store_refuses;     /**< every request to store fails */
    epg_outputs_t *guarded; /**< NULL: no write is refused; rows are numbers of pins */
    uint32_t refuses;       /**< pins whose writes are refused, one bit each */
    uint32_t refused;       /**< pins whose writes have been refused so far */
    epg_take_over_t take_over;
    unsigned int writes;    /**< number of writes of PWM levels and pins */
    void (*on_write)(void); /**< called after each write, so that the test sees every change */
} fake_port_t;

extern fake_port_t fake_port;

/** Sets everything to zero. */
void fake_port_reset(void);

#endif
