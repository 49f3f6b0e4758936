/*
 * The cases.  A test selects one by its name: it lets the emulator write the address of the function to `request`.
 * Arguments and results are in memory.
 */
#ifndef CASES_H
#define CASES_H

#include <stdint.h>

extern volatile uint32_t arguments[8];
extern volatile uint32_t results[64];

void case_two_cores(void);
void case_divide_on_both(void);
void case_events(void);
void case_interrupt_of_core_1(void);
void case_masked_sleep(void);
void case_nested(void);
void case_fault(void);
void case_fault_of_core_1(void);
void case_flash(void);
void case_from_flash(void);
void case_from_ram(void);
void case_read_times(void);
void case_contention(void);
void case_pio_wave(void);
void case_pio_shift(void);
void case_pio_flags(void);
void case_pio_latency(void);
void case_pwm(void);
void case_pwm_registers(void);
void case_pwm_tick(void);
void case_alarm(void);
void case_systick(void);
void case_watchdog(void);
void case_pins(void);

#endif
