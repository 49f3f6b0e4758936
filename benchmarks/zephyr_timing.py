# SPDX-License-Identifier: Apache-2.0
"""Measures jitter and cost of JIWY's control cycles with Zephyr, which runs everything on one core of a Pico.

The example's unchanged application runs in EPG's RP2040 emulator, which times every control cycle from outside.  The
emulator simulates the core with the exact number of processor cycles, PIO, PWM and USB.  It does not simulate the flash
cache, although this image runs from flash.
"""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import NamedTuple

from measure import need
from pico_timing import extent, verdict
from report import Table, arguments, command_line, show

from tests.doubles.toolchain import arm_gcc, node, rp2040js, tool
from tests.platforms.pico.closed_loop.robot import PERIOD
from tests.platforms.pico.timing.measure import Timing
from tests.platforms.pico.xrce.board import AGENT_PORT, CONSOLE_PORT
from tests.zephyr.proof.board import APPLICATION, ZephyrJiwy, deviations
from tests.zephyr.workspace import build, c_library, workspace

FREQUENT = "tests/zephyr/proof/application"
AIM = 2500
"""The aim in processor cycles of 8 ns: 20 us."""
PARTS = {
    "reading in the interrupt": ("epg_zephyr_inputs_sample",),
    "inputs": ("sample", "read_sources", "inputs_finite"),
    "model": ("model_step", "model_finite", "model_stopped"),
    "preparing outputs": ("prepare_actuators",),
    "outputs": ("write_actuators",),
}
SIMULATED = (
    "Simulated, with the compiler's doubles, and without the flash cache: a board is slower by what the cache misses."
)


@dataclass(frozen=True)
class Load:
    """Load by communication.  ``period`` is that of setpoints and published values, in ms.

    ``flooded`` sends packets on both serial ports all the time.
    """

    period: int
    flooded: bool = False

    @property
    def title(self) -> str:
        return f"{self.period} ms" + (", flooded" if self.flooded else "")

    def image(self) -> Path:
        if self.period == 33:
            return build(APPLICATION, "rpi_pico", settings=c_library()) / "zephyr" / "zephyr.elf"
        period = {"PERIOD": f"{self.period} ms"}
        return build(FREQUENT, "rpi_pico", settings={**c_library(), **period}) / "zephyr" / "zephyr.elf"


LOADS = (Load(33), Load(33, flooded=True), Load(10))


@dataclass
class Measured:
    """Times by the emulator's clock, in processor cycles of 8 ns, with the number of times that each occurred.

    ``interrupt`` and ``cycle`` are the lateness of the tick's interrupt and of the cycle in the control thread.
    ``locked`` is the time for which interrupts were locked.
    """

    timing: Timing
    interrupt: Counter[int]
    cycle: Counter[int]
    locked: Counter[int]


def main() -> None:
    options = arguments(__doc__, seeds=5, milliseconds=2000, loads=len(LOADS), cycles=200)
    need(lambda: workspace("rpi_pico"), c_library, arm_gcc, node, rp2040js, lambda: tool("micro_xrce_dds_client"))
    measured = {load: measure(load, options.seeds, options.milliseconds) for load in LOADS[: options.loads]}
    tables = [timing_table(measured, options.seeds, options.milliseconds), split_table(options.cycles)]
    show("zephyr_timing", tables, options.write, command_line("zephyr_timing"))


# Deviations -----------------------------------------------------------------------------------------------------------


def measure(load: Load, seeds: int, milliseconds: int) -> Measured:
    """The sum over ``seeds`` USB hosts, whose packets have different times.

    An agent is connected, and with a flooded load also a user at the console.
    """
    total = Measured(Timing(), Counter(), Counter(), Counter())
    image = load.image()
    for seed in range(1, seeds + 1):
        draw = random.Random(seed)
        with ZephyrJiwy(seed=seed, elf=image) as jiwy:
            jiwy.home()
            jiwy.begin()
            if load.flooded:
                jiwy.pico.call("usb_flood", text="stats\nports\nnonsense\n", port=CONSOLE_PORT)
                jiwy.pico.call(
                    "usb_flood", text="".join(chr(draw.randrange(32, 126)) for _ in range(997)), port=AGENT_PORT
                )
            end = jiwy.agent.now() + milliseconds / 1000
            while jiwy.agent.now() < end:
                jiwy.point(draw.uniform(0.1, 1.2), draw.uniform(0.1, 1.2))
                jiwy.agent.run(load.period * draw.uniform(0.98, 1.02))
            total.timing.add(jiwy.timing())
            total.interrupt.update(deviations(jiwy.interrupts(), PERIOD))
            total.cycle.update(deviations(jiwy.cycles(), PERIOD))
            total.locked.update(jiwy.locked())
            for port in (AGENT_PORT, CONSOLE_PORT) if load.flooded else ():
                jiwy.pico.call("usb_flood", on=False, port=port)
            if load.flooded:
                jiwy.pico.send("\nwatch none\n", port=CONSOLE_PORT)
                jiwy.agent.run(2000)
                while jiwy.pico.receive(port=CONSOLE_PORT):  # answers to the flood
                    jiwy.agent.run(500)
            stats = jiwy.stats()
            total.timing.overruns += int(stats["overruns"])
            if stats["enabled"] != "1" or jiwy.faults():
                raise SystemExit(f"the board does not control any more: {stats}, {jiwy.faults()}")
    return total


