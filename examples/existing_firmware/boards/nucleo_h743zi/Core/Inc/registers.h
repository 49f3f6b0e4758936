/** @file The registers that the drivers use, with the names of RM0433. */
#ifndef REGISTERS_H
#define REGISTERS_H

#include <stdint.h>

#define REGISTER(address) (*(volatile uint32_t *)(address))

/* Reset and clock control: RM0433, section 8.7 */
#define RCC_CR REGISTER(0x58024400u)
#define RCC_AHB2ENR REGISTER(0x580244DCu)
#define RCC_AHB4ENR REGISTER(0x580244E0u)
#define RCC_APB1LENR REGISTER(0x580244E8u)
#define RCC_APB2ENR REGISTER(0x580244F0u)

/* Ports of pins: section 11.4 */
typedef struct gpio {
    volatile uint32_t moder, otyper, ospeedr, pupdr, idr, odr, bsrr, lckr, afrl, afrh;
} gpio_t;
#define GPIOD ((gpio_t *)0x58020C00u)
#define GPIOE ((gpio_t *)0x58021000u)
#define GPIOF ((gpio_t *)0x58021400u)

/* Timers: sections 38.4 (TIM1), 39.4 (TIM2 to TIM5) and 42.4 (TIM6) */
typedef struct tim {
    volatile uint32_t cr1, cr2, smcr, dier, sr, egr, ccmr1, ccmr2, ccer, cnt, psc, arr, rcr, ccr1, ccr2, ccr3, ccr4,
        bdtr;
} tim_t;
#define TIM1 ((tim_t *)0x40010000u)
#define TIM4 ((tim_t *)0x40000800u)
#define TIM5 ((tim_t *)0x40000C00u)
#define TIM6 ((tim_t *)0x40001000u)

/* Serial ports: section 48.7 */
typedef struct usart {
    volatile uint32_t cr1, cr2, cr3, brr, gtpr, rtor, rqr, isr, icr, rdr, tdr, presc;
} usart_t;
#define USART3 ((usart_t *)0x40004800u)

/* Random number generator: section 34.7 */
typedef struct rng {
    volatile uint32_t cr, sr, dr;
} rng_t;
#define RNG ((rng_t *)0x48021800u)

/* Interrupt controller: PM0253, section 4.2. One byte of priority per interrupt, of which the upper four bits count. */
#define NVIC_ISER ((volatile uint32_t *)0xE000E100u)
#define NVIC_IPR ((volatile uint8_t *)0xE000E400u)

static inline void interrupt_enable(unsigned int number, unsigned int priority)
{
    NVIC_IPR[number] = (uint8_t)(priority << 4);
    NVIC_ISER[number / 32u] = 1u << (number % 32u);
}

/** Selects an alternate function, in MODER and AFRL or AFRH. */
static inline void pin_function(gpio_t *port, unsigned int pin, uint32_t function)
{
    volatile uint32_t *afr = pin < 8u ? &port->afrl : &port->afrh;
    const unsigned int shift = 4u * (pin % 8u);
    *afr = (*afr & ~(0xFu << shift)) | function << shift;
    port->moder = (port->moder & ~(3u << (2u * pin))) | 2u << (2u * pin);
}

#endif
