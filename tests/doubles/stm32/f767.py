# SPDX-License-Identifier: Apache-2.0
"""An STM32F767: the parts that differ from the STM32H743.  It has no model of TIM9 to TIM11.

>>> # chip = Stm32f767(elf)
>>> # chip.flash.two_banks = True

Source: RM0410 (RCC, PWR, "Embedded flash memory", DMA); DS11532 (limits of clocks).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from .clocks import AHB_DIVIDERS, BDCR, CSR, LSI, Clocks
from .dma import Dma, Unreachable
from .flash import KEYS, Flash, Operation
from .flash import Surroundings as FlashSurroundings
from .gpio import MODER
from .machine import FLASH, Machine
from .timers import KINDS

RCC, PWR, FLASH_REGISTERS, GPIO = 0x40023800, 0x40007000, 0x40023C00, 0x40020000
IWDG, RTC, DMA_BASES = 0x40003000, 0x40002800, (0x40026000, 0x40026400)
USB, USB_INTERRUPT, AHB2ENR, OTGFSEN = 0x50000000, 67, 0x34, 7
RNG, RNGEN = 0x50060800, 6
ITCM, RAM, CACHED_RAM = (0x00000000, 0x4000), (0x20000000, 0x80000), (0x20020000, 0x60000)
UNIQUE_ID, FLASH_KILOBYTES = 0x1FF0F420, 0x1FF0F442
TRIGGERS = {
    "TIM1": ("TIM5", "TIM2", "TIM3", "TIM4"),
    "TIM3": ("TIM1", "TIM2", "TIM5", "TIM4"),
    "TIM5": ("TIM2", "TIM3", "TIM4", "TIM8"),
}
"""Where the inputs of a timer are others than on the STM32H743."""

CR, PLLCFGR, CFGR, AHB1ENR, APB1ENR, APB2ENR, DCKCFGR1, DCKCFGR2 = 0x00, 0x04, 0x08, 0x30, 0x40, 0x44, 0x8C, 0x90
PWR_CR1, PWR_CSR1, PWREN, RTCEN = 0x00, 0x04, 28, 10
HSI = 16_000_000
AT_RESET = {CR: 0x83, PLLCFGR: 0x24003010, AHB1ENR: 0x00100000, APB1ENR: 0x400}
RMVF, FLAGS, WATCHDOG_FLAG, POWER_FLAGS = 1 << 24, 0xFE000000, 1 << 29, 0x0E000000


class ClocksOfF767(Clocks):
    """RCC and PWR.  ``latency``: wait states of the flash."""

    def reset(self, cause: int) -> None:
        """``cause``: bits of RCC_RSR of the STM32H743."""
        flags = self.registers.get(CSR, 0) & FLAGS | (WATCHDOG_FLAG if cause >> 26 & 1 else 0)
        self.registers = AT_RESET | {BDCR: self.registers.get(BDCR, 0), CSR: flags | (POWER_FLAGS if not flags else 0)}
        self.power = {PWR_CR1: 0xC000}
        self.latency = 0

    def lose_power(self, *, battery: bool) -> None:
        self.registers[CSR] = 0
        if not battery:
            self.registers[BDCR] = 0

    def read(self, offset: int) -> int:
        value = self.registers.get(offset, 0)
        if offset == CR:
            ready = (value & 1) << 1 | (value & 0x01000000) << 1 | (0x20000 if value & 0x50000 == 0x50000 else 0)
            return value & ~0x02020002 | ready
        if offset == CFGR:
            return value & ~0xC | (value & 3) << 2
        return value | (value & 1) << 1 if offset in (BDCR, CSR) else value

    def write(self, offset: int, value: int) -> None:
        if offset == CSR:
            kept = 0 if value & RMVF else self.registers[CSR] & FLAGS
            value = kept | value & 1
        if offset == PLLCFGR:
            assert not self.registers[CR] >> 24 & 1, "the PLL is set up while it runs"
        self.registers[offset] = value

    def read_power(self, offset: int) -> int:
        value = self.power.get(offset, 0) if self.enabled(APB1ENR, PWREN) else 0
        if offset == PWR_CSR1:
            return (self.power[PWR_CR1] & 3 << 16) | (1 << 14 if self.registers[CR] >> 24 & 1 else 0)
        return value

    def write_power(self, offset: int, value: int) -> None:
        if self.enabled(APB1ENR, PWREN):
            self.power[offset] = value

    @property
    def system(self) -> int:
        return (HSI, self._hse(), self.pll(1, "p"), 0)[self.registers.get(CFGR, 0) & 3]

    def pll(self, number: int, output: str) -> int:
        assert number == 1, "there is no model of PLLI2S and PLLSAI"
        if not self.registers[CR] >> 24 & 1:
            return 0
        setting = self.registers[PLLCFGR]
        reference = (self._hse() if setting >> 22 & 1 else HSI) / (setting & 0x3F)
        vco = reference * (setting >> 6 & 0x1FF)
        assert 0.95e6 <= reference <= 2.1e6 and 100e6 <= vco <= 432e6, f"PLL: {reference} Hz, {vco} Hz"
        return int(vco) // {"p": 2 * ((setting >> 16 & 3) + 1), "q": setting >> 24 & 0xF}[output]

    @property
    def core(self) -> int:
        return self.system // AHB_DIVIDERS.get(self.registers.get(CFGR, 0) >> 4 & 0xF, 1)

    @property
    def bus(self) -> int:
        return self.core

    def _shift(self, apb: int) -> int:
        field = self.registers.get(CFGR, 0) >> {1: 10, 2: 13}[apb] & 7
        return (field & 3) + 1 if field & 4 else 0

    def peripheral(self, apb: int) -> int:
        return self.core >> self._shift(apb)

    def timer(self, apb: int) -> int:
        factor = 4 if self.registers.get(DCKCFGR1, 0) >> 24 & 1 else 2
        return min(self.core, self.peripheral(apb) * factor)

    def uart(self, apb: int) -> int:
        assert not self.registers.get(DCKCFGR2, 0) & 0xFFFF, "there is no model of other kernel clocks"
        return self.peripheral(apb)

    @property
    def random(self) -> int:
        """Of RNG and of USB: CK48MSEL."""
        return 0 if self.registers.get(DCKCFGR2, 0) >> 27 & 1 else self.pll(1, "q")

    @property
    def overdriven(self) -> bool:
        return self.power[PWR_CR1] >> 16 & 3 == 3

    def check(self) -> None:
        limit = 216 if self.overdriven else 180
        assert 0 < self.core <= limit * 1_000_000, f"a core clock of {self.core} Hz with over-drive {self.overdriven}"
        assert self.peripheral(1) <= limit * 250_000 and self.peripheral(2) <= limit * 500_000
        assert self.latency >= (self.core - 1) // 30_000_000, f"{self.latency} wait states at {self.core} Hz"
        assert self.power[PWR_CR1] >> 14 & 3 == 3, "this clock needs voltage scale 1"


STORE, STORE_SIZE = 0x08180000, 0x80000
ACR, KEYR, SR, CONTROL, OPTCR = 0x00, 0x04, 0x0C, 0x10, 0x14
PG, SER, PSIZE, BY_WORDS, STRT, BSY, ERRORS, PGPERR, N_DBANK = (
    1,
    2,
    3 << 8,
    2 << 8,
    1 << 16,
    1 << 16,
    0xF2,
    1 << 6,
    1 << 29,
)


class FlashOfF767(Flash):
    """The last 512 KiB, where the store is.  ``reads``: addresses of flash that were read during an operation."""

    def __init__(self, machine: FlashSurroundings) -> None:
        self.two_banks = False
        self.reads: list[int] = []
        self.latency = 0
        super().__init__(machine)
        self.contents = bytearray(b"\xff" * STORE_SIZE)

    @property
    def busy(self) -> bool:
        return self._operation is not None

    def _start(self) -> None:
        super()._start()
        self.registers = {CONTROL: 0x80000000}

    def read_register(self, offset: int) -> int:
        if offset == SR:
            return self.status | (BSY if self.busy else 0)
        if offset == OPTCR:
            return 0 if self.two_banks else N_DBANK
        return 0 if offset == KEYR else self.registers.get(offset, 0)

    def write_register(self, offset: int, value: int) -> None:
        locked = self.registers[CONTROL] >> 31
        if offset == KEYR:
            assert locked and value == KEYS[self._keys], f"a wrong key: {value:#x}"
            self._keys = (self._keys + 1) % len(KEYS)
            self.registers[CONTROL] &= 0x7FFFFFFF if not self._keys else 0xFFFFFFFF
        elif offset == SR:
            self.status &= ~value
        elif offset == CONTROL:
            if locked:
                return
            assert not self.busy, "FLASH_CR is written during an operation"
            self.registers[CONTROL] = value & ~STRT
            if value & STRT:
                assert value & SER and not value & PG and not self.status & ERRORS
                self._erase(value >> 3 & 0x1F)
        else:
            self.registers[offset] = value

    def _erase(self, sector: int) -> None:
        size, first = (0x20000, 24) if self.two_banks else (0x40000, 10)
        number = sector - first
        assert 0 <= number < STORE_SIZE // size, f"sector {sector} is erased, which the program is in"
        self._begin(Operation(STORE + number * size, size, None, self._after(self.erase_time)))

    def _update(self) -> None:
        """There is no model of the interrupt."""

    def peek(self, address: int, size: int) -> bytes:
        return bytes(self.contents[address - STORE : address - STORE + size])

    def read(self, offset: int, size: int) -> int:
        if self._operation:
            self.reads.append(STORE + offset)
            self.machine.stall(self._operation.until)
            self._finish()
        return int.from_bytes(self.peek(STORE + offset, size), "little")

    def write(self, offset: int, size: int, value: int) -> None:
        control = self.registers[CONTROL]
        if control >> 31 or not control & PG or control & PSIZE != BY_WORDS or size != 4 or self.busy:
            self.status |= PGPERR
            return
        self._begin(Operation(STORE + offset, size, value.to_bytes(size, "little"), self._after(self.word_time)))

    def _finish(self) -> None:
        if self._cut == len(self.operations):
            self.machine.lose_power()
            return
        operation = self._end()
        assert operation is not None
        at = slice(operation.address - STORE, operation.address - STORE + operation.size)
        data = operation.data or b"\xff" * operation.size
        old = self.contents[at] if operation.data else data
        self.contents[at] = bytes(a & b for a, b in zip(old, data))

    def _break_off(self) -> None:
        """An operation that was interrupted leaves any bits between old and new."""
        operation = self._end()
        self._cut = None
        if operation is not None:
            at = slice(operation.address - STORE, operation.address - STORE + operation.size)
            self.contents[at] = bytes(value & 0xA5 for value in self.contents[at])


REQUESTS = {
    41: {(10, 4), (13, 4)}, 42: {(15, 4)}, 43: {(5, 4)}, 44: {(6, 4)}, 45: {(1, 4)}, 46: {(3, 4), (4, 7)},
    63: {(2, 4)}, 64: {(4, 4)}, 65: {(0, 4)}, 66: {(7, 4)}, 71: {(9, 5), (10, 5)}, 72: {(14, 5), (15, 5)},
    79: {(3, 5)}, 80: {(1, 5)}, 81: {(6, 5)}, 82: {(0, 5)},
}  # fmt: skip
"""The streams and channels of the UARTs' requests, by their number on the STM32H743 (tables "DMA request mapping")."""


