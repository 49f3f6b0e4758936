/*
 * The functions of the boot ROM that EPG provides for the emulator, in place of the chip's own.
 *
 * It is for images that are built with the compiler's own float and double: it has no floating-point tables.  It erases
 * and programs flash by plain writes to the XIP window, which the emulator allows for code in ROM.  The duration of
 * erasing and programming is the typical one of a W25Q16JV (data sheet of the chip, revision H, 9.6), unless the
 * emulator changes it.
 */
#include <stdint.h>

#define TIMERAWL (*(volatile uint32_t *)0x40054028u)
#define XIP_FLUSH (*(volatile uint32_t *)0x14000004u)
#define SSI_ENABLE (*(volatile uint32_t *)0x18000008u)
#define XIP_BASE 0x10000000u
#define SECTOR 4096u
#define PAGE 256u

/* Microseconds of erasing a sector and of programming a page: in rom.S.  The emulator writes other values there. */
extern const volatile uint32_t rom_flash_times_us[2];

typedef struct entry {
    uint16_t code;
    uint16_t function;
} entry_t;

void *rom_table_lookup(const entry_t *table, uint32_t code);
uint8_t *rom_memset(uint8_t *to, uint8_t value, uint32_t count);
uint32_t rom_popcount32(uint32_t value);
uint32_t rom_reverse32(uint32_t value);
uint32_t rom_clz32(uint32_t value);
uint32_t rom_ctz32(uint32_t value);
void rom_connect_internal_flash(void);
void rom_flash_exit_xip(void);
void rom_flash_range_erase(uint32_t offset, uint32_t count, uint32_t block_size, uint8_t block_command);
void rom_flash_range_program(uint32_t offset, const uint8_t *data, uint32_t count);
void rom_flash_flush_cache(void);
void rom_flash_enter_cmd_xip(void);
void rom_reset_usb_boot(uint32_t led_mask, uint32_t disabled_interfaces);
void rom_halt(void);

void *rom_table_lookup(const entry_t *table, uint32_t code)
{
    for (; table->code != 0; table++) {
        if (table->code == code) {
            return (void *)(uintptr_t)table->function;
        }
    }
    return 0;
}

uint8_t *rom_memset(uint8_t *to, uint8_t value, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        to[i] = value;
    }
    return to;
}

uint32_t rom_popcount32(uint32_t value)
{
    uint32_t count = 0;
    for (; value != 0; value &= value - 1u) {
        count++;
    }
    return count;
}

uint32_t rom_reverse32(uint32_t value)
{
    uint32_t result = 0;
    for (int i = 0; i < 32; i++) {
        result = result << 1 | (value & 1u);
        value >>= 1;
    }
    return result;
}

uint32_t rom_clz32(uint32_t value)
{
    uint32_t count = 32;
    for (; value != 0; value >>= 1) {
        count--;
    }
    return count;
}

uint32_t rom_ctz32(uint32_t value)
{
    uint32_t count = 0;
    if (value == 0) {
        return 32;
    }
    for (; (value & 1u) == 0; value >>= 1) {
        count++;
    }
    return count;
}

static void wait_us(uint32_t time)
{
    const uint32_t start = TIMERAWL;
    while (TIMERAWL - start < time) {
    }
}

void rom_connect_internal_flash(void)
{
}

void rom_flash_exit_xip(void)
{
    SSI_ENABLE = 0;
}

void rom_flash_range_erase(uint32_t offset, uint32_t count, uint32_t block_size, uint8_t block_command)
{
    (void)block_size;
    (void)block_command;
    for (uint32_t at = 0; at < count; at += 4) {
        *(volatile uint32_t *)(XIP_BASE + offset + at) = 0xffffffffu;
        if (at % SECTOR == 0) {
            wait_us(rom_flash_times_us[0]);
        }
    }
}

void rom_flash_range_program(uint32_t offset, const uint8_t *data, uint32_t count)
{
    for (uint32_t at = 0; at < count; at++) {
        /* The emulator clears bits only: programming cannot set a bit. */
        *(volatile uint8_t *)(XIP_BASE + offset + at) = data[at];
        if (at % PAGE == 0) {
            wait_us(rom_flash_times_us[1]);
        }
    }
}

void rom_flash_flush_cache(void)
{
    XIP_FLUSH = 1;
}

void rom_flash_enter_cmd_xip(void)
{
    SSI_ENABLE = 1;
}

/* The emulator stops at the two functions below and reports which. */
void rom_reset_usb_boot(uint32_t led_mask, uint32_t disabled_interfaces)
{
    (void)led_mask;
    (void)disabled_interfaces;
    for (;;) {
        __asm volatile("wfi");
    }
}

void rom_halt(void)
{
    for (;;) {
        __asm volatile("wfi");
    }
}
