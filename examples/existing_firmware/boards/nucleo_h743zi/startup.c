/* Vector table and start-up code of the Nucleo-H743ZI: memory, FPU, main(). */
#include <stdint.h>

extern uint32_t board_stack_top[], board_data_begin[], board_data_end[], board_bss_begin[], board_bss_end[];
extern const uint32_t board_data_source[];
int main(void);
void board_reset(void);

/** The value that main() returned, for a debugger. */
volatile int board_result = -1;

static void stop(void)
{
    for (;;) {
    }
}

/* Interrupt handlers. A program defines those that it uses. */
__attribute__((weak)) void HardFault_Handler(void)
{
    stop();
}

__attribute__((weak)) void USART3_IRQHandler(void)
{
    stop();
}

__attribute__((weak)) void TIM6_DAC_IRQHandler(void)
{
    stop();
}

void board_reset(void)
{
    /* Full access to coprocessors 10 and 11, the FPU (PM0253, section 4.7.1). */
    volatile uint32_t *const cpacr = (volatile uint32_t *)0xE000ED88u;
    *cpacr |= 0xFu << 20;
    __asm volatile("dsb\n isb" ::: "memory");
    const uint32_t *source = board_data_source;
    for (uint32_t *word = board_data_begin; word < board_data_end; word++) {
        *word = *source++;
    }
    for (uint32_t *word = board_bss_begin; word < board_bss_end; word++) {
        *word = 0;
    }
    board_result = main();
    stop();
}

typedef union board_vector {
    void *stack;
    void (*handler)(void);
} board_vector_t;

/** The 16 vectors of the processor, and the interrupts up to TIM6_DAC, number 54 (RM0433, section 20.1.2). */
__attribute__((section(".vectors"), used)) static const board_vector_t board_vectors[16 + 55] = {
    [0] = {.stack = board_stack_top},
    [1] = {.handler = board_reset},
    [2] = {.handler = stop},
    [3] = {.handler = HardFault_Handler},
    [4] = {.handler = stop},
    [5] = {.handler = stop},
    [6] = {.handler = stop},
    [11] = {.handler = stop},
    [12] = {.handler = stop},
    [14] = {.handler = stop},
    [15] = {.handler = stop},
    [16 + 39] = {.handler = USART3_IRQHandler},
    [16 + 54] = {.handler = TIM6_DAC_IRQHandler},
};
