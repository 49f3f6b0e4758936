# SPDX-License-Identifier: Apache-2.0
"""A Cortex-M7 with time: unicorn executes instructions, and this module enters and leaves exceptions.

Time passes by a fixed number of clock cycles for each instruction.  WFI, WFE and a branch to itself skip to the next
event.  Exceptions are entered between two instructions, and nest.  The registers of the FPU are stacked at once, also
where FPCCR.LSPEN asks for a lazy way: no program can see the difference.  Not modelled: access rights of the MPU,
unprivileged threads, traps of unaligned accesses and of divisions by 0, and a disabled FPU.

Source: Armv7-M Architecture Reference Manual (DDI 0403E), B1.5.
"""

from __future__ import annotations

import struct
from typing import Any

from tests.doubles.toolchain import unicorn

from .agenda import UNITS, Agenda
from .counters import Counters
from .nvic import BUS_FAULT, HARD_FAULT, MEM_MANAGE, NMI, SVCALL, USAGE_FAULT, Nvic

NOWHERE = 0xFFFFFFFE
BRANCH_TO_ITSELF, WAIT_FOR_EVENT = 0xE7FE, 0xBF20
SWI, BREAKPOINT, EXCEPTION_EXIT = 2, 7, 8
"""unicorn's numbers of exceptions (QEMU's target/arm/cpu.h)."""
SPSEL, FPCA = 2, 4
IT_STATE, ALIGNED, THUMB = 0x0600FC00, 1 << 9, 1 << 24

UNDEFINED, INVALID_STATE = 1 << 16, 1 << 17
PRECISE, STACKING, FETCH, ADDRESS_VALID = 1 << 9, 1 << 12, 1 << 8, 1 << 15
"""Bits of CFSR (B3.2.15)."""


class Lockup(Exception):
    """A fault at the priority of HardFault or NMI: the processor stops without end, until a reset."""


