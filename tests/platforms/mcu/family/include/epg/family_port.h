/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A family without an SDK and without a chip: the minimum that `epg/family.h` allows.
 */
#ifndef EPG_FAMILY_PORT_H
#define EPG_FAMILY_PORT_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/target.h"
#include "epg/transport.h"

typedef struct epg_family_target {
    const epg_target_t *target;
    const epg_transport_t *transport;
    const char *transport_title;
    const epg_transport_t *console_transport;
} epg_family_target_t;

#define EPG_FAMILY_MIDDLEWARE_STACK 2048
#define EPG_FAMILY_FPU_FRAME 72
#define EPG_FAMILY_SERVICE_TIMEOUT_MS 500

void epg_family_panic(const char *format, ...) __attribute__((noreturn));
void epg_family_sleep(void);
bool epg_family_in_interrupt(void);
uint32_t epg_family_time_us(void);

#endif
