/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The timers of STM32H7, and the clocks of timers and ports.
 *
 * `masters` are the timers whose trigger output is ITR0 ... ITR3 of a timer: RM0433, tables "TIMx internal trigger
 * connection" of the chapters on TIM1/TIM8, TIM2 to TIM5, TIM12 to TIM14 and TIM15 to TIM17.  ITR2 and ITR3 of TIM12 and
 * TIM15 are connected to outputs OC1, not to trigger outputs.
 */
#include "../parts.h"

#define TIMER(number, bus, bus_name, freeze_register)                                                                  \
    .registers = TIM##number, .enable = &RCC->bus##ENR, .enable_bit = RCC_##bus##ENR_TIM##number##EN,                  \
    .freeze = &DBGMCU->freeze_register, .freeze_bit = DBGMCU_##freeze_register##_DBG_TIM##number
#define APB1(number) TIMER(number, APB1L, apb1, APB1LFZ1)
#define APB2(number) TIMER(number, APB2, apb2, APB2FZ1), .on_apb2 = true, .has_break = true

static const epg_stm32_timer_t timers[] EPG_STM32_CYCLE_TABLE = {
    [1] = {APB2(1), .interrupt = TIM1_UP_IRQn, .is_trigger = true, .masters = {15, 2, 3, 4}},
    [2] = {APB1(2), .interrupt = TIM2_IRQn, .is_trigger = true, .masters = {1, 8, 3, 4}, .has_32_bits = true},
    [3] = {APB1(3), .interrupt = TIM3_IRQn, .is_trigger = true, .masters = {1, 2, 15, 4}},
    [4] = {APB1(4), .interrupt = TIM4_IRQn, .is_trigger = true, .masters = {1, 2, 3, 8}},
    [5] = {APB1(5), .interrupt = TIM5_IRQn, .is_trigger = true, .masters = {1, 8, 3, 4}, .has_32_bits = true},
    [6] = {APB1(6), .interrupt = TIM6_DAC_IRQn},
    [7] = {APB1(7), .interrupt = TIM7_IRQn},
    [8] = {APB2(8), .interrupt = TIM8_UP_TIM13_IRQn, .is_trigger = true, .masters = {1, 2, 4, 5}},
    [12] = {APB1(12), .interrupt = TIM8_BRK_TIM12_IRQn, .is_trigger = true, .masters = {4, 5}},
    [13] = {APB1(13), .interrupt = TIM8_UP_TIM13_IRQn},
    [14] = {APB1(14), .interrupt = TIM8_TRG_COM_TIM14_IRQn},
    [15] = {APB2(15), .interrupt = TIM15_IRQn, .is_trigger = true, .masters = {1, 3}},
    [16] = {APB2(16), .interrupt = TIM16_IRQn},
    [17] = {APB2(17), .interrupt = TIM17_IRQn},
};

const epg_stm32_timer_t *EPG_STM32_CYCLE(epg_stm32_timer)(uint32_t number)
{
    return number < sizeof timers / sizeof timers[0] && timers[number].registers != NULL ? &timers[number] : NULL;
}

void epg_stm32_enable_port(uint32_t port)
{
    const uint32_t before = epg_stm32_enter();
    RCC->AHB4ENR |= RCC_AHB4ENR_GPIOAEN << port;
    (void)RCC->AHB4ENR;
    epg_stm32_leave(before);
}

/* Interrupts of peripherals that few programs use.  A program that uses one of them has enabled its interrupt. */
const IRQn_Type epg_one_core_spare_interrupts[] = {SWPMI1_IRQn, CEC_IRQn, SAI4_IRQn, JPEG_IRQn, (IRQn_Type)-1};
