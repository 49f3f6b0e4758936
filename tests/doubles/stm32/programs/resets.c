/* SPDX-License-Identifier: Apache-2.0 */
/** @file Counts starts in memory that no start-up code clears and in a backup register, and starts the watchdog. */
#include "small.h"

enum { NOTHING, RESTART, START_WATCHDOG, FEED, CHANGE_CACHED };

__attribute__((section(".noinit"))) volatile uint32_t starts;
__attribute__((section(".axi"))) volatile uint32_t starts_in_axi;
volatile uint32_t command, causes, has_clock;
volatile uint32_t without_access;

int main(void)
{
    causes = RCC->RSR;
    RCC->RSR |= RCC_RSR_RMVF;
    RTC->BKP3R = 99;
    without_access = RTC->BKP3R;
    RCC->APB4ENR |= RCC_APB4ENR_RTCAPBEN;
    PWR->CR1 |= PWR_CR1_DBP;
    RTC->BKP3R += 1U;
    starts++;
    has_clock = RCC->CSR & RCC_CSR_LSIRDY;
    uint32_t feeding = 0;
    for (;;) {
        const uint32_t now = command;
        if (feeding != 0U)
            IWDG1->KR = 0xAAAA;
        if (now == NOTHING)
            continue;
        if (now == RESTART) {
            NVIC_SystemReset();
        } else if (now == START_WATCHDOG) {
            IWDG1->KR = 0xCCCC;
            IWDG1->KR = 0x5555;
            IWDG1->PR = 1;
            IWDG1->RLR = 99;
            while (IWDG1->SR != 0U) {
            }
            IWDG1->KR = 0xAAAA;
            feeding = 0;
        } else if (now == FEED) {
            feeding = 1;
        } else {
            SCB_EnableDCache();
            starts_in_axi += 1U;
        }
        has_clock = RCC->CSR & RCC_CSR_LSIRDY;
        command = NOTHING;
    }
}