class DmaOfF767(Dma):
    """Fixed streams instead of a multiplexer; DTCM is reached."""

    def request(self, number: int) -> None:
        for index, stream in enumerate(self.streams):
            channel = stream.registers[0] >> 25 & 0xF
            if (index, channel) in REQUESTS[number] and stream.on and self.clocked[index // 8]:
                self._move(stream)

    def _check(self, address: int, size: int) -> None:
        assert address % size == 0, f"DMA has no model of items that are not aligned: {address:#x}"
        if not RAM[0] <= address < RAM[0] + RAM[1]:
            raise Unreachable(address)


class Stm32f767(Machine):
    clocks_of_chip, flash_of_chip, dma_of_chip = ClocksOfF767, FlashOfF767, DmaOfF767
    timers_of_chip = tuple(name for name in KINDS if name not in ("TIM15", "TIM16", "TIM17"))
    cached, volatile, kept = (CACHED_RAM,), (ITCM, RAM), ()
    store, unique_id, flash_kilobytes = STORE, UNIQUE_ID, FLASH_KILOBYTES
    gpio, dma_bases, flash_registers = GPIO, DMA_BASES, FLASH_REGISTERS
    watchdog_base, backup_base, rng_base, usb_base = IWDG, RTC, RNG, USB
    backup_clock, rng_clock = (APB1ENR, RTCEN), (AHB2ENR, RNGEN)
    clocks: ClocksOfF767
    flash: FlashOfF767

    def watch_flash(self) -> None:
        """From now on, ``flash.reads`` has what is read of the program during an operation.  This is slow."""
        module, cpu = self.processor.module, self.processor.cpu

        def look(_: Any, address: int, *__: Any) -> None:
            if self.flash.busy:
                self.flash.reads.append(address)

        def look_at_data(_: Any, __: int, address: int, *___: Any) -> None:
            look(None, address)

        cpu.hook_add(module.UC_HOOK_CODE, look, None, FLASH, STORE - 1)
        cpu.hook_add(module.UC_HOOK_MEM_READ, look_at_data, None, FLASH, STORE - 1)

    def _build_others(self) -> None:
        for name, timer in self.timers.items():
            timer.kind = replace(timer.kind, triggers=TRIGGERS.get(name, timer.kind.triggers))
        self.watchdog.frequency = LSI
        self.usb.interrupt = USB_INTERRUPT

    def _usb_is_powered(self) -> bool:
        """48 MHz of the PLL, which DCKCFGR2 selects after a reset, and the pins have their function."""
        pins = all(self.ports["A"].clocked and self.ports["A"].function(pin) == 10 for pin in (11, 12))
        selected = not self.clocks.registers.get(DCKCFGR2, 0) >> 27 & 1
        return pins and selected and self.clocks.pll(1, "q") == 48_000_000

    def _reset(self, cause: int) -> None:
        super()._reset(cause)
        for name, port in self.ports.items():
            port.write(MODER, {"A": 0xA8000000, "B": 0x00000280}.get(name, 0))

    def _read(self, address: int) -> int:
        if RCC <= address < RCC + 0x400:
            value = self.clocks.read(address - RCC)
            return value | 2 if address - RCC == CSR and self.watchdog.on else value
        if PWR <= address < PWR + 0x400:
            return self.clocks.read_power(address - PWR)
        block = self._blocks.get(address >> 10)
        return int(block[1].read(address - block[0])) if block else self.registers.get(address, 0)

    def _write(self, address: int, value: int) -> None:
        block = self._blocks.get(address >> 10)
        if RCC <= address < RCC + 0x400:
            self.clocks.write(address - RCC, value)
            self._pulse_resets(address - RCC, value)
            self._clock_gates()
            if self.clocks.core and self.clocks.core != self.processor.frequency:
                self.clocks.check()
                self.processor.set_frequency(self.clocks.core)
        elif PWR <= address < PWR + 0x400:
            self.clocks.write_power(address - PWR, value)
        elif block:
            block[1].write(address - block[0], value)
            if address == FLASH_REGISTERS + ACR:
                self.clocks.latency = value & 0xF
        else:
            self.registers[address] = value

    def _gates(self) -> list[tuple[Any, int, int]]:
        enable = {1: APB1ENR, 2: APB2ENR}
        found: list[tuple[Any, int, int]] = [(t, enable[t.kind.apb], t.kind.bit) for t in self.timers.values()]
        found += [(u, enable[u.kind.apb], u.kind.bit) for u in self.uarts.values()]
        found += [(c, AHB1ENR, 21 + n) for n, c in enumerate(self.controllers)] + [(self.usb, AHB2ENR, OTGFSEN)]
        return found + [(p, AHB1ENR, n) for n, p in enumerate(self.ports.values())]

    def _pulse_resets(self, offset: int, value: int) -> None:
        """The reset registers are 0x20 below those that enable clocks."""
        for peripheral, register, bit in self._gates():
            if register - 0x20 == offset and value >> bit & 1:
                peripheral.reset()

    def read_flash(self, address: int, size: int) -> bytes:
        return self.flash.peek(address, size) if address >= STORE else bytes(self.processor.cpu.mem_read(address, size))