def timing_table(measured: dict[Load, Measured], seeds: int, milliseconds: int) -> Table:
    head = ["communication", "cycles", "lost", "overruns", "interrupt", "first encoder", "second encoder", "cycle",
            "locked", "written", "output"]  # fmt: skip
    rows = []
    for load, found in measured.items():
        timing = found.timing
        written = f"{min(timing.written) * 0.008:.0f} ... {max(timing.written) * 0.008:.0f}"
        counts = [f"{timing.cycles:,}", str(timing.missed), str(timing.overruns)]
        late = [extent(one) for one in (found.interrupt, timing.first_read, timing.last_read, found.cycle)]
        locked = f"{min(found.locked) * 0.008:.1f} ... {max(found.locked) * 0.008:.1f}"
        rows.append([load.title, *counts, *late, locked, written, extent(timing.actuation)])
    timings = [found.timing for found in measured.values()]
    reads = [counter for timing in timings for counter in (timing.first_read, timing.last_read)]
    read = max(max(counter) - min(counter) for counter in reads)
    lost = sum(timing.missed + timing.overruns for timing in timings)
    notes = [
        "Deviations from t0 + k T in cycles of 8 ns, smallest ... largest, and the share of cycles that deviate. "
        "Interrupt: entry of the tick's, against the earliest. Encoders: the start of each read, in that interrupt. "
        "Cycle: its first instruction in the control thread, against the earliest. Locked: for how many microseconds "
        "no interrupt was served while outputs were written. Written: the "
        "end of the last write to them, in microseconds from the interrupt's begin. Output: the PWM wrap (every 6,250 "
        "cycles) at which a level takes effect, against the wrap at which most do.",
        f"{seeds} USB hosts with other times of packets, {milliseconds / 1000:g} s each. An agent sends setpoints as "
        "often as the board publishes. Flooded: packets on both serial ports as fast as USB takes them.",
        f"Aims: no tick lost and no overrun: {verdict(lost == 0)}; encoders read within 20 us: {verdict(read < AIM)}.",
        SIMULATED,
    ]
    return Table("Deviation of a 1 ms control cycle, Zephyr on RP2040, simulated", head, rows, notes)


# Parts of a cycle -----------------------------------------------------------------------------------------------------


class Cost(NamedTuple):
    """The mean cost of a part of a cycle: instructions, and processor cycles of 8 ns."""

    instructions: float
    cycles: float


def split_table(count: int) -> Table:
    """The mean cost of each part of the cycles in which both axes move."""
    spans, lines = passages(count)
    ran = len(spans["tick"])
    costs = {part: mean_cost(spans, names) for part, names in PARTS.items()}
    outputs, tick = costs.pop("outputs"), mean_cost(spans, ("tick",))
    reading = costs["reading in the interrupt"]
    costs["tick to cycle"] = Cost(tick.instructions - reading.instructions, tick.cycles - reading.cycles)
    whole = Cost(fmean(passage[2] for passage, _ in lines), fmean(passage[1] for passage, _ in lines))
    known = Cost(*map(sum, zip(*costs.values())))
    costs["rest"] = Cost(whole.instructions - known.instructions, whole.cycles - known.cycles)
    costs["until the outputs are known"] = whole
    costs["writing them, after the output delay"] = outputs
    rows = [[part, f"{cost.instructions:.0f}", f"{0.008 * cost.cycles:.1f}"] for part, cost in costs.items()]
    notes = [
        f"Means of {ran} cycles in which both axes move, from the first instruction of the tick's interrupt on; what "
        "interrupts a cycle counts in it. Tick to cycle: the rest of the interrupt, the semaphore, and the change of "
        "threads.",
        f"Until the outputs are known, a cycle touches {fmean(n for _, n in lines):.0f} lines of 8 bytes of the flash "
        f"({max(n for _, n in lines)} at most), of the 2,048 that the RP2040's cache holds.",
    ]
    return Table("A control cycle of Zephyr on RP2040, simulated", ["part", "instructions", "us"], rows, notes)


def passages(count: int) -> tuple[dict[str, list[list[int]]], list[tuple[list[int], int]]]:
    """The passages of ``count`` cycles: of each function and of the tick, and the way to the outputs.

    The way of each cycle has the number of lines of the flash that it touches.
    """
    functions = [name for names in PARTS.values() for name in names]
    with ZephyrJiwy(elf=LOADS[0].image()) as jiwy:
        jiwy.home()
        pico = jiwy.pico
        for name in functions:
            pico.call("watch_span", name=name, core=0, **{"from": name, "to": "return"})
        ways = {"tick": ("on_wrap", "epg_control_cycle"), "path": ("on_wrap", "epg_port_wait_until")}
        for name, (begin, end) in ways.items():
            pico.call("watch_span", name=name, core=0, **{"from": begin, "to": end})
        jiwy.point(0.9, 0.6)
        lines = []
        for _ in range(count):
            jiwy.agent.run(1)
            found = pico.call("span", name="path")
            if len(found["passages"]) == 1:
                lines.append((found["passages"][0], found["flash_lines"]))
        return {name: pico.call("span", name=name)["passages"] for name in [*functions, "tick"]}, lines


def mean_cost(spans: dict[str, list[list[int]]], names: tuple[str, ...]) -> Cost:
    """The cost of the functions ``names`` together, for each tick."""
    found = [passage for name in names for passage in spans[name]]
    ran = len(spans["tick"])
    return Cost(sum(passage[2] for passage in found) / ran, sum(passage[1] for passage in found) / ran)


if __name__ == "__main__":
    main()
