/* The station: names of its pins, and what its files share. */
#ifndef MAIN_H
#define MAIN_H

#include <stdint.h>

#include "stm32h7xx.h"

#define LD1_Pin 0U /* PB0: green */
#define LD1_GPIO_Port GPIOB
#define B1_Pin 13U /* PC13 */
#define B1_GPIO_Port GPIOC

/** Milliseconds since the start, counted by SysTick. */
extern volatile uint32_t uwTick;

/** Number of times that B1 was pressed. */
extern volatile uint32_t presses;

void Error_Handler(void);

#endif
