/* SPDX-License-Identifier: Apache-2.0 */
/** @file Erases, programs and reads words of flash bank 2, one command of the test after another. */
#include "small.h"

enum { NOTHING, UNLOCK, ERASE, PROGRAM, READ, READ_GUARDED };
enum { WORDS = 8 };

volatile uint32_t command, address, value, status, bus_faults, words_read[WORDS], flags;

__attribute__((used)) static void skip_instruction(uint32_t *frame)
{
    bus_faults++;
    frame[6] += (*(const uint16_t *)frame[6] >> 11) >= 0x1DU ? 4U : 2U;
    SCB->CFSR = SCB->CFSR;
}

__attribute__((naked)) static void on_bus_fault(void)
{
    __ASM volatile("mov r0, sp\n b skip_instruction");
}

static void wait_for_end(void)
{
    while (FLASH->SR2 & (FLASH_SR_BSY | FLASH_SR_WBNE | FLASH_SR_QW)) {
    }
}

static void program(void)
{
    volatile uint32_t *to = (volatile uint32_t *)address;
    FLASH->CR2 |= FLASH_CR_PG;
    for (uint32_t i = 0; i < WORDS; i++)
        to[i] = value + i;
    wait_for_end();
    FLASH->CR2 &= ~FLASH_CR_PG;
}

static void read(void)
{
    const volatile uint32_t *from = (const volatile uint32_t *)address;
    for (uint32_t i = 0; i < WORDS; i++)
        words_read[i] = from[i];
}

static void read_guarded(void)
{
    __set_FAULTMASK(1);
    SCB->CCR |= SCB_CCR_BFHFNMIGN_Msk;
    read();
    flags = SCB->CFSR;
    SCB->CFSR = flags;
    SCB->CCR &= ~SCB_CCR_BFHFNMIGN_Msk;
    __set_FAULTMASK(0);
}

int main(void)
{
    set_handler(BusFault_IRQn, on_bus_fault);
    SCB->SHCSR |= SCB_SHCSR_BUSFAULTENA_Msk;
    for (;;) {
        const uint32_t now = command;
        if (now == NOTHING)
            continue;
        if (now == UNLOCK) {
            FLASH->KEYR2 = 0x45670123U;
            FLASH->KEYR2 = 0xCDEF89ABU;
        } else if (now == ERASE) {
            FLASH->CR2 = (FLASH->CR2 & ~FLASH_CR_SNB) | FLASH_CR_SER | value << FLASH_CR_SNB_Pos;
            FLASH->CR2 |= FLASH_CR_START;
            wait_for_end();
            FLASH->CR2 &= ~FLASH_CR_SER;
        } else if (now == PROGRAM) {
            program();
        } else if (now == READ) {
            read();
        } else if (now == READ_GUARDED) {
            read_guarded();
        }
        status = FLASH->SR2;
        FLASH->CCR2 = 0x0FFF0000U;
        command = NOTHING;
    }
}
