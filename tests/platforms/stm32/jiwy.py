# SPDX-License-Identifier: Apache-2.0
"""JIWY's image on the emulated STM32H743, with the host's robot at its pins.

The robot moves shortly before each tick, by the levels that are in effect then: so it sees them from the tick on, as
on the host, although they act at the next update event of the PWM's timer.

>>> # jiwy = Jiwy("bare_metal")
>>> # jiwy.run(500)
>>> # jiwy.ask("pan_subscriber=0.5")
>>> # jiwy.rows[-1]["outputs.pwm_pan"]
"""

from __future__ import annotations

import ctypes
import re
import struct
from collections.abc import Callable

from tests.doubles.stm32.agenda import UNITS
from tests.doubles.stm32.machine import Machine
from tests.doubles.toolchain import skip_if_missing, unicorn
from tests.platforms.pico.closed_loop.recording import INPUTS, OUTPUTS
from tests.platforms.stm32.images import host, images
from tests.platforms.stm32.masks import Masks

SIGNALS = tuple(f"{way}.{name}" for way, names in (("inputs", INPUTS), ("outputs", OUTPUTS)) for name in names)
AXES = ("pan", "tilt")
ENCODERS = {"pan": ("TIM4", ("D", 12), ("D", 13), 2), "tilt": ("TIM8", ("C", 6), ("C", 7), 3)}
DIRECTIONS = ("PF13", "PF15", "PE13", "PF14")
"""Pins of pan and tilt."""
MOTORS = ("PE9", *DIRECTIONS[:2], "PE11", *DIRECTIONS[2:])
RAD_PER_COUNT = {"pan": 0.002825173249631109, "tilt": 0.007107675686854735}
PERIOD = UNITS // 1000
PULSES = 20
"""PWM periods in a control period."""
BEFORE = UNITS // 100_000
"""Time before the tick at which the robot moves."""


