# SPDX-License-Identifier: Apache-2.0
"""The System Control Space of a Cortex-M7: SysTick, NVIC, SCB, MPU, caches and cycle counter, as registers.

Source: Armv7-M Architecture Reference Manual (DDI 0403E), B3; Cortex-M7 TRM (DDI 0489), 3 and 4.
"""

from __future__ import annotations

from collections.abc import Callable

from .agenda import UNITS
from .nvic import FIRST, NMI, PENDSV, PRIORITY_BITS, SYSTICK, bits
from .processor import Processor

CYCCNT, DWT_CTRL = 0xE0001004, 0xE0001000
SYST_CSR, SYST_RVR, SYST_CVR, SYST_CALIB = 0xE000E010, 0xE000E014, 0xE000E018, 0xE000E01C
ISER, ICER, ISPR, ICPR, IABR, IPR = 0xE000E100, 0xE000E180, 0xE000E200, 0xE000E280, 0xE000E300, 0xE000E400
CPUID, ICSR, VTOR, AIRCR, CCR, SHPR1, SHCSR = (
    0xE000ED00, 0xE000ED04, 0xE000ED08, 0xE000ED0C, 0xE000ED14, 0xE000ED18, 0xE000ED24,
)  # fmt: skip
CFSR, HFSR, BFAR, CLIDR, CTR, CCSIDR, CSSELR = (
    0xE000ED28, 0xE000ED2C, 0xE000ED38, 0xE000ED78, 0xE000ED7C, 0xE000ED80, 0xE000ED84,
)  # fmt: skip
MPU_TYPE, MPU_CTRL, MPU_RNR, MPU_RBAR, MPU_RASR = 0xE000ED90, 0xE000ED94, 0xE000ED98, 0xE000ED9C, 0xE000EDA0
STIR, FPCCR = 0xE000EF00, 0xE000EF34
DCIMVAC, DCISW, DCCMVAU, DCCMVAC, DCCSW, DCCIMVAC, DCCISW = (
    0xE000EF5C, 0xE000EF60, 0xE000EF64, 0xE000EF68, 0xE000EF6C, 0xE000EF70, 0xE000EF74,
)  # fmt: skip

ENABLE, TICKINT, CLKSOURCE, COUNTFLAG = 1, 2, 4, 1 << 16
AT_RESET = {
    CPUID: 0x411FC271, CCR: 0x00040200, CLIDR: 0x09000003, CTR: 0x8303C003, MPU_TYPE: 16 << 8, FPCCR: 0xC0000000,
}  # fmt: skip


