/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The number of a start: a word of the random number generator RNG (RM0433, 34).
 *
 * The generator needs a clock of its own, which a program on STM32F7 may not have made.  Then the number comes from the
 * time of the call and the unique id of the chip, and two starts can have the same number.
 */
#include "parts.h"

/** Readings until a word must be there: 0.2 ms at 480 MHz.  RNG needs 54 of its clocks (RM0433, 34.3.5). */
#define READINGS 20000U

#define ERRORS (RNG_SR_SEIS | RNG_SR_CEIS | RNG_SR_SECS | RNG_SR_CECS)

/** FNV-1a */
#define PRIME 16777619U

static uint32_t boot_id;

static uint32_t random_word(void)
{
    for (uint32_t i = 0; i < READINGS; i++) {
        const uint32_t status = RNG->SR;
        if ((status & RNG_SR_DRDY) != 0U) {
            return (status & ERRORS) == 0U ? RNG->DR : 0U;
        }
    }
    return 0U;
}

/** Switches the generator and its clocks on, or off if they were off before. */
static void switch_generator(bool on)
{
    static bool had_clock;
    static bool ran;
    const uint32_t before = epg_stm32_enter();
    epg_stm32_random_clock(on);
    if (on) {
        had_clock = (RCC->AHB2ENR & RCC_AHB2ENR_RNGEN) != 0U;
        RCC->AHB2ENR |= RCC_AHB2ENR_RNGEN;
        (void)RCC->AHB2ENR;
        ran = (RNG->CR & RNG_CR_RNGEN) != 0U;
        RNG->CR |= RNG_CR_RNGEN;
    } else {
        RNG->CR &= ran ? ~0U : ~RNG_CR_RNGEN;
        (void)RNG->CR;
        RCC->AHB2ENR &= had_clock ? ~0U : ~RCC_AHB2ENR_RNGEN;
    }
    epg_stm32_leave(before);
}

static uint32_t mixed(void)
{
    const volatile uint32_t *id = (const volatile uint32_t *)UID_BASE;
    const uint32_t words[] = {DWT->CYCCNT, (uint32_t)epg_one_core_time_ns(), id[0], id[1], id[2]};
    uint32_t hash = 2166136261U;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        hash = (hash ^ words[i]) * PRIME;
    }
    return hash;
}

uint32_t epg_port_boot_id(void)
{
    if (boot_id == 0U) {
        switch_generator(true);
        boot_id = random_word();
        switch_generator(false);
    }
    if (boot_id == 0U) {
        boot_id = mixed() | 1U;
    }
    return boot_id;
}
