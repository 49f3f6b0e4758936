/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Vector table and start of a program that contains a target of EPG and nothing else: from the reset to main().
 *
 * The outputs are safe as soon as memory is set up, before the clocks are: the constructors of the port layer do this.
 */
#include "start.h"

#include "epg/family.h"
#include "epg/one_core.h"

/* From sections.ld. */
typedef struct copy {
    const volatile uint32_t *from;
    volatile uint32_t *to;
    size_t size;
} copy_t;

typedef struct zero {
    volatile uint32_t *begin;
    size_t size;
} zero_t;

extern const copy_t epg_start_copies[];
extern const copy_t epg_start_copies_end[];
extern const zero_t epg_start_zeros[];
extern const zero_t epg_start_zeros_end[];
extern void (*const epg_start_constructors[])(void);
extern void (*const epg_start_constructors_end[])(void);
extern uint32_t _estack[];
extern const char epg_start_dma[];
extern const char epg_start_dma_size[];

int main(void);
void Reset_Handler(void);

/** An exception without a handler: ends the run with all outputs safe.  The watchdog, if it runs, resets the chip. */
static void unexpected(void)
{
    epg_family_panic(NULL);
}

/* Handlers that other files may define --------------------------------------------------------------------------- */

#define WEAK(name)                                                                                                     \
    void name(void);                                                                                                   \
    void name(void) __attribute__((weak, alias("unexpected")));
#define WEAK_INTERRUPT(number, name) WEAK(name##_IRQHandler)

WEAK(NMI_Handler)
WEAK(HardFault_Handler)
WEAK(MemManage_Handler)
WEAK(BusFault_Handler)
WEAK(UsageFault_Handler)
WEAK(DebugMon_Handler)
EPG_STM32_EACH_INTERRUPT(WEAK_INTERRUPT)

/* The handlers of the FreeRTOS kernel; NULL without the kernel. */
void __attribute__((weak)) vPortSVCHandler(void);
void __attribute__((weak)) xPortPendSVHandler(void);
void __attribute__((weak)) xPortSysTickHandler(void);

/* Vector table (PM0253, 2.4.4) ----------------------------------------------------------------------------------- */

typedef union vector {
    uint32_t *stack;
    void (*handler)(void);
} vector_t;

#define VECTOR(number, name) [16 + (number)] = {.handler = name##_IRQHandler},

/* The core reads it at the beginning of the flash after a reset (RM0433, 2.6). */
extern const vector_t epg_start_vectors[16 + EPG_STM32_INTERRUPTS];
__attribute__((section(".vectors"), used))
const vector_t epg_start_vectors[16 + EPG_STM32_INTERRUPTS] = {[0] = {.stack = _estack},
                                                               [1] = {.handler = Reset_Handler},
                                                               [2] = {.handler = NMI_Handler},
                                                               [3] = {.handler = HardFault_Handler},
                                                               [4] = {.handler = MemManage_Handler},
                                                               [5] = {.handler = BusFault_Handler},
                                                               [6] = {.handler = UsageFault_Handler},
                                                               [11] = {.handler = vPortSVCHandler},
                                                               [12] = {.handler = DebugMon_Handler},
                                                               [14] = {.handler = xPortPendSVHandler},
                                                               [15] = {.handler = xPortSysTickHandler},
                                                               EPG_STM32_EACH_INTERRUPT(VECTOR)};

/* Start ---------------------------------------------------------------------------------------------------------- */

/*
 * Functions of the C library are in ITCM, which has no contents yet.  The pointers are volatile so that the compiler does
 * not replace the loops by memcpy() and memset().
 */
static void set_up_memory(void)
{
    for (const copy_t *copy = epg_start_copies; copy < epg_start_copies_end; copy++) {
        for (size_t i = 0; i < copy->size / sizeof(uint32_t); i++) {
            copy->to[i] = copy->from[i];
        }
    }
    for (const zero_t *zero = epg_start_zeros; zero < epg_start_zeros_end; zero++) {
        for (size_t i = 0; i < zero->size / sizeof(uint32_t); i++) {
            zero->begin[i] = 0U;
        }
    }
    __DSB();
    __ISB();
}

/**
 * Keeps the memory of the DMA controllers out of the data cache: normal memory that is not cached, and without code
 * (PM0253, 4.6: TEX 1, C 0, B 0).  All other memory stays as the core's default map says.
 */
static void set_up_mpu(void)
{
    const uint32_t size = (uint32_t)(uintptr_t)epg_start_dma_size;     /* a power of two; the address is its multiple */
    const uint32_t encoded = 31U - (uint32_t)__builtin_clz(size) - 1U; /* 2^(encoded + 1) bytes */
    ARM_MPU_Disable();
    ARM_MPU_SetRegion(ARM_MPU_RBAR(0U, (uint32_t)(uintptr_t)epg_start_dma),
                      ARM_MPU_RASR(1U, ARM_MPU_AP_FULL, 1U, 0U, 0U, 0U, 0U, encoded));
    ARM_MPU_Enable(MPU_CTRL_PRIVDEFENA_Msk);
}

/* Not inline: the compiler may save registers of the FPU at its beginning. */
static void __attribute__((noinline, noreturn)) start(void)
{
    epg_start_memories();
    set_up_memory();
    set_up_mpu();
    SCB_EnableICache();
    SCB_EnableDCache();
    for (void (*const *constructor)(void) = epg_start_constructors; constructor < epg_start_constructors_end;
         constructor++) {
        (*constructor)();
    }
    epg_start_clocks();
    (void)main();
    epg_family_panic(NULL);
}

void Reset_Handler(void)
{
    SCB->CPACR |= 0xFU << 20U; /* full access to the FPU (PM0253, 4.7.1) */
    SCB->VTOR = (uintptr_t)epg_start_vectors;
    __DSB();
    __ISB();
    start();
}
