/*
 * Stand-in for the mask ROM of the RP2040: what an image finds at fixed addresses (data sheet, 2.8.3).
 * The functions are in rom.c.  Nothing here is Raspberry Pi's.
 */
    .syntax unified
    .cpu cortex-m0plus
    .thumb

    .section .vectors, "a"
    .word 0x20042000            /* stack: the end of SRAM */
    .word rom_halt
    .word rom_halt              /* NMI */
    .word rom_halt              /* HardFault before an image has its own vectors */
    .byte 'M', 'u', 1           /* magic, version of the layout */
    .byte 3                     /* version of the ROM: as revision B2 */
    .hword functions
    .hword data
    .hword rom_table_lookup + 1

    .macro entry first, second, function
    .byte \first, \second
    .hword \function + 1       /* Thumb: a 16-bit relocation does not say so by itself */
    .endm

    .type functions, %object
functions:
    entry 'M', 'S', rom_memset
    entry 'S', '4', rom_memset
    entry 'M', 'C', rom_memcpy
    entry 'C', '4', rom_memcpy
    entry 'P', '3', rom_popcount32
    entry 'R', '3', rom_reverse32
    entry 'L', '3', rom_clz32
    entry 'T', '3', rom_ctz32
    entry 'I', 'F', rom_connect_internal_flash
    entry 'E', 'X', rom_flash_exit_xip
    entry 'R', 'E', rom_flash_range_erase
    entry 'R', 'P', rom_flash_range_program
    entry 'F', 'C', rom_flash_flush_cache
    entry 'C', 'X', rom_flash_enter_cmd_xip
    entry 'U', 'B', rom_reset_usb_boot
    entry 'W', 'V', rom_halt
    .hword 0, 0
    .type data, %object
data:
    .hword 0, 0

/*
 * rom_memcpy(to, from, count): copies 16 bytes in 13 clocks, as the chip's function does, if both addresses are
 * multiples of 4.
 */
    .text
    .global rom_memcpy
    .type rom_memcpy, %function
    .thumb_func
rom_memcpy:
    push {r0, r4, r5, r6, lr}
    movs r3, r0
    orrs r3, r1
    lsls r3, r3, #30
    bne 4f
    b 2f
1:  ldmia r1!, {r3, r4, r5, r6}
    stmia r0!, {r3, r4, r5, r6}
2:  subs r2, r2, #16
    bhs 1b
    adds r2, r2, #12
    blo 6f
5:  ldmia r1!, {r3}
    stmia r0!, {r3}
    subs r2, r2, #4
    bhs 5b
6:  adds r2, r2, #4
    b 4f
3:  ldrb r3, [r1]
    strb r3, [r0]
    adds r1, r1, #1
    adds r0, r0, #1
4:  subs r2, r2, #1
    bhs 3b
    pop {r0, r4, r5, r6, pc}

    .section .rodata.flash_times, "a"
    .balign 4
    .global rom_flash_times_us
    .type rom_flash_times_us, %object
    .size rom_flash_times_us, 8
rom_flash_times_us:
    .word 45000, 400
