# SPDX-License-Identifier: Apache-2.0
"""An STM32H743 with an image in its flash: processor, memories, and the peripherals that EPG's firmware uses.

>>> # chip = Machine(elf)
>>> # chip.run_to("main")
>>> # chip.run(0.5)                                     # seconds of the chip's time
>>> # chip.uarts[3].line.send(b"help\\r")
>>> # chip.attach("TIM4", ("D", 12), ("D", 13), alternate_function=2)
>>> # chip.turn("TIM4", -120)

``clocks``: clock cycles that an instruction takes.  1 is nearest to the chip; a larger number makes long runs faster.
Registers without a model keep the value that was written.
"""

from __future__ import annotations

import random
import struct
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import clocks as clock_registers
from . import timers as timer_registers
from .agenda import UNITS, Agenda
from .cache import Cache
from .clocks import DBGMCU, PWR, RCC, SYSCFG, Clocks
from .dma import BASES as DMA_BASES
from .dma import MUX, Block, Dma, Multiplexer
from .flash import BANK, Flash
from .flash import REGISTERS as FLASH_REGISTERS
from .flash import Block as FlashBlock
from .gpio import Port
from .image import Image
from .nvic import FIRST
from .processor import Processor
from .rng import RNG, Rng
from .system_control import SystemControl
from .timers import Level, Timer
from .uart import KINDS as UART_KINDS
from .uart import Uart
from .usb import BASE as USB_BASE
from .usb import ENDPOINTS as USB_ENDPOINTS
from .usb import FIFOS, Usb
from .watchdog import IWDG, RTC, Watchdog
from .watchdog import Backup as BackupRegisters

FLASH, FLASH_SIZE, SECTOR = 0x08000000, 0x200000, 0x20000
ITCM, DTCM, AXI, SRAM_D2, SRAM_D3, BACKUP, SYSTEM = (
    (0x00000000, 0x10000), (0x20000000, 0x20000), (0x24000000, 0x80000), (0x30000000, 0x48000),
    (0x38000000, 0x10000), (0x38800000, 0x1000), (0x1FF00000, 0x20000),
)  # fmt: skip
UNIQUE_ID, FLASH_KILOBYTES = 0x1FF1E800, 0x1FF1E880
PERIPHERALS, PERIPHERALS_SIZE = 0x40000000, 0x20000000
PRIVATE, PRIVATE_SIZE = 0xE0000000, 0x100000
CRS = 0x40008400
GPIO, PORTS = 0x58020000, "ABCDEFGHIJK"
POWER_ON, SOFTWARE, WATCHDOG = 0x00FE0000, 1 << 24 | 1 << 22 | 1 << 17, 1 << 26 | 1 << 22 | 1 << 17
"""Bits of RCC_RSR (RM0433, 8.7.39)."""


@dataclass(frozen=True)
class PinChange:
    """``level``: of an output, or None from when the pin is no output."""

    time: int
    pin: str
    level: int | None


class PowerCut(Exception):
    """The power is off; ``power_cycle()`` brings it back."""


