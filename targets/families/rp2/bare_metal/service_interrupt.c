/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The interrupt in which the communication side runs on bare metal.
 *
 * It is one of core 0's interrupts that belong to no peripheral and that software makes pending.  A hardware alarm
 * makes it pending periodically.  The alarm is claimed for this purpose alone; it is not one of the SDK's alarm pool.
 */
#include "../src/parts.h"

static struct {
    uint irq;
    uint alarm;
    uint32_t period_us;
    void (*handler)(void);
} service;

/**
 * Sets the alarm to one period from now.  An interrupt may delay this code until that time has passed; the SDK then
 * does not set the alarm, and this function tries again, with longer and longer times.
 */
static void set_alarm(void)
{
    absolute_time_t next = make_timeout_time_us(service.period_us);
    for (int attempt = 0; attempt < 8 && hardware_alarm_set_target(service.alarm, next); attempt++) {
        next = make_timeout_time_us(service.period_us << attempt);
    }
}

static void on_alarm(uint alarm)
{
    (void)alarm;
    epg_mcu_service_wake();
    set_alarm();
}

bool epg_family_service_claim(void (*handler)(void), uint32_t period_us)
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
    service.alarm = (uint)alarm;
    service.irq = (uint)irq;
    service.period_us = period_us;
    service.handler = handler;
    irq_set_exclusive_handler(service.irq, handler);
    irq_set_priority(service.irq, PICO_LOWEST_IRQ_PRIORITY);
    irq_set_enabled(service.irq, true);
    hardware_alarm_set_callback(service.alarm, on_alarm);
    set_alarm();
    return true;
}

void epg_family_service_pend(void)
{
    irq_set_pending(service.irq);
}

void epg_family_service_release(void)
{
    irq_set_enabled(service.irq, false);
    hardware_alarm_set_callback(service.alarm, NULL);
    hardware_alarm_unclaim(service.alarm);
    irq_remove_handler(service.irq, service.handler);
    user_irq_unclaim(service.irq);
}
