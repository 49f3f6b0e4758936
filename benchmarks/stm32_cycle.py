# SPDX-License-Identifier: Apache-2.0
"""Measures the cost of a control cycle of JIWY on a Nucleo-H743ZI: instructions, and the size of images.

EPG's images for bare metal, and a program written by hand with ST's header (stm32/handwritten.c), on the emulated
STM32H743.  Instructions are counted from the entry of the tick's interrupt to its end, while both encoders turn.
"""

from __future__ import annotations

import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from statistics import fmean
from typing import Any

from measure import ROOT, need
from report import Table, arguments, command_line, show

from tests.doubles.stm32.machine import Machine
from tests.doubles.stm32.nvic import FIRST
from tests.doubles.toolchain import arm_gcc, tool, unicorn
from tests.platforms.firmware.builds import PROCESSORS, build
from tests.platforms.stm32.images import PARTS

PROJECT = Path(__file__).resolve().parent / "stm32"
BORDER = 1.2
WARM_UP = 4
"""Cycles that find out where the parts of a cycle end."""
GENERATED = {"model": ("jiwy_model_private_XXCalculateSubmodel",)}
COMPLETE = {"model": ("complete_model_private_XXCalculateSubmodel",)}
HANDWRITTEN = {"model": ("XXCalculateSubmodel",)}
ENCODERS = {"TIM4": (("D", 12), ("D", 13), 2), "TIM8": (("C", 6), ("C", 7), 3), "TIM3": (("C", 6), ("C", 7), 2)}


@dataclass(frozen=True)
class Program:
    """``timer``: the tick's; ``parts``: the functions of each part of a cycle."""

    name: str
    timer: str
    parts: Mapping[str, Sequence[str]]

    @property
    def elf(self) -> Path:
        return folder() / f"{self.name}.elf"


PROGRAMS = {
    "EPG": Program("jiwy_firmware", "TIM15", GENERATED),
    "by hand": Program("by_hand", "TIM6", HANDWRITTEN),
    "EPG, complete": Program("complete_firmware", "TIM15", COMPLETE),
}


def main() -> None:
    options = arguments(__doc__, cycles=300)
    need(unicorn, arm_gcc, *(partial(tool, name) for name in ("cmsis_device_h7", *PARTS)))
    costs = {title: cycle(program, options.cycles) for title, program in PROGRAMS.items()}
    show("stm32_cycle", [cycle_table(costs, options.cycles), size_table()], options.write, command_line("stm32_cycle"))


@cache
def folder() -> Path:
    return build(PROCESSORS["host"], PROJECT, EPG_PATH=str(ROOT))


class Counter:
    """Instructions of each part of the tick's interrupt, by cycle."""

    def __init__(self, chip: Machine, program: Program) -> None:
        self.processor = chip.processor
        self.number = FIRST + chip.timers[program.timer].kind.update
        self.cycles: list[dict[str, int]] = []
        self.began: dict[str, int] = {}
        self.present: dict[str, int] | None = None
        self._enter, self._return = self.processor.enter, self.processor._return
        self.processor.enter = self.enter  # type: ignore[method-assign]
        self.processor._return = self.leave  # type: ignore[method-assign]
        self.ends: dict[int, str] = {}
        for part, names in program.parts.items():
            for name in names:
                self._hook(chip.symbols[name] & ~1, lambda *_, part=part: self._begin(part))

    def _hook(self, address: int, call: Any) -> None:
        cpu = self.processor.cpu
        cpu.hook_add(self.processor.module.UC_HOOK_CODE, call, None, address, address)

    @property
    def executed(self) -> int:
        running = self.processor.counters.executed if self.processor.in_run else 0
        return self.processor.instructions + running

    def enter(self, number: int, return_to: int) -> None:
        if number == self.number:
            self.present = {"all": -self.executed}
        self._enter(number, return_to)

    def leave(self, link: int) -> None:
        if self.processor.read("IPSR") & 0x1FF == self.number and self.present is not None:
            self.present["all"] += self.executed
            self.cycles.append(self.present)
            self.present = None
        self._return(link)

    def _begin(self, part: str) -> None:
        if self.present is None or part in self.began:
            return
        back = self.processor.read("LR") & ~1
        self.began[part] = self.executed
        if back not in self.ends:
            self.ends[back] = part
            self._hook(back, lambda *_: self._end(self.ends[back]))

    def _end(self, part: str) -> None:
        if part in self.began and self.present is not None:
            spent = self.executed - self.began.pop(part)
            self.present[part] = self.present.get(part, 0) + spent


def cycle(program: Program, count: int) -> dict[str, float]:
    """The mean number of instructions of each part; "all" is the whole interrupt."""
    chip = Machine(program.elf, clocks=4)
    for timer, (a, b, function) in ENCODERS.items():
        chip.attach(timer, a, b, alternate_function=function)
    chip.run_to("main")
    chip.run_until(lambda: chip.timers[program.timer].updates > 20, step=0.0005)
    counter = Counter(chip, program)
    while len(counter.cycles) < WARM_UP + count:
        if len(counter.cycles) < WARM_UP:
            chip.processor.cpu.ctl_flush_tb()  # new hooks then act in code that has run before, too
        for timer in ENCODERS:
            chip.turn(timer, 3)
        chip.run(0.001)
    cycles = counter.cycles[WARM_UP : WARM_UP + count]
    return {part: fmean(found.get(part, 0) for found in cycles) for part in (*program.parts, "all")}


def cycle_table(costs: Mapping[str, Mapping[str, float]], count: int) -> Table:
    rows = []
    for part in ("model", "rest", "all"):
        numbers = {title: of(part, cost) for title, cost in costs.items()}
        ratio = numbers["EPG"] / numbers["by hand"]
        rows.append([part, *(f"{number:.0f}" for number in numbers.values()), f"{ratio:.2f} x"])
    ratio = costs["EPG"]["all"] / costs["by hand"]["all"]
    holds = "holds" if ratio <= BORDER else "does not hold"
    notes = [
        f"Means of {count} cycles in which both encoders turn. EPG and by hand have the same functions, and the same "
        "model. The complete JIWY has motion guards, dead times and ROS 2, too.",
        f"Aim: all at most {BORDER} x of what is written by hand: {holds} ({ratio:.2f} x).",
    ]
    return Table("A control cycle on STM32H743, instructions", ["part", *costs, "EPG to by hand"], rows, notes)


def of(part: str, numbers: Mapping[str, float]) -> float:
    if part == "rest":
        return numbers["all"] - sum(value for name, value in numbers.items() if name != "all")
    return numbers[part]


def size_table() -> Table:
    rows = []
    for title, program in PROGRAMS.items():
        size = arm_gcc().parent / "arm-none-eabi-size"
        done = subprocess.run([size, program.elf], capture_output=True, text=True, check=True)
        text, data, bss = (int(number) for number in done.stdout.splitlines()[1].split()[:3])
        rows.append([title, str(text + data), str(data + bss)])
    notes = ["RAM holds the stacks and, of EPG's images, 16 KiB for `new` in models in C++."]
    return Table("Size of JIWY on STM32H743, bytes", ["image", "flash", "RAM"], rows, notes)


if __name__ == "__main__":
    main()