class SysTick:
    """The timer of the core: counts down from RVR, and wraps (B3.3)."""

    def __init__(self, processor: Processor) -> None:
        self.processor = processor
        self.reset()

    def reset(self) -> None:
        self.control = self.reload = 0
        self.begin = 0
        """The time at which the counter was 0, or would have been."""
        self.stopped_at = 0
        self.wrapped = False
        self.processor.agenda.set(self, None, self._wrap)

    def _tick(self) -> int:
        """Units of time in a count."""
        frequency = self.processor.frequency if self.control & CLKSOURCE else self.processor.frequency // 8
        return max(1, UNITS // frequency)

    def _plan(self) -> None:
        running = self.control & ENABLE and self.reload
        due = self.begin + (self.reload + 1) * self._tick() if running else None
        self.processor.agenda.set(self, due, self._wrap)

    def _wrap(self) -> None:
        self.begin += (self.reload + 1) * self._tick()
        self.wrapped = True
        if self.control & TICKINT:
            self.processor.nvic.pend(SYSTICK)
        self._plan()

    def read(self, address: int) -> int:
        if address == SYST_CSR:
            value = self.control | (COUNTFLAG if self.wrapped else 0)
            self.wrapped = False
            return value
        if address == SYST_RVR:
            return self.reload
        if address == SYST_CVR:
            if not self.control & ENABLE or not self.reload:
                return self.stopped_at
            count = (self.processor.now - self.begin) // self._tick()
            return (self.reload + 1 - count) % (self.reload + 1) if count else 0
        return 0

    def write(self, address: int, value: int) -> None:
        if address == SYST_CSR:
            was = self.control
            left = self.read(SYST_CVR)
            self.control = value & 7
            if value & ENABLE and not was & ENABLE:
                self.begin = self.processor.now - (self.reload + 1 - left) % (self.reload + 1) * self._tick()
            elif not value & ENABLE:
                self.stopped_at = left
        elif address == SYST_RVR:
            self.reload = value & 0xFFFFFF
        elif address == SYST_CVR:
            self.wrapped = False
            self.stopped_at = 0
            self.begin = self.processor.now
        self._plan()


class SystemControl:
    """``on_reset()`` is called by a write of SYSRESETREQ; ``cache_line(kind, address)`` by cache maintenance."""

    def __init__(self, processor: Processor) -> None:
        self.processor = processor
        self.systick = SysTick(processor)
        self.on_reset: Callable[[], None] = lambda: None
        self.on_memory_attributes: Callable[[], None] = lambda: None
        self.maintain: Callable[[int, int], None] = lambda register, value: None
        self.reset()

    def reset(self) -> None:
        self.registers = dict(AT_RESET)
        self.systick.reset()
        self.cycles_from = 0
        self.regions: dict[int, tuple[int, int]] = {}
        """RBAR and RASR of each region of the MPU."""
        self.processor.ignore_bus_faults = False

    def read(self, address: int) -> int:
        nvic = self.processor.nvic
        if SYST_CSR <= address <= SYST_CALIB:
            return self.systick.read(address)
        if address == CYCCNT:
            return self._cycles() & 0xFFFFFFFF
        for first, mask in ((ISER, nvic.enabled), (ICER, nvic.enabled), (ISPR, nvic.pending), (ICPR, nvic.pending),
                            (IABR, nvic.active)):  # fmt: skip
            if first <= address < first + 0x20:
                return mask >> FIRST + 8 * (address - first) & 0xFFFFFFFF
        if IPR <= address < IPR + 240:
            return self._priorities(FIRST + address - IPR)
        if SHPR1 <= address < SHPR1 + 12:
            return self._priorities(4 + address - SHPR1)
        if address == ICSR:
            return self._icsr()
        if address == VTOR:
            return self.processor.vectors
        if address == AIRCR:
            return 0xFA050000 | self._prigroup() << 8
        if address == SHCSR:
            return (nvic.enabled >> 4 & 7) << 16
        if address == CFSR:
            return self.processor.fault_status
        if address == HFSR:
            return self.processor.hard_fault_status
        if address == BFAR:
            return self.processor.fault_address
        if address == CCSIDR:
            return 0xF01FE009 if self.registers.get(CSSELR, 0) & 1 else 0xF00FE019
        if MPU_RBAR <= address <= MPU_RBAR + 28:
            number = self.registers.get(MPU_RNR, 0)
            return self.regions.get(number, (0, 0))[(address - MPU_RBAR) // 4 & 1]
        return self.registers.get(address, 0)

    def write(self, address: int, value: int) -> None:
        nvic = self.processor.nvic
        if SYST_CSR <= address <= SYST_CALIB:
            self.systick.write(address, value)
        elif address == CYCCNT:
            self.cycles_from = 0
            self.cycles_from = self._cycles() - value
        elif ISER <= address < ISER + 0x20:
            nvic.enabled |= value << FIRST + 8 * (address - ISER)
            nvic.changed()
        elif ICER <= address < ICER + 0x20:
            nvic.enabled &= ~(value << FIRST + 8 * (address - ICER))
        elif ISPR <= address < ISPR + 0x20:
            for bit in bits(value):
                nvic.pend(FIRST + 8 * (address - ISPR) + bit)
        elif ICPR <= address < ICPR + 0x20:
            for bit in bits(value):
                nvic.clear(FIRST + 8 * (address - ICPR) + bit)
        elif IPR <= address < IPR + 240:
            self._set_priorities(FIRST + address - IPR, value)
        elif SHPR1 <= address < SHPR1 + 12:
            self._set_priorities(4 + address - SHPR1, value)
        elif address == STIR:
            nvic.pend(FIRST + (value & 0x1FF))
        elif address == ICSR:
            self._write_icsr(value)
        elif address == VTOR:
            self.processor.vectors = value & 0xFFFFFF80
        elif address == AIRCR:
            self._write_aircr(value)
        elif address == SHCSR:
            nvic.enabled = nvic.enabled & ~(7 << 4) | (value >> 16 & 7) << 4
        elif address == CFSR:
            self.processor.fault_status &= ~value
        elif address == HFSR:
            self.processor.hard_fault_status &= ~value
        elif address == FPCCR:
            self.registers[FPCCR] = value & 0xC0000000
            self.processor.automatic_fp = bool(value >> 31)
        elif DCIMVAC <= address <= DCCISW:
            self.maintain(address, value)
        elif MPU_CTRL <= address <= MPU_RBAR + 28 or address == CCR:
            self._write_memory(address, value)
        elif address not in AT_RESET:
            self.registers[address] = value

    def _write_memory(self, address: int, value: int) -> None:
        """MPU and CCR, which turns the caches on."""
        if address >= MPU_RBAR:
            number = self.registers.get(MPU_RNR, 0)
            base, attributes = self.regions.get(number, (0, 0))
            if (address - MPU_RBAR) // 4 & 1:
                attributes = value
            else:
                if value & 0x10:  # VALID
                    number = value & 0xF
                    self.registers[MPU_RNR] = number
                    attributes = self.regions.get(number, (0, 0))[1]
                base = value & ~0x1F | number
            self.regions[number] = (base, attributes)
        else:
            self.registers[address] = value | (0x200 if address == CCR else 0)
        if address == CCR:
            self.processor.ignore_bus_faults = bool(value & 1 << 8)
        self.on_memory_attributes()

    def _cycles(self) -> int:
        return self.processor.now * self.processor.frequency // UNITS - self.cycles_from

    def _priorities(self, first: int) -> int:
        return sum(self.processor.nvic.priorities[first + n] << 8 * n for n in range(4))

    def _set_priorities(self, first: int, value: int) -> None:
        for n in range(4):
            self.processor.nvic.priorities[first + n] = value >> 8 * n & PRIORITY_BITS
        self.processor.nvic.changed()

    def _prigroup(self) -> int:
        return (~self.processor.nvic.group_bits & 0xFF).bit_length() - 1

    def _icsr(self) -> int:
        nvic = self.processor.nvic
        due = nvic.pending & nvic.enabled
        pending = min(bits(due), key=lambda number: (nvic.priorities[number], number), default=0)
        value = self.processor.read("IPSR") & 0x1FF | pending << 12
        value |= (nvic.pending >> FIRST != 0) << 22
        value |= (nvic.pending >> SYSTICK & 1) << 26 | (nvic.pending >> PENDSV & 1) << 28
        return value | (bin(nvic.active).count("1") <= 1) << 11

    def _write_icsr(self, value: int) -> None:
        nvic = self.processor.nvic
        for number, set_bit, clear_bit in ((SYSTICK, 26, 25), (PENDSV, 28, 27)):
            if value >> set_bit & 1:
                nvic.pend(number)
            elif value >> clear_bit & 1:
                nvic.clear(number)
        if value >> 31:
            nvic.pend(NMI)

    def _write_aircr(self, value: int) -> None:
        if value >> 16 != 0x05FA:
            return
        self.processor.nvic.group_bits = ~((2 << (value >> 8 & 7)) - 1) & 0xFF
        if value & 4:  # SYSRESETREQ
            self.on_reset()
        self.processor.nvic.changed()
