# SPDX-License-Identifier: Apache-2.0
"""Measures the jitter of ticks, encoder reads and outputs of JIWY's images on an RP2040.

Everything runs in EPG's emulator, which times every control cycle from outside.  The emulator simulates both cores with
the exact number of processor cycles, PIO, PWM and USB.  It does not simulate contention for the bus or the flash cache.
"""

from __future__ import annotations

from collections import Counter

from measure import need
from report import Table, arguments, command_line, show

from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js
from tests.platforms.pico.images import freertos_kernel
from tests.platforms.pico.timing.many import measure_many
from tests.platforms.pico.timing.measure import LOADS, Load, Timing
from tests.platforms.pico.timing.programs import Program

HEAD = ["tick", "communication", "cycles", "lost", "overruns", "entry", "first encoder", "second encoder", "written",
        "output"]  # fmt: skip
NOT_HARDWARE = (
    "Simulated, with the compiler's doubles, without contention of the cores and without the flash cache, so a "
    "board deviates more. The thesis's 75 us (bare metal) and 400 us (FreeRTOS) were measured on Pico 2 boards by "
    "other means."
)
AIM_ENTRY, AIM_OUTPUT = 3, 0
FEWEST_CHANGES = 1000
"""The least number of changes of an output level in a row of the table for a statement about outputs."""


def main() -> None:
    options = arguments(__doc__, seeds=20, milliseconds=3000, programs=2, loads=2)
    need(pico_sdk, arm_gcc, node, rp2040js, freertos_kernel)
    loads = [load for load in LOADS if load.period == 33][: options.loads]  # tests time the other periods
    programs = [Program(platform, 33) for platform in ("bare_metal", "freertos")][: options.programs]
    measured = [
        (program, load, measure_many(program, load, range(options.seeds), options.milliseconds / 1000))
        for program in programs
        for load in loads
    ]
    rows = [row(program, load, timing) for program, load, timing in measured]
    notes = [
        "Deviations from t0 + k T in cycles of 8 ns, smallest ... largest, and the share of cycles that deviate. "
        "Entry: the first instruction of the tick's handler. Encoders: the start of each read. Written: the end of the "
        "last PWM write, in microseconds from the tick. Output: the PWM wrap (every 6,250 cycles) at which a level "
        "takes effect, against the wrap at which most do.",
        f"{options.seeds} USB hosts with random phase and a clock within 500 ppm; {options.milliseconds / 1000:g} s "
        "from reset each. Flooded: packets both ways as fast as USB takes them.",
        *judged([timing for _, _, timing in measured]),
        NOT_HARDWARE,
    ]
    show("pico_timing", [Table("Deviation of a 1 ms control cycle, RP2040, simulated", HEAD, rows, notes)],
         options.write, command_line("pico_timing"))  # fmt: skip


def row(program: Program, load: Load, timing: Timing) -> list[str]:
    counts = [f"{timing.cycles:,}", f"{timing.missed:,}", f"{timing.overruns:,}"]
    written = f"{min(timing.written) * 0.008:.0f} ... {max(timing.written) * 0.008:.0f}"
    reads = [extent(timing.entry), extent(timing.first_read), extent(timing.last_read)]
    return [program.title, load.title, *counts, *reads, written, extent(timing.actuation)]


def extent(deviations: Counter[int]) -> str:
    low, high = min(deviations), max(deviations)
    if low == high == 0:
        return "0"
    share = 1 - deviations[0] / deviations.total()
    return f"{low:,} ... {high:,} ({share:.1%})"


def judged(timings: list[Timing]) -> list[str]:
    entry = max(max(map(abs, timing.entry)) for timing in timings)
    output = max(max(map(abs, timing.actuation)) for timing in timings)
    lost = sum(timing.missed + timing.overruns for timing in timings)
    outputs = verdict(output <= AIM_OUTPUT)
    if min(timing.actuation.total() for timing in timings) < FEWEST_CHANGES:
        outputs = "not measured, as outputs have hardly changed in so short a time"
    return [
        f"Aims: no tick lost and no overrun: {verdict(lost == 0)}; entry within {AIM_ENTRY} cycles: "
        f"{verdict(entry <= AIM_ENTRY)}; outputs within {AIM_OUTPUT} cycles: {outputs}."
    ]


def verdict(held: bool) -> str:
    return "holds" if held else "does not hold"


if __name__ == "__main__":
    main()
