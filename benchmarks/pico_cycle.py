# SPDX-License-Identifier: Apache-2.0
"""Measures the cost of a control cycle of JIWY on a Pico: instructions and time of each part.

RP2040: EPG's images in EPG's emulator.
RP2350: EPG's image on an emulated Cortex-M33, which counts instructions but not time.
"""

from __future__ import annotations

import re
import subprocess
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

from measure import ROOT, need
from report import Table, arguments, command_line, show

from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.rp2350.cortex_m33 import COMPILER_ARITHMETIC, RETURN, Processor
from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js, unicorn
from tests.platforms.pico.closed_loop.recording import INPUTS
from tests.platforms.pico.closed_loop.robot import AXES, connect
from tests.platforms.pico.images import freertos_kernel
from tests.platforms.pico.rp2350.profile import cycles, start
from tests.platforms.pico.timing.programs import PROJECT, Program

WAIT = "epg_port_wait_until"
GENERATED = {
    "inputs": ("sample", "read_sources", "inputs_finite"),
    "model": ("jiwy_33_model_private_XXCalculateSubmodel",),
    "outputs": ("prepare_actuators", "write_actuators"),
    "output delay": (WAIT,),
}
TICK = "on_wrap"
HOMED = 900
"""Time from reset in ms, after which both axes have homed from 0.12 rad."""
SETPOINTS = "pan_subscriber=0.8 tilt_subscriber=0.5\n"
SIMULATED = "Simulated, with the compiler's doubles, which are slower than a board's, and without waits for the bus."


@dataclass(frozen=True)
class Cost:
    """The mean cost of one control cycle: instructions and time of each part.  "all" is from the tick to the end."""

    instructions: Mapping[str, float]
    microseconds: Mapping[str, float]


def main() -> None:
    options = arguments(__doc__, cycles=500)
    need(pico_sdk, arm_gcc, node, rp2040js, freertos_kernel, unicorn)
    programs = [Program(platform, 33) for platform in ("bare_metal", "freertos")]
    costs = {program.title: rp2040(program, options.cycles) for program in programs}
    tables = [rp2040_table(costs, options.cycles), unused_table(options.cycles)]
    tables.append(rp2350_table(options.cycles))
    show("pico_cycle", tables, options.write, command_line("pico_cycle"))


# RP2040 ---------------------------------------------------------------------------------------------------------------


def rp2040(program: Program, count: int) -> Cost:
    """The mean cost of ``count`` cycles in which both axes move to a setpoint."""
    with Emulator(program.image(), usb={"seed": 1}) as pico:
        connect(pico, {"pan": 0.12, "tilt": 0.12})
        pico.run(milliseconds=HOMED)
        functions = {"all": (TICK,), **GENERATED}
        for name in (name for names in functions.values() for name in names):
            pico.call("watch_span", name=name, core=1, **{"from": name, "to": "return"})
        pico.send(SETPOINTS)
        pico.run(milliseconds=count)
        spans = {name: pico.call("span", name=name)["passages"] for names in functions.values() for name in names}
    ran = len(spans[TICK])

    def mean(names: Sequence[str], column: int) -> float:
        return sum(passage[column] for name in names for passage in spans[name]) / ran

    return Cost(
        instructions={part: mean(names, 2) for part, names in functions.items()},
        microseconds={part: 0.008 * mean(names, 1) for part, names in functions.items()},
    )


def rp2040_table(costs: Mapping[str, Cost], count: int) -> Table:
    head = ["part", *(f"{title}: {unit}" for title in costs for unit in ("instructions", "us"))]
    rows = []
    for part in ("inputs", "outputs", "rest", "beside the model", "model", "all"):
        cells = []
        for cost in costs.values():
            cells += [f"{of(part, cost.instructions):.0f}", f"{of(part, cost.microseconds):.1f}"]
        rows.append([part, *cells])
    notes = [
        f"Means of {count} cycles in which both axes move, from the first instruction of the tick's handler to its "
        "end, without the wait for the output delay. Inputs: encoders, motion guards and setpoints. Rest: "
        "all else.",
        SIMULATED,
    ]
    return Table("A control cycle on RP2040, simulated", head, rows, notes)


def of(part: str, numbers: Mapping[str, float]) -> float:
    if part == "all":
        return numbers["all"] - numbers.get("output delay", 0.0)
    if part == "beside the model":
        return of("all", numbers) - numbers["model"]
    if part == "rest":
        return of("beside the model", numbers) - numbers["inputs"] - numbers["outputs"]
    return numbers[part]


# What nobody uses -----------------------------------------------------------------------------------------------------


UNUSED = {
    "parameters unchanged": "parameters",
    "capture not armed": "capture",
    "nothing moved by hand": "jog",
    "no new setpoint": "setpoint_exchange",
}
"""For each function of a target that a cycle does not use: the member of `epg_application_t` that switches it on."""
OBSERVER = "console closed"
COPY = "epg_exchange_write"
UNUSED_BORDER = 3.0


