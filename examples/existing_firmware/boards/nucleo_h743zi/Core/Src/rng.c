/* Random numbers: RM0433, section 34. The generator's clock is HSI48, which is off after a reset (section 8.7.21). */
#include "main.h"
#include "registers.h"

#define CR_HSI48ON (1u << 12)
#define AHB2ENR_RNGEN (1u << 6)
#define RNG_ON (1u << 2)
#define WORD_READY (1u << 0)

uint32_t random_number(void)
{
    RCC_CR |= CR_HSI48ON;
    RCC_AHB2ENR |= AHB2ENR_RNGEN;
    (void)RCC_AHB2ENR;
    RNG->cr = RNG_ON;
    for (int i = 0; i < 10000; i++) {
        if ((RNG->sr & WORD_READY) != 0u) {
            return RNG->dr;
        }
    }
    return 0;
}
