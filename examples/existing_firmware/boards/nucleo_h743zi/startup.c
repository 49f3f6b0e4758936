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

/** The first 16 vectors; no interrupt of a peripheral is enabled. */
__attribute__((section(".vectors"), used)) static const board_vector_t board_vectors[16] = {
    {.stack = board_stack_top}, {.handler = board_reset}, {.handler = stop}, {.handler = stop},
    {.handler = stop},          {.handler = stop},        {.handler = stop}, {.handler = stop},
    {.handler = stop},          {.handler = stop},        {.handler = stop}, {.handler = stop},
    {.handler = stop},          {.handler = stop},        {.handler = stop}, {.handler = stop},
};
