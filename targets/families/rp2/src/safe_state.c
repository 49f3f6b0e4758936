/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Safe outputs: before main(), and after a fault of the processor or the program.
 *
 * Each pin of the chip is connected to one of several functions, such as PWM or SIO (plain input and output).  A pin at
 * its safe level is connected to SIO.  This takes effect at once, and the pin no longer follows its PWM slice.
 */
#include "parts.h"

/** Bytes of a second stack for each core.  The HardFault handler uses it, because the first may have overflowed. */
#define EMERGENCY_STACK 128
/** The watchdog's scratch register that records a fault.  It survives a reset by the watchdog.  The SDK uses 4 to 7. */
#define FAULT_WORD 3
#define FAULT_MAGIC 0xEF4A17EDU
/** Number of the HardFault exception in the vector table: Armv6-M ARM B1.5.2, Armv8-M ARM B3.8. */
#define HARD_FAULT 3

/* RP2040 data sheet 2.19.2 and RP2350 data sheet 9.4: SIO is function 5 of every pin. */
static_assert(GPIO_FUNC_SIO == 5, "the function that makes a pin a plain output");

/* One bit per pin.  In RAM, because the handlers must not read flash. */
static uint32_t output_pins;
static uint32_t output_levels;

/**
 * Runs as early as possible: after the peripherals' reset has ended (00100), before the clocks are set up (00500).
 * This is within a millisecond after the boot ROM has started the program.  A program that runs from RAM is copied
 * first, which takes additional time.  Until then the pins float; only the chip's weak pull-downs hold them.
 */
void epg_pico_outputs_start(void)
{
    for (size_t i = 0; i < epg_pico_outputs.count; i++) {
        const epg_pico_output_t *output = &epg_pico_outputs.pins[i];
        gpio_put(output->pin, output->high);
        gpio_set_dir(output->pin, GPIO_OUT);
        gpio_set_function(output->pin, GPIO_FUNC_SIO);
        output_pins |= 1U << output->pin;
        output_levels |= (output->high ? 1U : 0U) << output->pin;
    }
}

PICO_RUNTIME_INIT_FUNC_RUNTIME(epg_pico_outputs_start, "00150");

void __not_in_flash_func(epg_pico_outputs_off)(void)
{
    if (sio_hw->cpuid == 0U) {
        /* Hold core 1 in reset.  It would write its outputs again. */
        hw_set_bits(&psm_hw->frce_off, PSM_FRCE_OFF_PROC1_BITS);
    }
    sio_hw->gpio_clr = output_pins & ~output_levels;
    sio_hw->gpio_set = output_pins & output_levels;
    sio_hw->gpio_oe_set = output_pins;
    for (uint32_t pin = 0; pin < 32U; pin++) {
        if ((output_pins >> pin & 1U) != 0U) {
            io_bank0_hw->io[pin].ctrl = GPIO_FUNC_SIO << IO_BANK0_GPIO0_CTRL_FUNCSEL_LSB;
        }
    }
}

void __not_in_flash_func(epg_pico_safe_state)(void)
{
    epg_pico_outputs_off();
    watchdog_hw->scratch[FAULT_WORD] = FAULT_MAGIC;
}

epg_fault_t epg_family_fault_before_reset(void)
{
    static epg_fault_t fault = EPG_FAULT_NONE;
    if (watchdog_hw->scratch[FAULT_WORD] == FAULT_MAGIC) {
        fault = EPG_FAULT_PROCESSOR;
    } else if (watchdog_enable_caused_reboot()) {
        /* The watchdog timed out.  An intended reboot, such as picotool's, does not reach this line. */
        fault = EPG_FAULT_WATCHDOG;
    }
    watchdog_hw->scratch[FAULT_WORD] = 0;
    return fault;
}

/* HardFault ---------------------------------------------------------------------------------------------------- */

/* Used from assembler: one emergency stack per core, and the HardFault handlers that were installed before. */
__attribute__((used)) uint32_t epg_pico_emergency_stacks[2][EMERGENCY_STACK / sizeof(uint32_t)];
__attribute__((used)) exception_handler_t epg_pico_next_handler[2];

static_assert(EMERGENCY_STACK == 1 << 7, "the handler shifts by 7");

/*
 * The HardFault handler.  It switches to the emergency stack of this core, makes the outputs safe, restores the stack
 * pointer and LR, and jumps to the handler that was installed before.  That handler finds the exception as it was.
 */
static void __attribute__((naked)) __not_in_flash_func(on_hard_fault)(void)
{
    pico_default_asm_volatile("ldr r0, =%c[cpuid]\n"
                              "ldr r0, [r0]\n"
                              "adds r1, r0, #1\n"
                              "lsls r1, r1, #7\n"
                              "ldr r2, =epg_pico_emergency_stacks\n"
                              "adds r1, r1, r2\n"
                              "mov r2, sp\n"
                              "mov r3, lr\n"
#if !PICO_RP2040
                              "movs r0, #0\n"
                              "msr msplim, r0\n"
#endif
                              "mov sp, r1\n"
                              "push {r2, r3}\n"
                              "ldr r0, =epg_pico_safe_state\n"
                              "blx r0\n"
                              "pop {r2, r3}\n"
                              "mov sp, r2\n"
                              "mov lr, r3\n"
                              "ldr r0, =%c[cpuid]\n"
                              "ldr r0, [r0]\n"
                              "lsls r0, r0, #2\n"
                              "ldr r1, =epg_pico_next_handler\n"
                              "ldr r0, [r0, r1]\n"
                              "bx r0\n"
                              ".ltorg\n"
                              :
                              : [cpuid] "i"(SIO_BASE + SIO_CPUID_OFFSET));
}

void epg_family_guard_faults(void)
{
    exception_handler_t *handlers = (exception_handler_t *)(uintptr_t)scb_hw->vtor;
    const exception_handler_t present = handlers[HARD_FAULT];
    if (present != on_hard_fault) {
        epg_pico_next_handler[get_core_num()] = present;
        handlers[HARD_FAULT] = on_hard_fault;
    }
}

/* panic(), failed assertions and the end of main() --------------------------------------------------------------- */

/*
 * The linker redirects calls of <name> to __wrap_<name> (--wrap).  The outputs are safe before the SDK's function
 * prints, stops in the debugger or waits without end.  This holds for a function with which the user replaces the SDK's,
 * too.
 */
#define SAFE_BEFORE(name)                                                                                              \
    void __attribute__((naked, used)) __not_in_flash_func(__wrap_##name)(void)                                         \
    {                                                                                                                  \
        pico_default_asm_volatile("push {r0, r1, r2, r3, r4, lr}\n"                                                    \
                                  "ldr r4, =epg_pico_safe_state\n"                                                     \
                                  "blx r4\n"                                                                           \
                                  "ldr r4, =__real_" #name "\n"                                                        \
                                  "mov ip, r4\n"                                                                       \
                                  "pop {r0, r1, r2, r3, r4}\n"                                                         \
                                  "pop {r4}\n"                                                                         \
                                  "mov lr, r4\n"                                                                       \
                                  "bx ip\n"                                                                            \
                                  ".ltorg\n");                                                                         \
    }                                                                                                                  \
    _Static_assert(true, "")

SAFE_BEFORE(panic);
SAFE_BEFORE(__assert_func);
SAFE_BEFORE(_exit);