class Jiwy:
    """``masks``: the tick waits wherever interrupts are masked; see Masks.

    ``rows``: the ports of the model in each cycle; ``counts``: of both encoders; ``duties``: at the motors.
    """

    def __init__(self, platform: str, middleware: str = "console", *, masks: bool = False) -> None:
        skip_if_missing(unicorn)
        elf = images(platform, middleware) / "jiwy_firmware.elf"
        self.robot = ctypes.CDLL(str(host() / "librobot.so"))
        self.chip = Machine(elf, clocks=4)
        for timer, a, b, function in ENCODERS.values():
            self.chip.attach(timer, a, b, alternate_function=function)
        (source,) = elf.parent.glob("epg/jiwy/jiwy_stm32.c")
        found = re.search(r"\.tick = \{\.timer = (\d+)", source.read_text(encoding="utf-8"))
        assert found
        self.timer = self.chip.timers[f"TIM{found[1]}"]
        self.masks = Masks(self.chip, self.timer.kind.update) if masks else None
        self.line = self.chip.uarts[3].line
        self.rows: list[dict[str, float]] = []
        self.counts: list[tuple[int, ...]] = []
        self.duties: list[tuple[float, ...]] = []
        self.chip.run_to("main")
        self.chip.run_until(lambda: self.timer in self.chip.agenda.events, step=0.0002)
        self.first = self.chip.agenda.events[self.timer][0]
        """The time of the first tick."""
        self.ticks = 0
        """Ticks that have passed."""
        self._shown = [0, 0]
        self.robot.robot_start()
        self._move()

    def _move(self) -> None:
        """Moves the robot up to the next tick; its encoders follow."""
        self.chip.run_until_time(self.first + self.ticks * PERIOD - BEFORE)
        if self.ticks > 0:
            self._read_ports()
            self._actuate()
        counts = (ctypes.c_uint32 * 2)()
        self.robot.robot_sense(ctypes.c_uint64(self.ticks * 1_000_000), counts)
        signed = [ctypes.c_int32(count).value for count in counts]
        self.counts.append(tuple(signed))
        for index, axis in enumerate(AXES):
            moved = signed[index] - self._shown[index]
            self._shown[index] = signed[index]
            if moved:
                self.chip.turn(ENCODERS[axis][0], moved)

    def _read_ports(self) -> None:
        values: list[float] = []
        for name, ports in (("jiwy_inputs", INPUTS), ("jiwy_outputs", OUTPUTS)):
            data = self.chip.processor.cpu.mem_read(self.chip.symbols[name], 8 * len(ports))
            values += struct.unpack(f"<{len(ports)}d", data)
        self.rows.append(dict(zip(SIGNALS, values, strict=True)))

    def _actuate(self) -> None:
        pwm = self.chip.timers["TIM1"]
        pwm.settle()
        levels = [pwm.compare[channel] if pwm.drives(channel + 1) else 0 for channel in range(2)]
        directions = [self.chip.pin(pin) or 0 for pin in DIRECTIONS]
        self.robot.robot_actuate((ctypes.c_uint32 * 2)(*levels), (ctypes.c_uint8 * 4)(*directions))
        signs = (directions[0] - directions[1], directions[2] - directions[3])
        self.duties.append(tuple(level / (pwm.period + 1) * sign for level, sign in zip(levels, signs, strict=True)))

    # Running ----------------------------------------------------------------------------------------------------------

    def run(self, cycles: int) -> None:
        for _ in range(cycles):
            self.ticks += 1
            self._move()

    def run_until(self, condition: Callable[[], bool], *, cycles: int) -> int:
        """Returns the number of cycles until the condition was true."""
        for passed in range(cycles):
            if condition():
                return passed
            self.run(1)
        raise AssertionError(f"it did not come true in {cycles} cycles; {self.ask('stats')}")

    def ask(self, command: str) -> str:
        """Sends a command; returns the text up to the end of the answer."""
        self.line.take()
        self.line.send(command.encode() + b"\r\n")
        for _ in range(300):
            self.run(1)
            if re.search(rb"^(ok|error).*\n", self.line.received, re.MULTILINE):
                break
        return self.line.take().decode(errors="replace")

    def stats(self) -> dict[str, str]:
        return dict(re.findall(r"(\w+)=(\S+)", self.ask("stats")))

    # The robot --------------------------------------------------------------------------------------------------------

    def angle(self, axis: str) -> float:
        """The true angle, in rad from the end stop that homing finds."""
        start = {"pan": 0.6, "tilt": 0.15}[axis]
        return start + self.counts[-1][AXES.index(axis)] * RAD_PER_COUNT[axis]

    def assert_levels_act_together(self, begin: int, *, changes: int) -> None:
        """All levels from number ``begin`` on have acted at the same update event after their tick, and at least
        ``changes`` of each channel have."""
        levels = [level for level in self.chip.levels[begin:] if level.timer == "TIM1"]
        cycles = [(level.time - self.first) // PERIOD for level in levels]
        for channel in (1, 2):
            own = [cycle for cycle, level in zip(cycles, levels, strict=True) if level.channel == channel]
            assert len(set(own)) == len(own), "at most once in a cycle"
            assert len(own) >= changes
        assert {(level.time - self.first) % PERIOD for level in levels} == {PERIOD // PULSES}
        assert len({level.update - PULSES * cycle for cycle, level in zip(cycles, levels, strict=True)}) == 1

    def is_safe(self) -> bool:
        return motors_are_off(self.chip)


def motors_are_off(chip: Machine) -> bool:
    """True if no pin of the motors has a level, and no PWM drives one."""
    pwm = chip.timers["TIM1"]
    pwm.settle()
    pulses = [
        pwm.drives(channel + 1) and pwm.compare[channel] > 0 and chip.ports["E"].function(pin) == 1
        for channel, pin in ((0, 9), (1, 11))
    ]
    return not any(pulses) and not any(chip.pin(pin) for pin in MOTORS)
