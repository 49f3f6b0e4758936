/* The station on the Nucleo-H743ZI: starts the drivers and the turntable's controller, which a user reaches through the
 * serial port of the ST-LINK. The motor stays off until the user enables it there. */
#include "main.h"
#include "turntable_firmware.h"

void TIM6_DAC_IRQHandler(void);
void HardFault_Handler(void);

int main(void)
{
    MX_GPIO_Init();
    MX_TIM1_Init(TURNTABLE_MOTOR_PRESCALER, TURNTABLE_MOTOR_TOP);
    MX_TIM4_Init();
    MX_TIM5_Init();
    MX_USART3_UART_Init();
    if (!turntable_start()) {
        return 1;
    }
    MX_TIM6_Init();
    for (;;) {
        turntable_communicate();
    }
}

void TIM6_DAC_IRQHandler(void)
{
    tick_acknowledge();
    turntable_cycle();
}

void HardFault_Handler(void)
{
    turntable_safe();
    for (;;) {
    }
}
