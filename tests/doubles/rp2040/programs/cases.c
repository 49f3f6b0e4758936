#include "cases.h"

#include "hardware/gpio.h"
#include "hardware/watchdog.h"
#include "pico/stdlib.h"

volatile uint32_t arguments[8];
volatile uint32_t results[64];
volatile uint32_t request; /* address of a case */
volatile uint32_t done;
volatile uint32_t starts
    __attribute__((section(".uninitialized_data.starts"))); /* kept during a reset by the watchdog */

typedef void (*case_t)(void);

static const case_t all_cases[] = {
    case_two_cores, case_divide_on_both,  case_events, case_interrupt_of_core_1, case_masked_sleep, case_nested,
    case_fault,     case_fault_of_core_1, case_flash,  case_from_flash,          case_from_ram,     case_pio_wave,
    case_pio_shift, case_pio_flags,       case_pwm,    case_pwm_registers,       case_pwm_tick,     case_alarm,
    case_systick,   case_watchdog,        case_pins,   case_pio_latency,         case_read_times,   case_contention,
};

/* A pin as the arguments set it: pin, direction, level, pulls. */
void case_pins(void)
{
    const uint32_t pin = arguments[0];
    gpio_init(pin);
    gpio_set_dir(pin, arguments[1] != 0);
    gpio_put(pin, arguments[2] != 0);
    gpio_set_pulls(pin, (arguments[3] & 1u) != 0, (arguments[3] & 2u) != 0);
    busy_wait_at_least_cycles(10);
    results[0] = gpio_get(pin);
}

int main(void)
{
    starts++;
    results[60] = watchdog_caused_reboot();
    results[61] = watchdog_enable_caused_reboot();
    for (;;) {
        if (request == 0) {
            continue;
        }
        const uintptr_t wanted = request | 1u;
        request = 0;
        for (size_t n = 0; n < sizeof all_cases / sizeof all_cases[0]; n++) {
            if ((uintptr_t)all_cases[n] == wanted) {
                all_cases[n]();
                done++;
            }
        }
    }
}