class Machine:
    """``crystal``: Hz at OSC_IN, from the ST-LINK of a Nucleo.  ``revision``: DBGMCU_IDCODE."""

    clocks_of_chip, flash_of_chip, dma_of_chip = Clocks, Flash, Dma
    timers_of_chip = tuple(timer_registers.KINDS)
    cached = (AXI, SRAM_D2, SRAM_D3)
    volatile, kept = (ITCM, DTCM, *cached), (BACKUP,)
    """RAM that loses its contents with the power, and with VBAT."""
    store, unique_id, flash_kilobytes = BANK, UNIQUE_ID, FLASH_KILOBYTES
    """Where the part of the flash that ``flash`` models begins, up to the end; and what the chip says about itself."""
    gpio, dma_bases, flash_registers = GPIO, DMA_BASES, FLASH_REGISTERS
    watchdog_base, backup_base, rng_base, usb_base = IWDG, RTC, RNG, USB_BASE
    backup_clock = clock_registers.APB4ENR, clock_registers.RTCAPBEN
    rng_clock = clock_registers.AHB2ENR, clock_registers.RNGEN

    def __init__(
        self,
        elf: Path,
        *,
        clocks: int = 1,
        crystal: int = 8_000_000,
        revision: int = clock_registers.REVISION_V,
        identity: bytes = bytes(range(12)),
    ) -> None:
        self.image = Image(elf)
        self.symbols = self.image.symbols
        self.processor = Processor(clocks=clocks)
        self.agenda: Agenda = self.processor.agenda
        self.revision = revision
        self.clocks = self.clocks_of_chip(crystal, revision)
        self.control = SystemControl(self.processor)
        self.control.on_reset = lambda: self._will_reset(SOFTWARE)
        self.levels: list[Level] = []
        """The PWM levels that have taken effect."""
        self.pin_changes: list[PinChange] = []
        self.resets: list[int] = []
        """The causes of all resets since the power came on, as bits of RCC_RSR."""
        self._cause: int | None = None
        self._powered = True
        self.flash = self.flash_of_chip(self)
        self._map(identity)
        self.processor.start(DTCM[0])
        self.processor.watch(self.image.unmasks)
        self.registers: dict[int, int] = {}
        self.cache = Cache(self.processor.cpu, self.control, self.cached)
        self._build()
        self.encoders: dict[str, tuple[tuple[str, int], tuple[str, int], int]] = {}
        self._reset(POWER_ON)
        self.resets.clear()

    def _map(self, identity: bytes) -> None:
        cpu = self.processor.cpu
        for base, size in (*self.volatile, *self.kept, SYSTEM, (FLASH, self.store - FLASH)):
            cpu.mem_map(base, size)
        cpu.mem_write(FLASH, b"\xff" * (self.store - FLASH))
        for address, data in self.image.segments:
            self.flash.load(address, data) if address >= self.store else cpu.mem_write(address, data)
        flash = self.flash
        cpu.mmio_map(
            self.store, len(flash.contents), lambda _, at, size, __: flash.read(at, size), None,
            lambda _, at, size, value, __: flash.write(at, size, value), None,
        )  # fmt: skip
        cpu.mem_write(self.unique_id, identity)
        cpu.mem_write(self.flash_kilobytes, struct.pack("<H", FLASH_SIZE // 1024))
        self._map_registers()

    def _map_registers(self) -> None:
        cpu = self.processor.cpu
        for base, size, access in (
            (PERIPHERALS, PERIPHERALS_SIZE, (self._read, self._write)),
            (PRIVATE, PRIVATE_SIZE, (self.control.read, self.control.write)),
        ):
            cpu.mmio_map(base, size, _reader(base, access[0]), None, _writer(base, *access), None)

    def _build(self) -> None:
        self._blocks: dict[int, tuple[int, Any]] = {}
        """The peripheral at each block of 1 KiB, and its base address."""
        self.timers = {name: Timer(name, self) for name in self.timers_of_chip}
        for timer in self.timers.values():
            self._place(timer.kind.base, timer)
        self.uarts = {number: Uart(number, self) for number in UART_KINDS}
        for uart in self.uarts.values():
            self._place(uart.kind.base, uart)
        self.ports = {name: Port(name, self._pin_changed(name)) for name in PORTS}
        for number, port in enumerate(self.ports.values()):
            self._place(self.gpio + 0x400 * number, port)
        self.dma = self.dma_of_chip(self)
        self.controllers = [Block(self.dma, number) for number in range(2)]
        for base, controller in zip(self.dma_bases, self.controllers):
            self._place(base, controller)
        self._place(self.flash_registers, FlashBlock(self.flash))
        self.watchdog = Watchdog(self)
        self._place(self.watchdog_base, self.watchdog)
        self.backup = BackupRegisters(
            lambda: self.clocks.enabled(*self.backup_clock),
            lambda: bool(self.clocks.power[clock_registers.PWR_CR1] & clock_registers.DBP),
        )
        self._place(self.backup_base, self.backup)
        self.rng = Rng(lambda: self.clocks.enabled(*self.rng_clock), lambda: self.clocks.random)
        self._place(self.rng_base, self.rng)
        self.usb = Usb(self, self._usb_is_powered)
        self._place(self.usb_base, self.usb, FIFOS + 0x1000 * USB_ENDPOINTS)
        self._build_others()

    def _build_others(self) -> None:
        """What only this chip has."""
        self._place(MUX, Multiplexer(self.dma))

    def _place(self, base: int, peripheral: Any, size: int = 0x400) -> None:
        for block in range(base >> 10, (base + size) >> 10):
            self._blocks[block] = (base, peripheral)

    def _usb_is_powered(self) -> bool:
        """The supply is monitored, HSI48 is the clock, frames of OTG_FS trim it, and the pins have their function."""
        frames = 3 if self.revision == clock_registers.REVISION_V else 0
        trimmed = self.registers.get(CRS, 0) & 0x60 == 0x60 and self.registers.get(CRS + 4, 0) >> 28 & 3 == frames
        pins = all(self.ports["A"].clocked and self.ports["A"].function(pin) == 10 for pin in (11, 12))
        return self.clocks.usb == clock_registers.HSI48 and trimmed and pins

    # Running ----------------------------------------------------------------------------------------------------------

    @property
    def now(self) -> int:
        return self.processor.now

    @property
    def seconds(self) -> float:
        return self.processor.now / UNITS

    def run(self, seconds: float) -> None:
        """Runs for a time, over resets too.  Raises PowerCut where the power is cut."""
        self.run_until_time(self.processor.time + round(seconds * UNITS))

    def run_until_time(self, time: int) -> None:
        """The same up to a time in units."""
        self._run(time, lambda: False)

    def run_to(self, symbol: str, *, longest: float = 5.0) -> None:
        """Runs until the processor is about to execute the first instruction of a function."""
        address = self.symbols[symbol] & ~1
        reached = False

        def arrive(*_: Any) -> None:
            nonlocal reached
            reached = True
            self.processor.cpu.emu_stop()
            self.processor.stopped = True

        hook = self.processor.cpu.hook_add(self.processor.module.UC_HOOK_CODE, arrive, None, address, address)
        self._run(self.processor.time + round(longest * UNITS), lambda: reached)
        self.processor.cpu.hook_del(hook)
        self.processor.sleeping = False
        assert reached, f"{symbol}() was not reached: the processor is at {self.processor.pc:#x}"

    def run_until(self, condition: Callable[[], bool], *, longest: float = 5.0, step: float = 0.001) -> None:
        """Runs in steps until a condition is true."""
        end = self.processor.time + round(longest * UNITS)
        while not condition():
            assert self.processor.time < end, f"it did not come true: the processor is at {self.processor.pc:#x}"
            self.run(step)

    def _run(self, until: int, reached: Callable[[], bool]) -> None:
        while self.processor.time < until and not reached():
            if self._powered:
                self.processor.run(until)
            if not self._powered:
                raise PowerCut
            if self._cause is not None:
                self._reset(self._cause)

    def _will_reset(self, cause: int) -> None:
        self._cause = cause
        self.processor.stopped = True
        self.processor.halt()

    def lose_power(self) -> None:
        """Stops until ``power_cycle()``."""
        self._powered = False
        self.processor.stopped = True
        self.processor.halt()

    def power_cycle(self, *, battery: bool = False) -> None:
        """RAM has any contents then.  ``battery``: at VBAT, which keeps the backup domain."""
        chance = random.Random(self.processor.time)
        self._powered = True
        self.clocks.lose_power(battery=battery)
        if not battery:
            self.backup.clear()
        self._reset(POWER_ON)
        for base, size in (*self.volatile, *(() if battery else self.kept)):
            self.processor.cpu.mem_write(base, chance.randbytes(size))

    def watchdog_expired(self) -> None:
        self._will_reset(WATCHDOG)

    def _reset(self, cause: int) -> None:
        """Memories and the backup domain keep their contents."""
        self._cause = None
        self.resets.append(cause)
        self.clocks.reset(cause)
        self.cache.lose()
        self.control.reset()
        self.registers = {DBGMCU: self.revision}
        for peripheral in {id(block[1]): block[1] for block in self._blocks.values()}.values():
            peripheral.reset()
        self._clock_gates()
        self.processor.reset(FLASH)
        self.processor.set_frequency(self.clocks.core)

    # Registers --------------------------------------------------------------------------------------------------------

    def _read(self, address: int) -> int:
        block = self._blocks.get(address >> 10)
        if block is not None:
            return int(block[1].read(address - block[0]))
        if RCC <= address < RCC + 0x400:
            value = self.clocks.read(address - RCC)
            # The watchdog enables LSI without LSION (RM0433, 45.3).
            return value | 2 if address - RCC == clock_registers.CSR and self.watchdog.on else value
        if PWR <= address < PWR + 0x400:
            return self.clocks.read_power(address - PWR)
        return self.registers.get(address, 0)

    def _write(self, address: int, value: int) -> None:
        block = self._blocks.get(address >> 10)
        if block is not None:
            block[1].write(address - block[0], value)
        elif RCC <= address < RCC + 0x400:
            self.clocks.write(address - RCC, value)
            self._pulse_resets(address - RCC, value)
            if address - RCC == clock_registers.BDCR and value & clock_registers.BDRST:
                self.backup.clear()
            self._clock_gates()
            if self.clocks.core and self.clocks.core != self.processor.frequency:
                self.clocks.check()
                self.processor.set_frequency(self.clocks.core)
        elif PWR <= address < PWR + 0x400:
            self.clocks.power[address - PWR] = value
        else:
            if address == SYSCFG + clock_registers.PWRCR:
                self.clocks.overdrive = value & 1
            self.registers[address] = value

    def _gates(self) -> list[tuple[Any, int, int]]:
        """Peripherals with their registers that enable the clock, and the bit."""
        enable = {1: clock_registers.APB1LENR, 2: clock_registers.APB2ENR}
        found: list[tuple[Any, int, int]] = [(t, enable[t.kind.apb], t.kind.bit) for t in self.timers.values()]
        found += [(u, enable[u.kind.apb], u.kind.bit) for u in self.uarts.values()]
        found += [(c, clock_registers.AHB1ENR, n) for n, c in enumerate(self.controllers)]
        found += [(self.usb, clock_registers.AHB1ENR, 27)]
        return found + [(p, clock_registers.AHB4ENR, n) for n, p in enumerate(self.ports.values())]

    def _clock_gates(self) -> None:
        for peripheral, register, bit in self._gates():
            clocked = self.clocks.enabled(register, bit)
            if isinstance(peripheral, Timer):
                peripheral.set_clock(clocked, self.clocks.timer(peripheral.kind.apb))
            else:
                peripheral.clocked = clocked

    def _pulse_resets(self, offset: int, value: int) -> None:
        """The reset registers are 0x58 below those that enable clocks (RM0433, 8.7)."""
        for peripheral, register, bit in self._gates():
            if register - 0x58 == offset and value >> bit & 1:
                peripheral.reset()

    # What peripherals need --------------------------------------------------------------------------------------------

    def timer_clock(self, apb: int) -> int:
        return self.clocks.timer(apb)

    def uart_clock(self, apb: int) -> int:
        return self.clocks.uart(apb)

    def line(self, interrupt: int, source: object, high: bool) -> None:
        self.processor.nvic.line(interrupt, source, high)

    def triggered(self, name: str) -> list[Timer]:
        return [timer for timer in self.timers.values() if timer.listens_to() == name]

    def levels_changed(self, level: Level) -> None:
        self.levels.append(level)

    def request(self, number: int) -> None:
        """A request for a transfer by DMA."""
        self.dma.request(number)

    def ask_for_requests(self) -> None:
        for uart in self.uarts.values():
            uart.want_data()
            uart.offer_data()

    @property
    def bus_clock(self) -> int:
        return self.clocks.bus

    def read_flash(self, address: int, size: int) -> bytes:
        return self.flash.peek(address, size) if address >= BANK else bytes(self.processor.cpu.mem_read(address, size))

    def stall(self, until: int) -> None:
        self.processor.stall(until)

    def bus_error(self, address: int) -> None:
        self.processor.bus_error(address)

    def read_register(self, address: int, size: int) -> int:
        return self._read(address & ~3) >> 8 * (address & 3) & (1 << 8 * size) - 1

    def write_register(self, address: int, value: int, size: int) -> None:
        assert size == 4 or _is_data(address), f"DMA has no model of writing {size} bytes of a register: {address:#x}"
        self._write(address, value)

    def _pin_changed(self, port: str) -> Callable[[int, int | None], None]:
        def changed(pin: int, level: int | None) -> None:
            self.pin_changes.append(PinChange(self.processor.now, f"P{port}{pin}", level))

        return changed

    # The world --------------------------------------------------------------------------------------------------------

    def pin(self, name: str) -> int | None:
        """The level of an output such as ``PB0``; None if the pin is no output."""
        return self.ports[name[1]].driven[int(name[2:])]

    def attach(self, timer: str, a: tuple[str, int], b: tuple[str, int], *, alternate_function: int) -> None:
        """Connects an encoder to two pins, (port, number), which are the timer's by that alternate function."""
        self.encoders[timer] = (a, b, alternate_function)

    def turn(self, timer: str, edges: int) -> None:
        """Turns a shaft, at once."""
        first, second, function = self.encoders[timer]
        connected = all(
            self.ports[port].clocked and self.ports[port].function(pin) == function for port, pin in (first, second)
        )
        while connected and edges:
            edges -= self.timers[timer].move(edges)

    def interrupts(self, interrupt: int) -> int:
        """How often an interrupt of the chip was entered since the reset."""
        return self.processor.nvic.entered.get(FIRST + interrupt, 0)

    def before(self, symbol: str, act: Callable[[], None]) -> None:
        """Calls ``act`` whenever the processor is about to execute the first instruction of a function."""
        address = self.symbols[symbol] & ~1
        self.processor.cpu.hook_add(self.processor.module.UC_HOOK_CODE, lambda *_: act(), None, address, address)

    def patch(self, symbol: str, instruction: bytes) -> Callable[[], None]:
        """Replaces the first instruction of a function; returns a function that restores it."""
        cpu, address = self.processor.cpu, self.symbols[symbol] & ~1
        before = bytes(cpu.mem_read(address, len(instruction)))

        def put(data: bytes) -> None:
            cpu.mem_write(address, data)
            cpu.ctl_flush_tb()

        put(instruction)
        return lambda: put(before)

    # Memory -----------------------------------------------------------------------------------------------------------

    def word(self, symbol: str, *, offset: int = 0, size: int = 4, signed: bool = False) -> int:
        data = bytes(self.processor.cpu.mem_read(self.symbols[symbol] + offset, size))
        return int.from_bytes(data, "little", signed=signed)

    def write_word(self, symbol: str, value: int, *, offset: int = 0, size: int = 4) -> None:
        data = (value % (1 << 8 * size)).to_bytes(size, "little")
        self.processor.cpu.mem_write(self.symbols[symbol] + offset, data)


def _reader(base: int, read: Callable[[int], int]) -> Any:
    def access(_: Any, offset: int, size: int, __: Any) -> int:
        if size == 4:
            return read(base + offset) & 0xFFFFFFFF
        address = base + offset
        return read(address & ~3) >> 8 * (address & 3) & (1 << 8 * size) - 1

    return access


def _writer(base: int, read: Callable[[int], int], write: Callable[[int, int], None]) -> Any:
    def access(_: Any, offset: int, size: int, value: int, __: Any) -> None:
        if size == 4:
            write(base + offset, value & 0xFFFFFFFF)
            return
        address = base + offset
        shift = 8 * (address & 3)
        # Registers whose read has an effect, and data registers of a byte, have nothing in their other bytes.
        kept = 0 if shift == 0 and _is_data(address) else read(address & ~3) & ~((1 << 8 * size) - 1 << shift)
        write(address & ~3, kept | value << shift)

    return access


def _is_data(address: int) -> bool:
    """True for a UART's TDR, and for set and reset registers of ports."""
    return address & 0x3FF in (0x28, 0x18)
