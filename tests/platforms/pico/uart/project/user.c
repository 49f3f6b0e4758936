/* A user's program that interferes with the target's serial line; the test selects how, through variables. */
#include <stdint.h>

#include "epg/pico.h"
#include "hardware/irq.h"
#include "hardware/sync.h"
#include "pico/stdlib.h"
#include "wired.h"

enum { FIRST_USER_INTERRUPT = 26, INTERRUPTS = 32, TIME_MS = 10 };

volatile uint32_t stdio_first; /* take the UART before the target does */
volatile uint32_t interrupts_off;
volatile uint32_t service_off;

volatile uint32_t started;
volatile uint32_t error;
volatile uint32_t lost;

static void without_interrupts(void)
{
    const uint32_t state = save_and_disable_interrupts();
    busy_wait_ms(TIME_MS);
    restore_interrupts(state);
}

/* The UART's interrupt still runs, communication does not. */
static void without_service(void)
{
    uint32_t disabled = 0;
    for (uint number = FIRST_USER_INTERRUPT; number < INTERRUPTS; number++) {
        if (irq_is_enabled(number)) {
            disabled |= 1U << number;
            irq_set_enabled(number, false);
        }
    }
    busy_wait_ms(TIME_MS);
    irq_set_mask_enabled(disabled, true);
}

int main(void)
{
    if (stdio_first != 0U) {
        stdio_init_all();
    }
    started = wired_start() ? 1U : 0U;
    for (;;) {
        if (interrupts_off != 0U) {
            without_interrupts();
            interrupts_off = 0;
        }
        if (service_off != 0U) {
            without_service();
            service_off = 0;
        }
        epg_pico_status_t status;
        epg_pico_status(&status);
        error = (uint32_t)status.error;
        lost = status.transport_lost;
    }
}
