/**
 * @file
 * Communication on bare metal: an interrupt of lowest priority on core 0, so that main() stays the user's.
 *
 * A hardware alarm of its own (not the SDK's alarm pool) asks for it every millisecond, and a transport's interrupt
 * asks for it at once.  All other interrupts, and whatever they do for the user, go before it.
 */
#include "parts.h"

#define PERIOD_US 1000U

static struct {
    void (*serve)(void);
    uint irq;
    uint alarm;
} service;

/** Asks for the service, from any interrupt of core 0. */
void epg_pico_service_wake(void)
{
    if (service.serve != NULL) {
        irq_set_pending(service.irq);
    }
}

static void on_service(void)
{
    service.serve();
}

/** Next time in whole periods from the present one: it may have passed already when an interrupt came in between. */
static void set_alarm(void)
{
    absolute_time_t next = make_timeout_time_us(PERIOD_US);
    for (int attempt = 0; attempt < 8 && hardware_alarm_set_target(service.alarm, next); attempt++) {
        next = make_timeout_time_us(PERIOD_US << attempt);
    }
}

static void on_alarm(uint alarm)
{
    (void)alarm;
    epg_pico_service_wake();
    set_alarm();
}

bool epg_pico_service_start(void (*serve)(void))
{
    const int alarm = hardware_alarm_claim_unused(false);
    const int irq = user_irq_claim_unused(false);
    if (alarm < 0 || irq < 0) {
        if (alarm >= 0) {
            hardware_alarm_unclaim((uint)alarm);
        }
        if (irq >= 0) {
            user_irq_unclaim((uint)irq);
        }
        return false;
    }
    service.serve = serve;
    service.alarm = (uint)alarm;
    service.irq = (uint)irq;
    irq_set_exclusive_handler(service.irq, on_service);
    irq_set_priority(service.irq, PICO_LOWEST_IRQ_PRIORITY);
    irq_set_enabled(service.irq, true);
    hardware_alarm_set_callback(service.alarm, on_alarm);
    set_alarm();
    return true;
}

void epg_pico_service_stop(void)
{
    if (service.serve != NULL) {
        hardware_alarm_set_callback(service.alarm, NULL);
        hardware_alarm_unclaim(service.alarm);
        irq_set_enabled(service.irq, false);
        irq_remove_handler(service.irq, on_service);
        user_irq_unclaim(service.irq);
        service.serve = NULL;
    }
}

void epg_pico_service_stack(uint32_t *size, uint32_t *used)
{
    *size = 0;
    *used = 0;
}