def unused_table(count: int) -> Table:
    """The time of each function that a cycle does not use: the difference to a target that does not have it."""
    program = Program("bare_metal", 33)

    def measured(without: Sequence[str]) -> tuple[float, float]:
        """Microseconds of a cycle, and of its copy for the console: the third one."""
        with Emulator(program.image(), usb={"seed": 1}) as pico:
            connect(pico, {"pan": 0.12, "tilt": 0.12})
            pico.run(milliseconds=HOMED)
            for title in without:
                pico.call("write", at="application", offset=offset("epg_application_t", UNUSED[title]), hex="00" * 4)
            for name in (TICK, WAIT, COPY):
                pico.call("watch_span", name=name, core=1, **{"from": name, "to": "return"})
            pico.run(milliseconds=count)
            spans = [pico.call("span", name=name)["passages"] for name in (TICK, WAIT, COPY)]
        whole, waits, copies = ([0.008 * passage[1] for passage in passages] for passages in spans)
        assert len(copies) == 3 * len(whole), "a cycle copies monitoring values, its status, and this for the console"
        return (sum(whole) - sum(waits)) / len(whole), fmean(copies[2::3])

    base, observer = measured([])
    rows = [[title, f"{base - measured([title])[0]:.2f}"] for title in UNUSED]
    together = base - measured(list(UNUSED))[0] + observer
    rows += [[OBSERVER, f"{observer:.2f}"], ["together", f"{together:.2f}"]]
    judged = "holds" if together <= UNUSED_BORDER else "does not hold"
    notes = [
        f"Aim: together at most {UNUSED_BORDER:g} us: {judged} ({together:.2f} us).",
        f"The first rows are differences between the image and the image without this function, in {count} cycles at "
        "rest. Console closed: the copy of the status, which the console and services of ROS 2 read.",
    ]
    return Table("What a control cycle does not use, RP2040, simulated", ["function", "us"], rows, notes)


def offset(type_: str, member: str) -> int:
    """The offset of a member in a type of the runtime, on a Cortex-M0+."""
    include = ROOT / "targets" / "runtime" / "include"
    source = (
        f'#include <stddef.h>\n#include "epg/control.h"\nconst unsigned int found = offsetof({type_}, {member}) + 1;\n'
    )
    options = ["-mcpu=cortex-m0plus", "-mthumb", "-std=c11", f"-I{include}", "-x", "c", "-S", "-o", "-", "-"]
    done = subprocess.run([str(arm_gcc()), *options], input=source, capture_output=True, text=True, check=True)
    found = re.search(r"^\s+\.word\s+(\d+)$", done.stdout, re.MULTILINE)
    assert found is not None, done.stdout
    return int(found[1]) - 1


# RP2350 ---------------------------------------------------------------------------------------------------------------


def rp2350_table(count: int) -> Table:
    variables = {"PLATFORM": "bare_metal", **COMPILER_ARITHMETIC}
    folder = build(PROJECT, board="pico2", targets=["jiwy_firmware_33"], variables=variables)
    processor = Processor(folder / "jiwy_firmware_33.elf", target="jiwy_33")
    start(processor)
    counted: list[Counter[str]] = []

    def around(number: int, run: Callable[[], object]) -> None:
        parts = Parts(processor)
        processor.trace(parts.seen, run)
        counted.append(parts.counts)

    for _ in cycles(processor, motion(count), around):
        pass
    counted = counted[1:]  # the first one initialises the model
    means = {part: fmean(counts[part] for counts in counted) for part in ("inputs", "model", "outputs", "rest")}
    rows = [[part, f"{mean:.0f}"] for part, mean in means.items()]
    rows.append(["all", f"{sum(means.values()):.0f}"])
    notes = [
        f"Means of {len(counted)} cycles of homing, with encoders that turn; from the runtime's epg_control_cycle() "
        "on, without tick and interrupt.",
    ]
    return Table("A control cycle on RP2350, instructions, simulated", ["part", "EPG, bare metal"], rows, notes)


def motion(count: int) -> dict[str, list[float]]:
    """Inputs for ``count`` cycles in the form of a trace of the host: only the positions change."""
    columns: dict[str, list[float]] = {"time": [number / 1000 for number in range(count)]}
    columns |= {f"inputs.{name}": [0.0] * count for name in INPUTS}
    for axis in AXES:
        columns[f"inputs.position_{axis.name}"] = [-axis.rad_per_count * (number // 3) for number in range(count)]
        columns[f"outputs.encoder_reset_{axis.name}"] = [0.0] * count
    return columns


class Parts:
    """Counts instructions by part: an instruction belongs to the part whose function was called last and still runs."""

    def __init__(self, processor: Processor) -> None:
        self.processor = processor
        self.entries = {processor.address(name): part for part, names in GENERATED.items() for name in names}
        self.counts: Counter[str] = Counter()
        self.part, self.back = "rest", RETURN

    def seen(self, pc: int) -> None:
        if self.part != "rest" and pc == self.back:
            self.part = "rest"
        if self.part == "rest" and pc in self.entries:
            self.part = self.entries[pc]
            self.back = self.processor.cpu.reg_read(self.processor.arm.UC_ARM_REG_LR) & ~1
        self.counts[self.part] += 1


if __name__ == "__main__":
    main()
