# SPDX-License-Identifier: Apache-2.0
"""Timers of an STM32H743: time base, PWM, triggers between timers, and encoder mode (RM0433, chapters 38 to 41).

Counters count up, edge-aligned, by the timer's clock; or by edges at the inputs, in encoder mode 3.  Preload registers
take effect at update events.  A timer without a clock does not count, reads as 0 and ignores writes.  A trigger acts
at once, not a few clocks later as on the chip.  Modes that no test needs raise an error when a program chooses them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from .agenda import UNITS, Agenda

CR1, CR2, SMCR, DIER, SR, EGR, CCMR1, CCMR2, CCER, CNT, PSC, ARR, RCR, CCR1, BDTR = (
    0x00, 0x04, 0x08, 0x0C, 0x10, 0x14, 0x18, 0x1C, 0x20, 0x24, 0x28, 0x2C, 0x30, 0x34, 0x44,
)  # fmt: skip
CCR3, CCR4 = CCR1 + 8, CCR1 + 12
CEN, UDIS, URS, OPM, DOWN, CENTRED, ARPE, UIFREMAP = 1, 2, 4, 8, 0x10, 0x60, 0x80, 0x800
UG, ENCODER_X4, GATED, TRIGGERED, RESETTING = 1, 3, 5, 6, 4
MOE = 1 << 15
UPDATE, MATCH3, MATCH4, TRIGGER = 1, 1 << 3, 1 << 4, 1 << 6
TRGO_RESET, TRGO_ENABLE, TRGO_UPDATE = 0, 1, 2


@dataclass(frozen=True)
class Kind:
    """What tells timers apart: RM0433, 2.3.2 (addresses), 19.1.2 (interrupts), and 8.7 (clocks and resets)."""

    base: int
    bits: int
    apb: int
    bit: int
    update: int
    compare: int
    channels: int = 4
    advanced: bool = False
    triggers: tuple[str, ...] = ()
    """The timers at ITR0 to ITR3 (tables "TIMx internal trigger connection")."""


KINDS = {
    "TIM1": Kind(0x40010000, 16, 2, 0, 25, 27, advanced=True, triggers=("TIM15", "TIM2", "TIM3", "TIM4")),
    "TIM2": Kind(0x40000000, 32, 1, 0, 28, 28, triggers=("TIM1", "TIM8", "TIM3", "TIM4")),
    "TIM3": Kind(0x40000400, 16, 1, 1, 29, 29, triggers=("TIM1", "TIM2", "TIM15", "TIM4")),
    "TIM4": Kind(0x40000800, 16, 1, 2, 30, 30, triggers=("TIM1", "TIM2", "TIM3", "TIM8")),
    "TIM5": Kind(0x40000C00, 32, 1, 3, 50, 50, triggers=("TIM1", "TIM8", "TIM3", "TIM4")),
    "TIM6": Kind(0x40001000, 16, 1, 4, 54, 54, 0),
    "TIM7": Kind(0x40001400, 16, 1, 5, 55, 55, 0),
    "TIM8": Kind(0x40010400, 16, 2, 1, 44, 46, advanced=True, triggers=("TIM1", "TIM2", "TIM4", "TIM5")),
    "TIM12": Kind(0x40001800, 16, 1, 6, 43, 43, 2, triggers=("TIM4", "TIM5", "", "")),
    "TIM13": Kind(0x40001C00, 16, 1, 7, 44, 44, 1),
    "TIM14": Kind(0x40002000, 16, 1, 8, 45, 45, 1),
    "TIM15": Kind(0x40014000, 16, 2, 16, 116, 116, 2, True, triggers=("TIM1", "TIM3", "", "")),
    "TIM16": Kind(0x40014400, 16, 2, 17, 117, 117, 1, True),
    "TIM17": Kind(0x40014800, 16, 2, 18, 118, 118, 1, True),
}


@dataclass(frozen=True)
class Level:
    """A level of a PWM output that takes effect: ``time`` in units, ``update``: the number of the update event."""

    time: int
    timer: str
    channel: int
    level: int
    update: int


class Surroundings(Protocol):
    """What a timer needs of the machine."""

    agenda: Agenda

    @property
    def now(self) -> int: ...
    def timer_clock(self, apb: int) -> int: ...
    def line(self, interrupt: int, source: object, high: bool) -> None: ...
    def triggered(self, name: str) -> list[Timer]: ...
    def levels_changed(self, level: Level) -> None: ...


class Timer:
    def __init__(self, name: str, machine: Surroundings) -> None:
        self.name = name
        self.kind = KINDS[name]
        self.machine = machine
        self.clocked = False
        self.reset()

    def reset(self) -> None:
        """Resets the registers, like a pulse of the timer's reset line."""
        self.registers: dict[int, int] = {ARR: self.top}
        self.prescaler, self.period = 0, self.top
        """The values of PSC and ARR that are in use."""
        self.compare = [0] * 4
        """The values of CCR1 to CCR4 that are in use."""
        self.count = 0
        self.since = 0
        """The time at which the counter had ``count``."""
        self.updates = 0
        """Update events since the reset."""
        self.repetitions = 0
        self.frequency = 0
        self.left_edges = 0
        self.machine.agenda.set(self, None, self._due)
        self._request()

    @property
    def top(self) -> int:
        return int((1 << self.kind.bits) - 1)

    @property
    def bits(self) -> int:
        return self.kind.bits

    @property
    def filters(self) -> tuple[int, int]:
        """The fields IC1F and IC2F."""
        return self._get(CCMR1) >> 4 & 0xF, self._get(CCMR1) >> 12 & 0xF

    @property
    def interrupts(self) -> bool:
        """True if a flag is set whose interrupt is enabled."""
        return self._get(SR) & self._get(DIER) & 0x5F != 0

    @property
    def _slave_mode(self) -> int:
        return self._get(SMCR) & 7 | self._get(SMCR) >> 13 & 8

    @property
    def _by_time(self) -> bool:
        return bool(self._get(CR1) & CEN) and self._slave_mode not in (1, 2, ENCODER_X4) and self.frequency > 0

    def _get(self, register: int) -> int:
        return self.registers.get(register, 0)

    # Registers --------------------------------------------------------------------------------------------------------

    def read(self, register: int) -> int:
        if not self.clocked:
            return 0
        self.settle()
        if register == CNT:
            copy = self._get(SR) & UPDATE if self._get(CR1) & UIFREMAP else 0
            return self.counter() | copy << 31
        return self._get(register)

    def write(self, register: int, value: int) -> None:
        if not self.clocked:
            return
        self.settle()
        if register == SR:
            self.registers[SR] = value & self._get(SR)  # rc_w0: a write can only clear bits
        elif register == EGR:
            if value & UG:
                self._restart(software=True)
            self.registers[SR] = self._get(SR) | value & 0x5E
        elif register == CNT:
            self._check_width(register, value)
            self._set_count(value)
        else:
            if register == ARR or CCR1 <= register <= CCR4:
                self._check_width(register, value)
            before = self._get(register)
            self.registers[register] = value
            self._written(register, before, value)
        self._plan()
        self._request()

    def _check_width(self, register: int, value: int) -> None:
        assert value <= self.top, f"reserved bits of a 16-bit register {register:#x} are written: {value:#x}"

    def _written(self, register: int, before: int, value: int) -> None:
        if register == CR1:
            assert not value & (DOWN | CENTRED), f"{self.name} counts up only in this model"
            if (before ^ value) & CEN:
                self._set_count(self.count)
                if value & CEN:
                    self._trigger_out(TRGO_ENABLE)
            if not value & ARPE:
                self.period = self._get(ARR)
        elif register == ARR and not self._get(CR1) & ARPE:
            self._set_count(self.counter())
            self.period = value
        elif register == SMCR:
            mode = self._slave_mode
            assert mode in (0, ENCODER_X4, RESETTING, GATED, TRIGGERED), f"{self.name}: slave mode {mode} has no model"
        elif CCR1 <= register <= CCR4:
            channel = (register - CCR1) // 4
            if not self._preloaded(channel):
                self._load_compare(channel)
        elif register in (CCMR1, CCMR2):
            for channel in range(4):
                if not self._preloaded(channel):
                    self._load_compare(channel)

    def _mode(self, channel: int) -> int:
        return self._get(CCMR1 if channel < 2 else CCMR2) >> 8 * (channel % 2)

    def _preloaded(self, channel: int) -> bool:
        return bool(self._mode(channel) & 8)

    def _is_output(self, channel: int) -> bool:
        return self._mode(channel) & 3 == 0

    # Counting by time -------------------------------------------------------------------------------------------------

    def set_clock(self, clocked: bool, frequency: int) -> None:
        """The timer's clock, after a change of RCC."""
        if (clocked, frequency) != (self.clocked, self.frequency):
            self.settle()
            self._set_count(self.counter())
            self.clocked, self.frequency = clocked, frequency if clocked else 0
            self._plan()

    def _ticks(self, time: int) -> int:
        """Counts since ``since``."""
        if not self._by_time:
            return 0
        return (time - self.since) * self.frequency // (UNITS * (self.prescaler + 1))

    def _when(self, ticks: int) -> int:
        """The time at which that many counts have passed since ``since``."""
        return self.since - (-ticks * UNITS * (self.prescaler + 1) // self.frequency)

    def _until_wrap(self) -> int:
        """Counts from ``count`` to the next overflow."""
        return self.period + 1 - self.count if self.count <= self.period else self.top + 1 - self.count

    def counter(self) -> int:
        return self.count + self._ticks(self.machine.now) if self._by_time else self.count

    def _set_count(self, count: int) -> None:
        self.count, self.since = count, self.machine.now

    def settle(self) -> None:
        """Brings flags, registers in use and counts up to the present time."""
        if not self._by_time:
            return
        now = self.machine.now
        while True:
            ticks, wrap = self._ticks(now), self._until_wrap()
            self._match(self.count, min(ticks, wrap))
            if ticks < wrap:
                self.since, self.count = self._when(ticks), self.count + ticks
                return
            if wrap == self.period + 1 and ticks >= 2 * wrap and not self._pending():
                # Nothing changes in these periods: leave all but the last out.
                periods = ticks // wrap - 1
                self.since = self._when(periods * wrap)
                self._count_updates(periods)
                continue
            self.since, self.count = self._when(wrap), 0
            self._overflow()
            if not self._by_time:
                return

    def _match(self, count: int, ticks: int) -> None:
        """Sets the flags of outputs whose value the counter reaches within ``ticks``."""
        for channel in range(self.kind.channels):
            if self._is_output(channel) and self._get(CCER) >> 4 * channel & 1 | self._get(DIER) >> 1 + channel & 1:
                distance = self.compare[channel] - count
                if 0 < distance <= ticks or (distance == 0 and count == 0 and ticks > 0):
                    self.registers[SR] = self._get(SR) | 2 << channel

    def _count_updates(self, number: int) -> None:
        repeat = self._get(RCR) & 0xFFFF if self.kind.advanced else 0
        if self._get(CR1) & UDIS:
            return
        total = self.repetitions + number
        self.updates += total // (repeat + 1)
        self.repetitions = total % (repeat + 1)
        if total > repeat:
            self.registers[SR] = self._get(SR) | UPDATE

    def _overflow(self) -> None:
        before = self.updates
        self._count_updates(1)
        if self.updates != before:
            self._load()
            if self._get(CR1) & OPM:
                self.registers[CR1] = self._get(CR1) & ~CEN
            self._trigger_out(TRGO_UPDATE)

    def _restart(self, *, software: bool) -> None:
        """An update event by UG or by a trigger that resets the counter."""
        self._set_count(0)
        self.repetitions = 0
        if not self._get(CR1) & UDIS:
            self.updates += 1
            self._load()
            if not self._get(CR1) & URS:
                self.registers[SR] = self._get(SR) | UPDATE
            self._trigger_out(TRGO_UPDATE)
        if software:
            self._trigger_out(TRGO_RESET)

    # Preload ----------------------------------------------------------------------------------------------------------

    def _pending(self) -> bool:
        """True if the next update event changes a register in use."""
        return (
            self.prescaler != self._get(PSC)
            or self.period != self._get(ARR)
            or any(self.compare[n] != self._get(CCR1 + 4 * n) for n in range(self.kind.channels) if self._is_output(n))
        )

    def _load(self) -> None:
        self.prescaler, self.period = self._get(PSC), self._get(ARR)
        for channel in range(self.kind.channels):
            self._load_compare(channel)

    def _load_compare(self, channel: int) -> None:
        value = self._get(CCR1 + 4 * channel)
        if self._is_output(channel) and value != self.compare[channel]:
            self.compare[channel] = value
            self.machine.levels_changed(Level(self.machine.now, self.name, channel + 1, value, self.updates))

    def drives(self, channel: int) -> bool:
        """True if channel 1 to 4 is an output in PWM mode 1 that the timer drives."""
        enabled = self._get(CCER) >> 4 * (channel - 1) & 1 and self._mode(channel - 1) >> 4 & 7 == 6
        return bool(enabled and self._get(CR1) & CEN and (not self.kind.advanced or self._get(BDTR) & MOE))

    def duty(self, channel: int) -> float | None:
        """The part of the period at which the output is high; None if the timer does not drive it."""
        return self.compare[channel - 1] / (self.period + 1) if self.drives(channel) else None

    # Events -----------------------------------------------------------------------------------------------------------

    def _plan(self) -> None:
        time = None
        if self._by_time:
            enabled = self._get(DIER)
            distances = []
            slaves = self._get(CR2) >> 4 & 7 == TRGO_UPDATE and self.machine.triggered(self.name)
            if enabled & UPDATE or self._get(CR1) & OPM or slaves or self._pending():
                distances.append(self._until_wrap())
            for channel in range(self.kind.channels):
                if enabled >> 1 + channel & 1 and self._is_output(channel):
                    distance = (self.compare[channel] - self.count - 1) % (self.period + 1) + 1
                    distances.append(distance)
            if distances:
                time = self._when(min(distances))
        self.machine.agenda.set(self, time, self._due)

    def _due(self) -> None:
        self.settle()
        self._plan()
        self._request()

    def _request(self) -> None:
        active = self._get(SR) & self._get(DIER)
        if self.kind.update == self.kind.compare:
            self.machine.line(self.kind.update, self.name, bool(active & 0x5F))
        else:
            self.machine.line(self.kind.update, self.name, bool(active & UPDATE))
            self.machine.line(self.kind.compare, self.name, bool(active & 0x1E))

    # Triggers ---------------------------------------------------------------------------------------------------------

    def _trigger_out(self, event: int) -> None:
        if self._get(CR2) >> 4 & 7 == event:
            for timer in self.machine.triggered(self.name):
                timer.trigger()

    def listens_to(self) -> str:
        """The timer at the trigger that SMCR selects, if its slave mode uses it."""
        if self._slave_mode not in (RESETTING, GATED, TRIGGERED):
            return ""
        select = self._get(SMCR) >> 4 & 7 | self._get(SMCR) >> 17 & 0x18
        return self.kind.triggers[select] if select < len(self.kind.triggers) else ""

    def trigger(self) -> None:
        """The rising edge of the selected trigger."""
        if not self.clocked:
            return
        self.settle()
        mode = self._slave_mode
        assert mode != GATED, f"{self.name}: gated mode has no model"
        self.registers[SR] = self._get(SR) | TRIGGER
        if mode == RESETTING:
            self._restart(software=False)
        elif mode == TRIGGERED and not self._get(CR1) & CEN:
            self._set_count(self.count)
            self.registers[CR1] = self._get(CR1) | CEN
            self._trigger_out(TRGO_ENABLE)
        self._plan()
        self._request()

    # Encoder mode -----------------------------------------------------------------------------------------------------

    def _direction(self) -> int:
        """1 if the count rises when A leads, -1 if it falls, 0 if the timer does not count."""
        inputs = self._get(CCMR1) & 3 == 1 and self._get(CCMR1) >> 8 & 3 == 1
        if not (self.clocked and inputs and self._get(CR1) & CEN and self._slave_mode == ENCODER_X4):
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
            self.left_edges += edges
            counts, self.left_edges = divmod(self.left_edges, self.prescaler + 1)
            self.count = (self.count + direction * counts) % (self.period + 1)
            return edges
        way = 1 if edges * direction > 0 else -1
        range_ = self.period + 1
        if self._get(CCMR2) & 0x0303:
            raise AssertionError("channels 3 and 4 are no outputs")
        flags = {MATCH3: self._get(CCR3), MATCH4: self._get(CCR4), UPDATE: 0 if way > 0 else self.period}
        distances = {flag: (way * (place - self.count) - 1) % range_ + 1 for flag, place in flags.items()}
        steps = min(abs(edges), *distances.values())
        self.count = (self.count + way * steps) % range_
        for flag, distance in distances.items():
            if distance == steps:
                self.registers[SR] = self._get(SR) | flag
        self._request()
        return steps if edges > 0 else -steps
