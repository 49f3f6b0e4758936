/**
 * @file
 * A port layer whose clock and signals a test sets and sees.  Using a peripheral that was not started fails the test.
 */
#ifndef FAKE_PORT_H
#define FAKE_PORT_H

#include "epg/outputs.h"
#include "epg/port.h"
#include "epg/port_uart.h"

enum { FAKE_UNITS = 8, FAKE_PINS = 32, FAKE_STORE = 1024 };

typedef struct fake_port {
    uint64_t now_ns;             /**< what epg_port_time_ns() returns */
    uint32_t counts[FAKE_UNITS]; /**< of the quadrature decoders */
    uint32_t levels[FAKE_UNITS]; /**< of the PWM outputs, as written last */
    uint32_t tops[FAKE_UNITS];   /**< as started */
    bool outputs[FAKE_PINS];
    bool inputs[FAKE_PINS];
    epg_port_pull_t pulls[FAKE_PINS];
    bool decoders_started[FAKE_UNITS];
    bool decoders_failed[FAKE_UNITS]; /**< as they say of themselves */
    bool pwms_started[FAKE_UNITS];
    bool outputs_started[FAKE_PINS];
    bool inputs_started[FAKE_PINS];
    unsigned char store[FAKE_STORE];
    size_t store_size;      /**< bytes stored; 0: nothing */
    bool store_refuses;     /**< nothing can be stored */
    epg_outputs_t *guarded; /**< NULL: no write is refused; rows are numbers of pins */
    uint32_t refuses;       /**< pins whose writes are refused, one bit each, */
    uint32_t refused;       /**< and those whose writes have been */
    epg_take_over_t take_over;
    unsigned int writes;    /**< of PWM levels and pins */
    void (*on_write)(void); /**< called after each of them: nothing happens unseen */
} fake_port_t;

extern fake_port_t fake_port;

/** Everything to zero. */
void fake_port_reset(void);

#endif
