/* The handlers of the program's exceptions and interrupts. */
#include "stm32h7xx_it.h"

#include "main.h"

/* Exceptions of the core --------------------------------------------------------------------------------------- */

void NMI_Handler(void)
{
    while (1) {
    }
}

void HardFault_Handler(void)
{
    while (1) {
    }
}

void MemManage_Handler(void)
{
    while (1) {
    }
}

void BusFault_Handler(void)
{
    while (1) {
    }
}

void UsageFault_Handler(void)
{
    while (1) {
    }
}

void SVC_Handler(void)
{
}

void DebugMon_Handler(void)
{
}

void PendSV_Handler(void)
{
}

void SysTick_Handler(void)
{
    uwTick++;
}

/* Interrupts of peripherals ------------------------------------------------------------------------------------ */

void EXTI15_10_IRQHandler(void)
{
    EXTI->PR1 = 1U << B1_Pin;
    presses++;
}