class Processor:
    """Map memories, then call ``start()``.  ``clocks``: clock cycles of an instruction."""

    def __init__(self, *, clocks: int) -> None:
        self.module: Any = unicorn()
        self.arm = self.module.arm_const
        # With UC_MODE_MCLASS, unicorn ignores the model that is asked for, and has no arithmetic of doubles.
        self.cpu = self.module.Uc(self.module.UC_ARCH_ARM, self.module.UC_MODE_THUMB)
        self.cpu.ctl_set_cpu_model(self.arm.UC_CPU_ARM_CORTEX_M7)
        self.clocks = clocks
        self.time = 0
        """Units since the power came on, at the begin of the present run."""
        self.agenda = Agenda()
        self.agenda.sooner = self._sooner
        self.nvic = Nvic(self._masks, self._changed)
        self.vectors = 0
        self.automatic_fp = True
        """FPCCR.ASPEN: exceptions stack the registers of the FPU."""
        self.fault_status = self.fault_address = self.hard_fault_status = 0
        self.stopped = False
        self.in_run = self.sleeping = False
        self.seen: int | None = None
        self.fault: tuple[int, int, int] | None = None
        self.instructions = 0
        """Instructions executed in all runs."""
        self.set_frequency(64_000_000)

    def start(self, code: int) -> None:
        """Finishes the construction.  ``code``: an address of mapped memory whose contents do not matter yet."""
        self.cpu.mem_write(code, struct.pack("<2H", 0x3601, 0xE7FD))  # adds r6, #1; b .-2
        self.counters = Counters(self.cpu, code)
        self.cpu.mem_write(code, bytes(4))
        self._registers = [getattr(self.arm, f"UC_ARM_REG_{name}") for name in ("R0", "R1", "R2", "R3", "R12", "LR")]
        self._singles = [self.arm.UC_ARM_REG_S0 + number for number in range(16)]
        self.cpu.hook_add(self.module.UC_HOOK_INTR, self._on_exception)
        self.cpu.hook_add(self.module.UC_HOOK_MEM_UNMAPPED, self._on_unmapped)
        for number in range(13):
            self.write(f"R{number}", 0)
        self._after_reset = self.cpu.context_save()

    def watch(self, addresses: list[int]) -> None:
        """Names the instructions that can end the masking of interrupts."""
        for address in addresses:
            self.cpu.hook_add(self.module.UC_HOOK_CODE, self._on_unmask, None, address, address)

    def reset(self, vectors: int) -> None:
        self.cpu.context_restore(self._after_reset)
        self.nvic.reset()
        self.vectors = vectors
        self.automatic_fp = True
        self.fault_status = self.fault_address = self.hard_fault_status = 0
        self.sleeping = False
        self.fault = None
        stack, entry = struct.unpack("<2I", self.cpu.mem_read(vectors, 8))
        self.write("SP", stack & ~3)
        self.write("LR", 0xFFFFFFFF)
        self.write("PC", entry | 1)

    # Registers --------------------------------------------------------------------------------------------------------

    def read(self, name: str) -> int:
        return int(self.cpu.reg_read(getattr(self.arm, f"UC_ARM_REG_{name}"))) & 0xFFFFFFFF

    def write(self, name: str, value: int) -> None:
        self.cpu.reg_write(getattr(self.arm, f"UC_ARM_REG_{name}"), value)

    @property
    def pc(self) -> int:
        return self.read("PC") & ~1

    def _masks(self) -> tuple[int, int, int]:
        return self.read("PRIMASK") & 1, self.read("FAULTMASK") & 1, self.read("BASEPRI")

    # Time -------------------------------------------------------------------------------------------------------------

    def set_frequency(self, frequency: int) -> None:
        self._settle()
        self.frequency = frequency
        self.unit = max(1, round(UNITS * self.clocks / frequency))
        """Units of time in an instruction."""
        if self.in_run:
            self.halt()

    @property
    def now(self) -> int:
        return self.time + self._passed() * self.unit

    def _passed(self) -> int:
        return self.counters.executed - self._settled if self.in_run else 0

    def _settle(self) -> None:
        """Adds the instructions so far to the time, so that those that follow may last longer or shorter."""
        if self.in_run:
            passed = self._passed()
            self.time += passed * self.unit
            self._settled += passed

    def stall(self, until: int) -> None:
        """The present access lasts until this time."""
        self._settle()
        self.time = max(self.time, until)
        self.halt()

    def halt(self) -> None:
        """Ends the present run after the present instruction, to look at interrupts and events."""
        if self.in_run:
            self.counters.stop_after(0)

    def _sooner(self, time: int) -> None:
        if self.in_run:
            left = -(-(time - self.time) // self.unit)
            if left + self._settled < self._planned:
                self._planned = left + self._settled
                self.counters.stop_after(self._planned)

    def _changed(self) -> None:
        if self.in_run and self.nvic.due() is not None:
            self.halt()

    # Running ----------------------------------------------------------------------------------------------------------

    def run(self, until: int) -> None:
        """Runs until a time, or until something sets ``stopped``."""
        self.stopped = False
        while self.time < until and not self.stopped:
            self.agenda.deliver(self.time)
            if self.stopped:
                return
            number = self.nvic.due() if self.nvic.pending else None
            if number is not None:
                self.sleeping = False
                self.enter(number, self.pc)
            elif self.sleeping and self.nvic.pending and self.nvic.due(without_primask=True) is not None:
                self.sleeping = False
            limit = min(until, self.agenda.next)
            if limit > self.time:
                if self.sleeping:
                    self.time = limit
                else:
                    self._execute(-(-(limit - self.time) // self.unit))
        if not self.stopped:
            self.agenda.deliver(self.time)

    def _execute(self, instructions: int) -> None:
        pc = self.pc
        self.seen = self.fault = None
        self._planned, self._settled = instructions, 0
        self.in_run = True
        problem = None
        try:
            self.cpu.emu_start(pc | 1, NOWHERE, count=instructions)
        except self.module.UcError as error:
            problem = error
        passed = self._passed()
        self.in_run = False
        self.instructions += self.counters.executed
        self.time += passed * self.unit
        if problem is not None:
            self._problem(problem)
        elif self.fault is not None:
            number, status, address = self.fault
            self._take_fault(number, status, address, self._fault_at)
        elif self.seen == EXCEPTION_EXIT:
            self._return(self.read("PC") | 1)
        elif self.seen == SWI:
            self._synchronous(SVCALL, self.pc)
        elif self.seen == BREAKPOINT:
            self._take_fault(HARD_FAULT, 0, 0, self.pc)
        elif self.seen is not None:
            raise AssertionError(f"unicorn's exception {self.seen} at {self.pc:#x}")
        elif not self.counters.complete or (passed and self._halfword(self.pc) == BRANCH_TO_ITSELF):
            self.sleeping = True

    def _halfword(self, address: int) -> int:
        try:
            return int.from_bytes(self.cpu.mem_read(address, 2), "little")
        except self.module.UcError:
            return 0

    def _problem(self, error: Any) -> None:
        at = self.pc
        if self.fault is not None:  # no memory is there
            number, status, address = self.fault
            self._take_fault(number, status, address, at)
        elif self._halfword(at) == WAIT_FOR_EVENT:
            self.write("PC", at + 2 | 1)
            self.sleeping = True
        elif error.errno == self.module.UC_ERR_INSN_INVALID:
            self._take_fault(USAGE_FAULT, UNDEFINED, 0, at)
        elif error.errno == self.module.UC_ERR_EXCEPTION:
            self._take_fault(USAGE_FAULT, INVALID_STATE, 0, at)
        else:
            raise AssertionError(f"{error} at {at:#x}")

    # Hooks ------------------------------------------------------------------------------------------------------------

    def _on_exception(self, cpu: Any, number: int, _: Any) -> None:
        self.seen = number
        cpu.emu_stop()

    def _on_unmapped(self, cpu: Any, access: int, address: int, size: int, value: int, _: Any) -> bool:
        fetch = access in (self.module.UC_MEM_FETCH_UNMAPPED, self.module.UC_MEM_FETCH)
        self.fault = (BUS_FAULT, FETCH if fetch else PRECISE | ADDRESS_VALID, address)
        return False

    def _on_unmask(self, cpu: Any, address: int, size: int, _: Any) -> None:
        if self.nvic.pending & self.nvic.enabled:
            self.halt()

    # Faults -----------------------------------------------------------------------------------------------------------

    def bus_error(self, address: int) -> None:
        """The present access, at a register or a memory with a model, has failed.  Its register keeps no value."""
        if self.nvic.running() < 0 and self.ignore_bus_faults:
            self.fault_status |= PRECISE | ADDRESS_VALID
            self.fault_address = address
            return
        self._fault_at = self.pc
        self.fault = (BUS_FAULT, PRECISE | ADDRESS_VALID, address)
        self.halt()

    ignore_bus_faults = False
    """CCR.BFHFNMIGN."""

    def _take_fault(self, number: int, status: int, address: int, at: int) -> None:
        self.fault_status |= status
        if status & ADDRESS_VALID:
            self.fault_address = address
        self._synchronous(number, at)

    def _synchronous(self, number: int, at: int) -> None:
        """Enters an exception that the present instruction causes, or HardFault in its place."""
        enabled = self.nvic.enabled >> number & 1
        if not enabled or self.nvic.group(number) >= self.nvic.running():
            if number in (MEM_MANAGE, BUS_FAULT, USAGE_FAULT, SVCALL):
                self.hard_fault_status |= 1 << 30  # FORCED
            number = HARD_FAULT
        if number == HARD_FAULT and self.nvic.running() <= -1:
            raise Lockup(f"a fault in HardFault, NMI, or with FAULTMASK: {at:#x}, CFSR {self.fault_status:#x}")
        self.enter(number, at)

    # Entry and return -------------------------------------------------------------------------------------------------

    def enter(self, number: int, return_to: int) -> None:
        cpu = self.cpu
        control = self.read("CONTROL")
        assert control & 1 == 0, "unprivileged threads have no model"
        handler = self.nvic.active != 0
        floating = bool(control & FPCA) and self.automatic_fp
        size = 0x68 if floating else 0x20
        stack = self.read("SP")
        aligned = stack >> 2 & 1
        frame = (stack - size) & ~7
        status = self.read("XPSR") | THUMB
        words = [int(cpu.reg_read(register)) & 0xFFFFFFFF for register in self._registers]
        words += [return_to & ~1, status & ~ALIGNED | aligned << 9]
        if floating:
            words += [int(cpu.reg_read(register)) & 0xFFFFFFFF for register in self._singles]
            words += [self.read("FPSCR"), 0]
        try:
            cpu.mem_write(frame, struct.pack(f"<{len(words)}I", *words))
        except self.module.UcError:
            if self.nvic.running() <= -1:
                raise Lockup(f"the stack is at {frame:#x}") from None
            self.fault_status |= STACKING
            self.hard_fault_status |= 1 << 30
            number = HARD_FAULT
        psp = bool(control & SPSEL) and not handler
        link = 0xFFFFFFF1 if handler else 0xFFFFFFFD if psp else 0xFFFFFFF9
        if floating:
            link &= ~0x10
        self.write("SP", frame)
        self.write("CONTROL", 0)
        self.nvic.enter(number)
        (handler_address,) = struct.unpack("<I", cpu.mem_read(self.vectors + 4 * number, 4))
        self._set_status(status & ~(IT_STATE | 0x1FF) | number)
        self.write("LR", link)
        if not handler_address & 1:
            raise Lockup(f"the vector of exception {number} is {handler_address:#x}")
        self.write("PC", handler_address)
        if number in (NMI, HARD_FAULT):
            self.sleeping = False

    def _return(self, link: int) -> None:
        number = self.read("IPSR") & 0x1FF
        assert link >> 5 == 0x7FFFFFF and self.nvic.active >> number & 1, f"a return by {link:#x}"
        self.nvic.leave(number)
        if number != NMI:
            self.write("FAULTMASK", 0)
        thread, psp = bool(link & 8), bool(link & 4)
        assert thread == (self.nvic.active == 0), f"a return by {link:#x} with active exceptions"
        self._set_status(self.read("XPSR") & ~0x1FF | (0 if thread else self._any_active()))
        if thread:
            self.write("CONTROL", SPSEL if psp else 0)
        frame = self.read("SP")
        floating = not link & 0x10
        words = struct.unpack("<26I" if floating else "<8I", self.cpu.mem_read(frame, 0x68 if floating else 0x20))
        for register, value in zip(self._registers, words):
            self.cpu.reg_write(register, value)
        if floating:
            for register, value in zip(self._singles, words[8:24]):
                self.cpu.reg_write(register, value)
            self.write("FPSCR", words[24])
        self.write("CONTROL", (SPSEL if thread and psp else 0) | (FPCA if floating else 0))
        status = words[7]
        assert (status & 0x1FF == 0) == thread, "the frame does not fit to the return"
        self.write("SP", frame + (0x68 if floating else 0x20) | (4 if status & ALIGNED else 0))
        self._set_status(status & ~ALIGNED)
        self.write("PC", words[6] | 1)

    def _any_active(self) -> int:
        return self.nvic.active.bit_length() - 1

    def _set_status(self, status: int) -> None:
        """Writes flags, IT state and the number of the exception, which also selects the stack."""
        self.write("XPSR_NZCVQG", status | THUMB)
        self.write("APSR_NZCV", status & 0xF0000000)  # unicorn derives its own state from the registers only here
