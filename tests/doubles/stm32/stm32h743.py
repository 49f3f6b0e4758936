# SPDX-License-Identifier: Apache-2.0
"""A whole Zephyr image on an emulated STM32H743: unicorn's Cortex-M7, and EPG's own model of the registers.

>>> # chip = Stm32h743(elf)
>>> # chip.boot()
>>> # chip.attach("TIM4", ("D", 12), ("D", 13), alternate_function=2)
>>> # chip.move("TIM4", -70_000)

There is no time, no SysTick and no cache.  Interrupts are entered between instructions if NVIC, PRIMASK and BASEPRI
allow it, and run to their end; they do not nest, and there is no switch of threads.  Registers without a model keep the
value that was written.  Of the clock tree, only the flags change for which drivers wait (RM0433, 8.7 and 6.8).
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

from tests.doubles.stm32.agenda import Agenda
from tests.doubles.stm32.image import Image
from tests.doubles.stm32.timers import Level, Timer
from tests.doubles.toolchain import unicorn

FLASH, FLASH_SIZE = 0x08000000, 0x200000
MEMORIES = (
    (0x00000000, 0x10000), (0x1FF00000, 0x20000), (0x20000000, 0x20000), (0x24000000, 0x80000), (0x30000000, 0x48000),
)  # fmt: skip
PERIPHERALS, PERIPHERALS_SIZE = 0x40000000, 0x20000000
PRIVATE, PRIVATE_SIZE = 0xE0000000, 0x100000
RETURN = 0xFFF0
"""An address without code, in the memory at 0: an interrupt ends there."""

RCC, PWR, GPIO, GPIO_SIZE = 0x58024400, 0x58024800, 0x58020000, 0x400
RCC_CR, RCC_CFGR, RCC_BDCR, RCC_CSR = 0x000, 0x010, 0x070, 0x074
AHB4ENR, APB1LENR, APB2ENR, APB1LRSTR, APB2RSTR = 0x0E0, 0x0E8, 0x0F0, 0x090, 0x098
PWR_CSR1, PWR_D3CR, VOS_READY = 0x04, 0x18, 1 << 13
USARTS, USART_ISR, USART_READY = (0x40004800, 0x58000C00), 0x1C, 1 << 22 | 1 << 21 | 1 << 7 | 1 << 6
RTC_ICSR, RTC_READY = 0x5800400C, 1 << 6 | 1 << 5
SYST_CSR = 0xE000E010
ADC_ISRS, ADC_CRS = (0x40022000, 0x40022100, 0x58026000), (0x40022008, 0x40022108, 0x58026008)
NVIC_ISER, NVIC_ICER, NVIC_IPR, VTOR, MPU_TYPE = 0xE000E100, 0xE000E180, 0xE000E400, 0xE000ED08, 0xE000ED90

TIMERS = ("TIM1", "TIM2", "TIM3", "TIM4", "TIM5", "TIM8")
CLOCKS, RESETS = {1: APB1LENR, 2: APB2ENR}, {1: APB1LRSTR, 2: APB2RSTR}
"""Registers of each APB."""


class _Standstill:
    """The surroundings of timers without time: they count edges only.  Their flags show requests for interrupts."""

    now = 0

    def __init__(self) -> None:
        self.agenda = Agenda()

    def timer_clock(self, apb: int) -> int:
        return 0

    def line(self, interrupt: int, source: object, high: bool) -> None:
        pass

    def triggered(self, name: str) -> list[Timer]:
        return []

    def levels_changed(self, level: Level) -> None:
        pass


class Stm32h743:
    """The chip with an image in its flash."""

    def __init__(self, elf: Path) -> None:
        module: Any = unicorn()
        self.arm = module.arm_const
        self.cpu = module.Uc(module.UC_ARCH_ARM, module.UC_MODE_THUMB | module.UC_MODE_MCLASS)
        self.cpu.ctl_set_cpu_model(self.arm.UC_CPU_ARM_CORTEX_M7)
        image = Image(elf)
        self.symbols = image.symbols
        self.timers = {name: Timer(name, _Standstill()) for name in TIMERS}
        self.pins: dict[str, tuple[tuple[str, int], tuple[str, int], int]] = {}
        self.registers: dict[int, int] = {MPU_TYPE: 16 << 8, RCC + RCC_CR: 1}
        self.enabled: set[int] = set()
        self.interrupts = 0
        """The interrupts that were served."""
        self.milliseconds = True
        """If True, each read of SysTick finds another millisecond passed; else time does not advance."""
        for base, size in ((FLASH, FLASH_SIZE), *MEMORIES):
            self.cpu.mem_map(base, size)
        for address, data in image.segments:
            self.cpu.mem_write(address, data)
        self.cpu.mmio_map(
            PERIPHERALS, PERIPHERALS_SIZE, self._reader(PERIPHERALS), None, self._writer(PERIPHERALS), None
        )
        self.cpu.mmio_map(PRIVATE, PRIVATE_SIZE, self._reader(PRIVATE), None, self._writer(PRIVATE), None)
        stack, entry = struct.unpack("<2I", self.cpu.mem_read(FLASH, 8))
        self.cpu.reg_write(self.arm.UC_ARM_REG_SP, stack)
        self.cpu.reg_write(self.arm.UC_ARM_REG_PC, entry | 1)

    # Running ----------------------------------------------------------------------------------------------------------

    def boot(self, longest: int = 5_000_000) -> None:
        """Runs from the reset to main()."""
        self._go(self.pc, self.symbols["main"] & ~1, longest)
        assert self.pc == self.symbols["main"] & ~1, f"main() was not reached: the processor is at {self.pc:#x}"

    def run(self, instructions: int) -> None:
        """Executes this number of instructions, and the interrupts that are due at the end."""
        self._go(self.pc, 0xFFFFFFFE, instructions)
        self.serve()

    def serve(self, longest: int = 10_000) -> None:
        """Enters interrupts that are due, as soon as they are not masked."""
        for _ in range(longest):
            due = [timer.kind.compare for timer in self.timers.values() if timer.interrupts]
            due = [number for number in due if number in self.enabled]
            if not due:
                return
            if self._masked(due[0]):
                self._go(self.pc, 0xFFFFFFFE, 1)
            else:
                self._interrupt(due[0])
        raise AssertionError("interrupts do not come to an end")

    def _masked(self, number: int) -> bool:
        if self.cpu.reg_read(self.arm.UC_ARM_REG_PRIMASK) & 1:
            return True
        base = self.cpu.reg_read(self.arm.UC_ARM_REG_BASEPRI)
        priority = self.registers.get(NVIC_IPR + number & ~3, 0) >> 8 * (number & 3) & 0xFF
        return base != 0 and priority >= base

    def _interrupt(self, number: int) -> None:
        self.interrupts += 1
        before = self.cpu.context_save()
        vectors = self.registers.get(VTOR, FLASH)
        (handler,) = struct.unpack("<I", self.cpu.mem_read(vectors + 4 * (16 + number), 4))
        self.cpu.reg_write(self.arm.UC_ARM_REG_IPSR, 16 + number)
        assert self.cpu.reg_read(self.arm.UC_ARM_REG_IPSR) == 16 + number
        self.cpu.reg_write(self.arm.UC_ARM_REG_LR, RETURN | 1)
        self._go(handler & ~1, RETURN, 10_000)
        assert self.pc == RETURN, f"interrupt {number} has not returned: it is at {self.pc:#x}"
        self.cpu.context_restore(before)

    def call(self, function: str, *arguments: int, longest: int = 100_000) -> tuple[int, int]:
        """Calls a function from the present state of the program; returns its result and its number of instructions.

        ``arguments`` are words: the first four are passed in registers, the others on the stack (AAPCS32 6.4).
        """
        executed = 0

        def count(*_: Any) -> None:
            nonlocal executed
            executed += 1

        before = self.cpu.context_save()
        for register, value in zip(("R0", "R1", "R2", "R3"), arguments):
            self.cpu.reg_write(getattr(self.arm, f"UC_ARM_REG_{register}"), value)
        stacked = b"".join(struct.pack("<I", value) for value in arguments[4:])
        stack = self.cpu.reg_read(self.arm.UC_ARM_REG_SP) - (len(stacked) + 7) // 8 * 8
        self.cpu.mem_write(stack, stacked)
        self.cpu.reg_write(self.arm.UC_ARM_REG_SP, stack)
        self.cpu.reg_write(self.arm.UC_ARM_REG_LR, RETURN | 1)
        hook = self.cpu.hook_add(4, count)  # UC_HOOK_CODE
        self._go(self.symbols[function] & ~1, RETURN, longest)
        self.cpu.hook_del(hook)
        result = int(self.cpu.reg_read(self.arm.UC_ARM_REG_R0))
        assert self.pc == RETURN, f"{function}() has not returned: it is at {self.pc:#x}"
        self.cpu.context_restore(before)
        return result, executed

    def _go(self, start: int, end: int, instructions: int) -> None:
        self.cpu.emu_start(start | 1, end, count=instructions)

    @property
    def pc(self) -> int:
        return int(self.cpu.reg_read(self.arm.UC_ARM_REG_PC)) & ~1

    # Encoders ---------------------------------------------------------------------------------------------------------

    def attach(self, timer: str, a: tuple[str, int], b: tuple[str, int], *, alternate_function: int) -> None:
        """Connects an encoder to two pins, (port, number), which are the timer's by that alternate function."""
        self.pins[timer] = (a, b, alternate_function)

    def move(self, timer: str, edges: int, *, latency: int = 0) -> None:
        """Turns a shaft; each interrupt is served ``latency`` edges after it is due."""
        while edges:
            edges -= self._turn(timer, edges)
            if self.timers[timer].interrupts:
                late = max(-latency, min(edges, latency))
                edges -= late
                while late:
                    late -= self._turn(timer, late)
                self.serve()

    def _turn(self, timer: str, edges: int) -> int:
        """Turns a shaft until the timer sets a flag; returns the number of edges."""
        return self.timers[timer].move(edges) if self._connected(timer) else edges

    def _connected(self, timer: str) -> bool:
        """True if both pins have the timer's function."""
        first, second, function = self.pins[timer]
        for port, pin in (first, second):
            index = ord(port) - ord("A")
            base = GPIO + GPIO_SIZE * index
            mode = self.registers.get(base, 0xFFFFFFFF) >> 2 * pin & 3
            chosen = self.registers.get(base + 0x20 + 4 * (pin // 8), 0) >> 4 * (pin % 8) & 0xF
            if not (mode == 2 and chosen == function and self.registers.get(RCC + AHB4ENR, 0) >> index & 1):
                return False
        return True

    # Memory -----------------------------------------------------------------------------------------------------------

    def word(self, symbol: str, *, offset: int = 0, size: int = 4, signed: bool = False) -> int:
        data = bytes(self.cpu.mem_read(self.symbols[symbol] + offset, size))
        return int.from_bytes(data, "little", signed=signed)

    def write_word(self, symbol: str, value: int, *, offset: int = 0, size: int = 4) -> None:
        self.cpu.mem_write(self.symbols[symbol] + offset, (value % (1 << 8 * size)).to_bytes(size, "little"))

    # Registers --------------------------------------------------------------------------------------------------------

    def _reader(self, base: int) -> Any:
        def read(_: Any, offset: int, size: int, __: Any) -> int:
            address = base + offset
            return self._read(address & ~3) >> 8 * (address & 3) & (1 << 8 * size) - 1

        return read

    def _writer(self, base: int) -> Any:
        def write(_: Any, offset: int, size: int, value: int, __: Any) -> None:
            address = base + offset
            shift = 8 * (address & 3)
            kept = 0 if size == 4 else self._read(address & ~3) & ~((1 << 8 * size) - 1 << shift)
            self._write(address & ~3, kept | value << shift)

        return write

    def _timer(self, address: int) -> tuple[Timer, int] | None:
        for timer in self.timers.values():
            if timer.kind.base <= address < timer.kind.base + 0x400:
                return timer, address - timer.kind.base
        return None

    def _read(self, address: int) -> int:
        found = self._timer(address)
        if found:
            return found[0].read(found[1])
        value = self.registers.get(address, 0)
        if address == RCC + RCC_CR:  # an oscillator or PLL that is on is ready
            return value & ~0x2A022104 | (value & 0x15011000) << 1 | (value & 1) << 2 | (value & 0x80) << 1
        if address == RCC + RCC_CFGR:  # the selected clock is in use
            return value & ~0x38 | (value & 7) << 3
        if address in (RCC + RCC_BDCR, RCC + RCC_CSR):
            return value | (value & 1) << 1
        if address in (PWR + PWR_CSR1, PWR + PWR_D3CR):
            return value | VOS_READY
        if address in ADC_ISRS:  # the ADC and its regulator are ready
            return value | 1 << 12 | 1
        if address in ADC_CRS:  # the calibration is complete
            return value & ~(1 << 31)
        if address == SYST_CSR:  # COUNTFLAG: a millisecond has passed, which ST's library counts while it waits
            return value & ~(1 << 16) | self.milliseconds << 16
        if address == RTC_ICSR:  # ready for every request
            return value | RTC_READY
        if address - USART_ISR in USARTS:  # USART3 and LPUART1: enabled, and all bytes are sent
            return USART_READY
        return value

    def _write(self, address: int, value: int) -> None:
        found = self._timer(address)
        if found:
            found[0].write(found[1], value)
            return
        for first, enable in ((NVIC_ISER, True), (NVIC_ICER, False)):
            if first <= address < first + 0x20:
                numbers = {8 * (address - first) + bit for bit in range(32) if value >> bit & 1}
                self.enabled = self.enabled | numbers if enable else self.enabled - numbers
                return
        self.registers[address] = value
        for timer in self.timers.values():
            timer.clocked = bool(self.registers.get(RCC + CLOCKS[timer.kind.apb], 0) >> timer.kind.bit & 1)
            if address == RCC + RESETS[timer.kind.apb] and value >> timer.kind.bit & 1:
                timer.reset()
