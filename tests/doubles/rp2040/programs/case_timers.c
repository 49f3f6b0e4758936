/* TIMER, SysTick and watchdog. */
#include "cases.h"
#include "hardware/exception.h"
#include "hardware/irq.h"
#include "hardware/structs/systick.h"
#include "hardware/timer.h"
#include "hardware/watchdog.h"
#include "pico/stdlib.h"

static void on_alarm(uint alarm)
{
    results[0] = time_us_32();
    results[2] = alarm;
}

/* An alarm after arguments[0] microseconds.  Results: the time at which it came, and its number. */
void case_alarm(void)
{
    const uint32_t number = 2;
    hardware_alarm_claim(number);
    hardware_alarm_set_callback(number, on_alarm);
    results[1] = time_us_32() + arguments[0];
    hardware_alarm_set_target(number, from_us_since_boot(results[1]));
    busy_wait_us(arguments[0] + 10u);
    hardware_alarm_set_callback(number, NULL);
    hardware_alarm_unclaim(number);
}

static void on_systick(void)
{
    results[0]++;
}

/* SysTick every arguments[0] cycles, for arguments[1] microseconds, from the processor's clock. */
void case_systick(void)
{
    results[0] = 0;
    const exception_handler_t before = exception_set_exclusive_handler(SYSTICK_EXCEPTION, on_systick);
    systick_hw->rvr = arguments[0] - 1u;
    systick_hw->cvr = 0;
    systick_hw->csr = 7;
    busy_wait_us(arguments[1]);
    const uint32_t first = systick_hw->cvr;
    const uint32_t second = systick_hw->cvr;
    systick_hw->csr = 0;
    results[1] = first - second;
    exception_restore_handler(SYSTICK_EXCEPTION, before);
}

/* Feeds a watchdog of arguments[0] ms arguments[1] times, then lets it time out.  0 ms: watchdog_reboot(). */
void case_watchdog(void)
{
    watchdog_hw->scratch[0] = 0x12345678;
    if (arguments[0] == 0) {
        watchdog_reboot(0, 0, 1);
    } else {
        watchdog_enable(arguments[0], true);
    }
    for (uint32_t n = 0; n < arguments[1]; n++) {
        busy_wait_us(arguments[0] * 500u);
        watchdog_update();
        results[0] = n + 1u;
    }
    for (;;) {
        tight_loop_contents();
    }
}
