/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The timers of STM32F7, and the clocks of timers and ports.
 *
 * `masters` are the timers whose trigger output is ITR0 ... ITR3 of a timer: RM0410, tables "TIMx internal trigger
 * connection" of the chapters on TIM1/TIM8, TIM2 to TIM5, and TIM9 to TIM14.  ITR2 and ITR3 of TIM9 and TIM12 are
 * connected to outputs OC, not to trigger outputs.  ITR1 of TIM2 can be switched to something else in TIM2_OR; TIM8 is
 * its source after a reset.
 */
#include "../parts.h"

#define TIMER(number, bus)                                                                                             \
    .registers = TIM##number, .enable = &RCC->bus##ENR, .enable_bit = RCC_##bus##ENR_TIM##number##EN,                  \
    .freeze = &DBGMCU->bus##FZ, .freeze_bit = DBGMCU_##bus##_FZ_DBG_TIM##number##_STOP
#define APB1(number) TIMER(number, APB1)
#define APB2(number) TIMER(number, APB2), .on_apb2 = true

static const epg_stm32_timer_t timers[] EPG_STM32_CYCLE_TABLE = {
    [1] = {APB2(1), .interrupt = TIM1_UP_TIM10_IRQn, .is_trigger = true, .masters = {5, 2, 3, 4}, .has_break = true},
    [2] = {APB1(2), .interrupt = TIM2_IRQn, .is_trigger = true, .masters = {1, 8, 3, 4}, .has_32_bits = true},
    [3] = {APB1(3), .interrupt = TIM3_IRQn, .is_trigger = true, .masters = {1, 2, 5, 4}},
    [4] = {APB1(4), .interrupt = TIM4_IRQn, .is_trigger = true, .masters = {1, 2, 3, 8}},
    [5] = {APB1(5), .interrupt = TIM5_IRQn, .is_trigger = true, .masters = {2, 3, 4, 8}, .has_32_bits = true},
    [6] = {APB1(6), .interrupt = TIM6_DAC_IRQn},
    [7] = {APB1(7), .interrupt = TIM7_IRQn},
    [8] = {APB2(8), .interrupt = TIM8_UP_TIM13_IRQn, .is_trigger = true, .masters = {1, 2, 4, 5}, .has_break = true},
    [9] = {APB2(9), .interrupt = TIM1_BRK_TIM9_IRQn, .is_trigger = true, .masters = {2, 3}},
    [10] = {APB2(10), .interrupt = TIM1_UP_TIM10_IRQn},
    [11] = {APB2(11), .interrupt = TIM1_TRG_COM_TIM11_IRQn},
    [12] = {APB1(12), .interrupt = TIM8_BRK_TIM12_IRQn, .is_trigger = true, .masters = {4, 5}},
    [13] = {APB1(13), .interrupt = TIM8_UP_TIM13_IRQn},
    [14] = {APB1(14), .interrupt = TIM8_TRG_COM_TIM14_IRQn},
};

const epg_stm32_timer_t *EPG_STM32_CYCLE(epg_stm32_timer)(uint32_t number)
{
    return number < sizeof timers / sizeof timers[0] && timers[number].registers != NULL ? &timers[number] : NULL;
}

void epg_stm32_enable_port(uint32_t port)
{
    const uint32_t before = epg_stm32_enter();
    RCC->AHB1ENR |= RCC_AHB1ENR_GPIOAEN << port;
    (void)RCC->AHB1ENR;
    epg_stm32_leave(before);
}

/* Interrupts of peripherals that few programs use.  A program that uses one of them has enabled its interrupt. */
const IRQn_Type epg_one_core_spare_interrupts[] = {CEC_IRQn, SPDIF_RX_IRQn, MDIOS_IRQn, JPEG_IRQn, (IRQn_Type)-1};
