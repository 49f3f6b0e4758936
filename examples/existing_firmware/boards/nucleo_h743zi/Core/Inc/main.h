/**
 * @file
 * The drivers of the Nucleo-H743ZI. All clocks are those after a reset: 64 MHz from the HSI (RM0433, section 8.5).
 *
 *   PE9          TIM1   PWM of the motor
 *   PF13, PF14          its direction
 *   PD12, PD13   TIM4   A and B of the encoder
 *   PD8, PD9     USART3 the serial port of the ST-LINK, 115200 baud
 *                TIM5   microseconds
 *                TIM6   tick, 1 kHz
 */
#ifndef MAIN_H
#define MAIN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TIMERS_HZ 64000000 /* kernel clock of all timers */

void MX_GPIO_Init(void);
void motor_direction(unsigned int pin, bool high); /* pin 13 or 14 of port F */

void MX_TIM1_Init(uint32_t prescaler, uint32_t top);
void MX_TIM4_Init(void);
void MX_TIM5_Init(void);
void MX_TIM6_Init(void); /* from here on, TIM6_DAC_IRQHandler() is called every millisecond */
void motor_pwm(uint32_t compare);
uint16_t encoder_count(void);
uint32_t microseconds(void);
void tick_acknowledge(void);

uint32_t random_number(void); /* takes 2 us; 0 if the generator has failed */

void MX_USART3_UART_Init(void);
size_t serial_read(void *data, size_t size);
size_t serial_write(const void *data, size_t size);

#endif
