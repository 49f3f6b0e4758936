/* Pins: RM0433, section 11. */
#include "main.h"
#include "registers.h"

void MX_GPIO_Init(void)
{
    RCC_AHB4ENR |= 1u << 3 | 1u << 4 | 1u << 5; /* ports D, E and F */
    (void)RCC_AHB4ENR;                          /* a peripheral needs two cycles after its clock is enabled */
    motor_direction(13, false);
    motor_direction(14, false);
    for (unsigned int pin = 13; pin <= 14; pin++) {
        GPIOF->moder = (GPIOF->moder & ~(3u << (2u * pin))) | 1u << (2u * pin);
    }
}

void motor_direction(unsigned int pin, bool high)
{
    GPIOF->bsrr = high ? 1u << pin : 1u << (pin + 16u);
}
