/* The state of the core before main(): the FPU is on. */
#include "stm32h7xx.h"

uint32_t SystemCoreClock = 64000000U; /* HSI, after a reset */

void SystemInit(void)
{
    SCB->CPACR |= 0xFU << 20; /* full access to CP10 and CP11 (PM0253, 4.7.1) */
    RCC->AHB2ENR |= RCC_AHB2ENR_D2SRAM1EN | RCC_AHB2ENR_D2SRAM2EN | RCC_AHB2ENR_D2SRAM3EN;
    (void)RCC->AHB2ENR;
}
