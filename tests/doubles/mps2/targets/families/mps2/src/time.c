/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The clock: the dual timer, with 16 bits that count every 640 ns, extended in its interrupt; it wraps every 42 ms.
 */
#include "epg/one_core.h"
#include "parts.h"

static volatile uint32_t wraps;
static bool started;

static void on_wrap(void)
{
    DUALTIMER->clear = 1U;
    wraps++;
}

static void start(void)
{
    started = true;
    DUALTIMER->control = 0U;
    DUALTIMER->load = 0xFFFFU;
    (void)epg_one_core_set_handler(DUALTIMER_IRQn, on_wrap);
    NVIC_SetPriority(DUALTIMER_IRQn, 1U);
    NVIC_EnableIRQ(DUALTIMER_IRQn);
    DUALTIMER->control = 0xA4U; /* on, free-running, interrupt, divided by 16, 16 bits */
}

uint64_t mps2_clock(void)
{
    if (!started) {
        start();
    }
    uint32_t before = 0;
    uint32_t pending = 0;
    uint32_t value = 0;
    /* At most three times: the wrap and its interrupt can each come once in between. */
    for (int attempt = 0; attempt < 3; attempt++) {
        before = wraps;
        pending = DUALTIMER->raw & 1U;
        value = DUALTIMER->value;
        if (before == wraps && pending == (DUALTIMER->raw & 1U)) {
            break;
        }
    }
    return ((uint64_t)(before + pending) << 16U) + ((0U - value) & 0xFFFFU); /* the wrap is at 0 */
}

uint64_t epg_one_core_time_ns(void)
{
    return mps2_clock() * EPG_ONE_CORE_TIME_NS;
}
