# SPDX-License-Identifier: Apache-2.0
"""Timers of an STM32H743 in encoder mode, as far as a decoder uses them (RM0433, chapters 38 and 39).

A timer counts the edges at its inputs according to its registers: encoder mode 3 counts each edge, the inputs'
polarities set the direction, the active prescaler divides, and the count wraps at ARR.  Channels 3 and 4, as outputs,
set their flag when the count matches.  A timer without a clock does not count, reads as 0 and ignores writes.
"""

from __future__ import annotations

from dataclasses import dataclass, field

CR1, SMCR, DIER, SR, EGR, CCMR1, CCMR2, CCER, CNT, PSC, ARR, CCR3, CCR4 = (
    0x00, 0x08, 0x0C, 0x10, 0x14, 0x18, 0x1C, 0x20, 0x24, 0x28, 0x2C, 0x3C, 0x40,
)  # fmt: skip
CEN, UG, ENCODER_X4 = 1, 1, 3
UPDATE, MATCH3, MATCH4 = 1 << 0, 1 << 3, 1 << 4


@dataclass
class Timer:
    """One timer; ``bits`` is the width of its counter, ``interrupt`` the number of its channels' interrupt."""

    bits: int
    interrupt: int
    registers: dict[int, int] = field(default_factory=dict)
    clocked: bool = False
    prescaler: int = 0
    edges: int = 0

    def __post_init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Resets the registers, like a pulse of the timer's reset line."""
        self.registers = {ARR: self.top}
        self.prescaler = self.edges = 0

    @property
    def top(self) -> int:
        return int((1 << self.bits) - 1)

    @property
    def filters(self) -> tuple[int, int]:
        """The fields IC1F and IC2F."""
        return self._get(CCMR1) >> 4 & 0xF, self._get(CCMR1) >> 12 & 0xF

    @property
    def interrupts(self) -> bool:
        """True if a flag is set whose interrupt is enabled."""
        return self._get(SR) & self._get(DIER) & (UPDATE | MATCH3 | MATCH4) != 0

    def read(self, register: int) -> int:
        return self._get(register) if self.clocked else 0

    def write(self, register: int, value: int) -> None:
        if not self.clocked:
            return
        if register == SR:
            value &= self._get(SR)  # rc_w0: a write can only clear bits
        elif register == EGR:
            if value & UG:
                self.prescaler, self.edges = self._get(PSC), 0
                self.registers[CNT] = 0
                self.registers[SR] = self._get(SR) | UPDATE
            return
        elif register in (CNT, ARR, CCR3, CCR4):
            assert value <= self.top, f"reserved bits of a 16-bit register {register:#x} are written: {value:#x}"
        self.registers[register] = value

    def _get(self, register: int) -> int:
        return self.registers.get(register, 0)

    def _direction(self) -> int:
        """1 if the count rises when A leads, -1 if it falls, 0 if the timer does not count."""
        inputs = self._get(CCMR1) & 3 == 1 and self._get(CCMR1) >> 8 & 3 == 1
        if not (self.clocked and inputs and self._get(CR1) & CEN and self._get(SMCR) & 0x10007 == ENCODER_X4):
            return 0
        inverted = (self._get(CCER) >> 1 ^ self._get(CCER) >> 5) & 1
        return -1 if inverted else 1

    def move(self, edges: int) -> int:
        """Moves by at most ``edges``, until the first count that sets a flag; returns how far."""
        direction = self._direction()
        if direction == 0:
            return edges
        if self.prescaler:
            # Drivers of decoders do not use the prescaler: it is enough that its effect is visible.
            self.edges += edges
            counts, self.edges = divmod(self.edges, self.prescaler + 1)
            self.registers[CNT] = (self._get(CNT) + direction * counts) % (self._get(ARR) + 1)
            return edges
        way = 1 if edges * direction > 0 else -1
        range_ = self._get(ARR) + 1
        count = self._get(CNT)
        flags = {MATCH3: self._get(CCR3), MATCH4: self._get(CCR4), UPDATE: 0 if way > 0 else self._get(ARR)}
        distances = {flag: (way * (place - count) - 1) % range_ + 1 for flag, place in flags.items()}
        if self._get(CCMR2) & 0x0303:
            raise AssertionError("channels 3 and 4 are no outputs")
        steps = min(abs(edges), *distances.values())
        self.registers[CNT] = (count + way * steps) % range_
        for flag, distance in distances.items():
            if distance == steps:
                self.registers[SR] = self._get(SR) | flag
        return steps if edges > 0 else -steps
