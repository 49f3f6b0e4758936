/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Quadrature decoders: timers in encoder mode (RM0433, 39.3.15).  A counter of 16 bits is extended to 32 bits at each
 * reading.  This is exact if it moves by less than 32768 counts between two readings.
 *
 * The timer itself notices if it moves farther, for example while a debugger has stopped the core: each reading puts the
 * compare value of channel 3 opposite to the counter, so that a movement by half of the range sets the flag CC3IF
 * (RM0433, 39.4.5: in the mode "frozen", a match only sets the flag).
 */
#include "epg/port.h"

#include "parts.h"

#define TIMERS 18U
/** Encoder mode 3: all edges of both inputs (RM0433, 39.4.3). */
#define ENCODER_MODE (TIM_SMCR_SMS_1 | TIM_SMCR_SMS_0)
/** Filters of both inputs: a level counts after 8 equal samples of the timer's clock (RM0433, 39.4.8, ICxF = 3). */
#define INPUTS (TIM_CCMR1_CC1S_0 | TIM_CCMR1_CC2S_0 | 3U << TIM_CCMR1_IC1F_Pos | 3U << TIM_CCMR1_IC2F_Pos)

/** Half of the range of a counter with 16 bits. */
#define OPPOSITE 0x8000U

typedef struct decoder {
    const epg_stm32_timer_t *timer; /* NULL: not started */
    TIM_TypeDef *registers;
    uint32_t count;
    bool has_32_bits;
    bool lost; /* the counter has moved by half of its range between two readings */
} decoder_t;

/* By the index of the instance in the chip's data. */
static decoder_t decoders[TIMERS] EPG_STM32_CYCLE_DATA;

void epg_port_quadrature_start(const epg_port_quadrature_t *decoder)
{
    decoder_t *state = &decoders[decoder->instance];
    const epg_stm32_timer_t *timer = epg_stm32_timer(epg_stm32_hardware.timers[decoder->instance]);
    TIM_TypeDef *registers = timer->registers;
    epg_stm32_enable_timer(timer);
    if (state->timer == NULL && (registers->CR1 & TIM_CR1_CEN) != 0U) {
        epg_stm32_resource_taken = true;
        return;
    }
    const epg_port_pull_t pull = decoder->pull_up ? EPG_PULL_UP : EPG_PULL_NONE;
    epg_stm32_connect(decoder->pin_a, pull);
    epg_stm32_connect(decoder->pin_b, pull);
    registers->CR1 = TIM_CR1_URS;
    registers->CR2 = 0U;
    registers->DIER = 0U;
    registers->CCER = 0U;
    registers->CCMR1 = INPUTS;
    registers->CCMR2 = 0U;
    registers->CCR3 = OPPOSITE;
    registers->SMCR = ENCODER_MODE;
    registers->PSC = 0U;
    registers->ARR = timer->has_32_bits ? 0xFFFFFFFFU : 0xFFFFU;
    registers->EGR = TIM_EGR_UG;
    registers->CNT = 0U;
    registers->SR = 0U;
    registers->CR1 |= TIM_CR1_CEN;
    *state = (decoder_t){.timer = timer, .registers = registers, .has_32_bits = timer->has_32_bits};
}

uint32_t EPG_STM32_CYCLE(epg_port_quadrature_count)(const epg_port_quadrature_t *decoder)
{
    decoder_t *state = &decoders[decoder->instance];
    if (state->timer == NULL) {
        return state->count;
    }
    TIM_TypeDef *registers = state->registers;
    const uint32_t now = registers->CNT;
    if (state->has_32_bits) {
        state->count = now;
        return now;
    }
    if ((registers->SR & TIM_SR_CC3IF) != 0U) {
        registers->SR = ~TIM_SR_CC3IF;
        state->lost = true;
    }
    registers->CCR3 = (now ^ OPPOSITE) & 0xFFFFU;
    state->count += (uint32_t)(int32_t)(int16_t)(uint16_t)(now - state->count);
    return state->count;
}

bool EPG_STM32_CYCLE(epg_port_quadrature_healthy)(const epg_port_quadrature_t *decoder)
{
    decoder_t *state = &decoders[decoder->instance];
    const epg_stm32_timer_t *timer = state->timer;
    if (state->lost) {
        state->lost = false; /* reported once: the position is wrong until the next reset, which the user decides on */
        return false;
    }
    return timer != NULL && (*timer->enable & timer->enable_bit) != 0U && (state->registers->CR1 & TIM_CR1_CEN) != 0U &&
           (state->registers->SMCR & TIM_SMCR_SMS_Msk) == ENCODER_MODE;
}

void epg_stm32_quadrature_stop_all(void)
{
    for (uint32_t number = 0; number < TIMERS; number++) {
        if (decoders[number].timer != NULL) {
            decoders[number].timer->registers->CR1 = 0U;
            decoders[number].timer->registers->SMCR = 0U;
            decoders[number].timer = NULL;
        }
    }
}
