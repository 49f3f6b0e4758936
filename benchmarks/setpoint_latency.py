# SPDX-License-Identifier: Apache-2.0
"""Measures the time from a setpoint at the agent to the change of the output, in control cycles of 1 ms.

Expected: the communication side gives the setpoint to the control side.  The output changes in the next control cycle
after that: at the end of its computation, or ``control.output_delay`` after its tick.  A PWM level then takes effect at
the next period of the PWM.

The host runs in real time, with its agent in this process.  Picos are emulated, in simulated time.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from measure import ROOT, need, run
from report import Table, arguments, command_line, show

from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js, xrce_libraries
from tests.middlewares.xrce import latency as host
from tests.middlewares.xrce.steps import DELAYS, PERIOD, PROJECT, Step, executable
from tests.platforms.pico.images import freertos_kernel
from tests.platforms.pico.xrce import latency as pico

PLATFORMS = {"bare_metal": "Pico, bare metal, USB", "freertos": "Pico, FreeRTOS, USB"}
HEAD = ["target", "output delay", "steps", "in the next cycle", "min", "mean", "median", "99%", "max",
        "from being given", "in the cycle, us"]  # fmt: skip


def main() -> None:
    options = arguments(__doc__, steps=1000, platforms=len(PLATFORMS))
    need(pico_sdk, arm_gcc, node, rp2040js, freertos_kernel, xrce_libraries)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        build(folder)
        rows = [
            row("host, UDP", delay, host.measure(folder / executable(delay, "host"), options.steps, folder))
            for delay in DELAYS
        ]
    for platform in list(PLATFORMS)[: options.platforms]:
        for delay, image in pico.programs(platform).items():
            rows.append(row(PLATFORMS[platform], delay, pico.measure(image, options.steps)))
    notes = [
        "In control cycles of 1 ms, by default. Min to max: from the agent's publishing to the output, at "
        "any phase of the cycle. From being given: from the hand-over to the control side; expected is 0 ... 1 "
        "cycle, and the last column. In the next cycle: the first that began after that moment; the rest came in "
        "one that had just begun.",
        "In the cycle: from the tick to the level that acts, at a wrap of the PWM of 50 us. On the host, which has no "
        "PWM: from the begin of the cycle, which is the tick plus the system's lateness, to the actuator's write.",
    ]
    table = Table("From a setpoint to its output, middleware xrce", HEAD, rows, notes)
    show("setpoint_latency", [table], options.write, command_line("setpoint_latency"))


def build(folder: Path) -> None:
    """Builds the programs for the host."""
    settings = [f"-DEPG_PATH={ROOT}", f"-DPython3_EXECUTABLE={sys.executable}", "-DCMAKE_BUILD_TYPE=Release"]
    run(["cmake", "-S", ROOT / PROJECT, "-B", folder, *settings])
    run(["cmake", "--build", folder, "--parallel", "2"])


def row(name: str, delay: int, steps: Sequence[Step]) -> list[str]:
    whole = sorted(step.whole / PERIOD for step in steps)
    next_one = sum(step.cycles == 1 for step in steps) / len(steps)
    rest = [whole[0], statistics.fmean(whole), statistics.median(whole), whole[int(0.99 * len(whole))], whole[-1]]
    given = extent(steps, lambda step: step.after_arrival / PERIOD, "{:.2f}")
    inside = extent(steps, lambda step: 1e6 * step.in_cycle, "{:.0f}")
    wanted = f"{delay} us" if delay else "none"
    return [name, wanted, str(len(steps)), f"{next_one:.1%}", *(f"{number:.2f}" for number in rest), given, inside]


def extent(steps: Sequence[Step], number: Callable[[Step], float], form: str) -> str:
    numbers = [number(step) for step in steps]
    low, high = form.format(min(numbers)), form.format(max(numbers))
    return low if low == high else f"{low} ... {high}"


if __name__ == "__main__":
    main()
