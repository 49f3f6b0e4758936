# SPDX-License-Identifier: Apache-2.0
"""Functions of an RP2350 image, run on an emulated Cortex-M33 (unicorn) with a small model of the registers they use.

>>> # processor = Processor(elf)
>>> # processor.call("epg_control_start", processor.address("jiwy_control"), processor.address("application"))

The image is in memory as after its start-up code.  There are no time and no interrupts: the caller of a function sets
the microsecond timer and the PIO's FIFOs.  The timer advances only when the firmware waits.  unicorn does not have
the chip's coprocessors.  This module simulates the one for pins; instead of the one for doubles, the images use the
compiler's own arithmetic (COMPILER_ARITHMETIC).
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from tests.doubles.toolchain import RP2040, binutils, unicorn

COMPILER_ARITHMETIC = {"CMAKE_PROJECT_INCLUDE": str(RP2040 / "compiler_arithmetic.cmake")}

FLASH, FLASH_SIZE = 0x10000000, 0x400000
RAM, RAM_SIZE = 0x20000000, 0x82000
PERIPHERALS, PERIPHERALS_SIZE = 0x40000000, 0x10800000
SIO = 0xD0000000
PRIVATE, PRIVATE_SIZE = 0xE0000000, 0x100000
STACK = RAM + RAM_SIZE
RETURN = 0xFFF0
"""An address without code: a call ends there."""

_PIN_WRITE = re.compile(r"\s*([0-9a-f]+):\t.*\tmcrr\t0, 4, r(\d+), r(\d+), cr([04])")
"""The GPIO coprocessor's write of one pin's level (cr0) or output enable (cr4): RP2350 data sheet, 3.6.1."""

# RP2350 data sheet, 2.2 (address map), 3.1.11 (SIO), 12.5.3 (PWM), 11.7 (PIO), 12.8.5 (TIMER), 9.11.1 (IO_BANK0)
PWM, PWM_SLICE, PWM_CC = 0x400A8000, 0x14, 0x0C
TIMER0_RAWH, TIMER0_RAWL = 0x400B0024, 0x400B0028
PIO0, PIO_FSTAT, PIO_FLEVEL, PIO_RXF0 = 0x50200000, 0x04, 0x0C, 0x20
IO_BANK0, PINS, NO_FUNCTION = 0x40028000, 30, 0x1F  # after a reset
GPIO_OUT, GPIO_OUT_SET, GPIO_OUT_CLR = 0x010, 0x018, 0x020


class Processor:
    """One core, its memories and its registers; ``counts`` are the results of PIO0's state machines.

    ``target``: the name of the image's target, with which the names of its variables begin.
    """

    def __init__(self, elf: Path, target: str = "jiwy") -> None:
        self.target = target
        self.module: Any = unicorn()
        self.arm = self.module.arm_const
        self.cpu = self.module.Uc(self.module.UC_ARCH_ARM, self.module.UC_MODE_THUMB | self.module.UC_MODE_MCLASS)
        self.cpu.ctl_set_cpu_model(self.arm.UC_CPU_ARM_CORTEX_M33)
        self.symbols = _symbols(elf)
        self.registers = {IO_BANK0 + 8 * pin + 4: NO_FUNCTION for pin in range(PINS)}
        self.outputs = 0
        self.counts = [0, 0, 0, 0]
        self.time_us = 0
        self._map_memory(elf)
        self._add_pin_coprocessor(elf)
        wait = self.symbols.get("epg_port_wait_until")
        if wait is not None:
            self.cpu.hook_add(self.module.UC_HOOK_CODE, self._pass_time, None, wait, wait)

    def _pass_time(self, cpu: Any, address: int, size: int, _: Any) -> None:
        """``epg_port_wait_until(time_ns)`` begins: advances the timer to that time."""
        time_ns = cpu.reg_read(self.arm.UC_ARM_REG_R0) | cpu.reg_read(self.arm.UC_ARM_REG_R1) << 32
        self.time_us = max(self.time_us, -(-time_ns // 1000))

    def _add_pin_coprocessor(self, elf: Path) -> None:
        for line in binutils("objdump", "-d", str(elf)).splitlines():
            found = _PIN_WRITE.match(line)
            if found:
                address = int(found[1], 16)
                operands = (int(found[2]), int(found[3]), found[4] == "0")
                self.cpu.hook_add(self.module.UC_HOOK_CODE, self._write_pin, operands, address, address)

    def _write_pin(self, cpu: Any, address: int, size: int, operands: tuple[int, int, bool]) -> None:
        """Does what the instruction would do, and continues after it."""
        pin, value = (cpu.reg_read(self.arm.UC_ARM_REG_R0 + number) for number in operands[:2])
        if operands[2]:
            self.outputs = self.outputs & ~(1 << pin) | (value & 1) << pin
        cpu.reg_write(self.arm.UC_ARM_REG_PC, address + size | 1)

    def _map_memory(self, elf: Path) -> None:
        for base, size in ((0, 0x10000), (FLASH, FLASH_SIZE), (RAM, RAM_SIZE), (PRIVATE, PRIVATE_SIZE)):
            self.cpu.mem_map(base, size)
        self.cpu.mem_write(FLASH, b"\xff" * FLASH_SIZE)
        for address, data in _segments(elf):
            self.cpu.mem_write(address, data)
        self.cpu.mmio_map(PERIPHERALS, PERIPHERALS_SIZE, self._read, None, self._write, None)
        self.cpu.mmio_map(SIO, 0x1000, self._read_sio, None, self._write_sio, None)

    # Functions --------------------------------------------------------------------------------------------------------

    def address(self, symbol: str) -> int:
        return self.symbols[symbol]

    def call(self, function: str, *arguments: int, stacked: Sequence[int] = (), longest: int = 1_000_000) -> int:
        """Calls a function with words in r0 to r3 and on the stack; returns r0.

        Raises :class:`AssertionError` if the function has not returned after ``longest`` instructions.
        """
        stack = STACK - 4 * (len(stacked) + len(stacked) % 2)
        self.cpu.mem_write(stack, struct.pack(f"<{len(stacked)}I", *stacked))
        self.cpu.reg_write(self.arm.UC_ARM_REG_SP, stack)
        self.cpu.reg_write(self.arm.UC_ARM_REG_LR, RETURN | 1)
        for number, value in enumerate(arguments):
            self.cpu.reg_write(self.arm.UC_ARM_REG_R0 + number, value)
        self.cpu.emu_start(self.address(function) | 1, RETURN, count=longest)
        pc = self.cpu.reg_read(self.arm.UC_ARM_REG_PC)
        assert pc == RETURN, f"{function} has not returned: it is at 0x{pc:x}"
        return int(self.cpu.reg_read(self.arm.UC_ARM_REG_R0))

    def trace(self, seen: Callable[[int], None], run: Callable[[], object]) -> None:
        """Calls ``seen(pc)`` before each instruction that the processor executes during ``run()``."""
        hook = self.cpu.hook_add(self.module.UC_HOOK_CODE, lambda cpu, address, size, data: seen(address))
        try:
            run()
        finally:
            self.cpu.hook_del(hook)

    # Memory and pins --------------------------------------------------------------------------------------------------

    def doubles(self, symbol: str, count: int) -> tuple[float, ...]:
        return struct.unpack(f"<{count}d", bytes(self.cpu.mem_read(self.address(symbol), 8 * count)))

    def level(self, slice_: int, channel: int) -> int:
        """The value of a compare register of the PWM."""
        return self.registers.get(PWM + PWM_SLICE * slice_ + PWM_CC, 0) >> 16 * channel & 0xFFFF

    def pin(self, pin: int) -> int:
        return self.outputs >> pin & 1

    # Registers: a read returns the last write, also by SET, CLR and XOR aliases -------------------------------------

    def _read(self, _: Any, offset: int, size: int, __: Any) -> int:
        address = (PERIPHERALS + offset) & ~0x3000
        word = self._register(address & ~3)
        return word >> 8 * (address & 3) & (1 << 8 * size) - 1

    def _register(self, address: int) -> int:
        if address in (TIMER0_RAWL, TIMER0_RAWH):
            return self.time_us >> (32 if address == TIMER0_RAWH else 0) & 0xFFFFFFFF
        if address in (PIO0 + PIO_FSTAT, PIO0 + PIO_FLEVEL):
            return 0  # no old results, and never empty
        if PIO0 + PIO_RXF0 <= address < PIO0 + PIO_RXF0 + 16:
            return self.counts[(address - PIO0 - PIO_RXF0) // 4] & 0xFFFFFFFF
        return self.registers.get(address, 0)

    def _write(self, _: Any, offset: int, size: int, value: int, __: Any) -> None:
        address = PERIPHERALS + offset
        operation, address = address >> 12 & 3, address & ~0x3000
        before = self.registers.get(address, 0)
        after = {0: value, 1: before ^ value, 2: before | value, 3: before & ~value}[operation]
        self.registers[address] = after & 0xFFFFFFFF

    def _read_sio(self, _: Any, offset: int, size: int, __: Any) -> int:
        return self.outputs if offset == GPIO_OUT else 0

    def _write_sio(self, _: Any, offset: int, size: int, value: int, __: Any) -> None:
        if offset == GPIO_OUT_SET:
            self.outputs |= value
        elif offset == GPIO_OUT_CLR:
            self.outputs &= ~value
        elif offset == GPIO_OUT:
            self.outputs = value


def _symbols(elf: Path) -> dict[str, int]:
    lines = (line.split() for line in binutils("nm", str(elf)).splitlines())
    return {words[2]: int(words[0], 16) for words in lines if len(words) == 3}


def _segments(elf: Path) -> list[tuple[int, bytes]]:
    """The loaded segments at their run addresses.  Source: ELF for the Arm architecture, program headers."""
    data = elf.read_bytes()
    (offset,), (size, count) = struct.unpack_from("<I", data, 28), struct.unpack_from("<HH", data, 42)
    found = []
    for number in range(count):
        kind, start, virtual, _, length = struct.unpack_from("<5I", data, offset + number * size)
        if kind == 1 and length > 0:
            found.append((virtual, data[start : start + length]))
    return found
