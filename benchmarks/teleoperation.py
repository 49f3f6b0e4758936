# SPDX-License-Identifier: Apache-2.0
"""Measures the lags of a JIWY that follows another: two emulated Picos in lockstep, and the simulation of their system.

The boards are emulated RP2040 in one simulated time, each with its robot, its USB and an agent.  The simulation of the
system runs the same system file, once with the default transport of its connections, and once with the times that
messages take between these boards.
"""

from __future__ import annotations

import statistics
import tempfile
from collections.abc import Sequence
from pathlib import Path

from measure import need
from report import Table, arguments, command_line, show

from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js
from tests.doubles.xrce_agent.bare import libraries
from tests.platforms.pico.closed_loop.robot import AXES
from tests.platforms.pico.images import freertos_kernel
from tests.platforms.pico.teleoperation.lags import Run, emulated, programs, simulated, simulators
from tests.platforms.pico.teleoperation.system import DELAY

HEAD = ["axis", "lag", "two Picos", "simulation, 1 ms", "ratio", "simulation, 2 to 2.5 ms", "ratio"]


def main() -> None:
    options = arguments(__doc__, seeds=3)
    need(pico_sdk, arm_gcc, node, rp2040js, freertos_kernel, libraries)
    images = programs()
    boards = [emulated(images, seed=seed) for seed in range(1, options.seeds + 1)]
    with tempfile.TemporaryDirectory() as folder:
        others = [[simulated(program, Path(folder))] for program in simulators().values()]
    rows = [row for axis in AXES for row in axis_rows(axis.name, boards, *others)]
    notes = [
        f"Message: from the leader's control cycle whose position it has to the follower's cycle that uses it. The "
        f"agents and their network need {DELAY:g} ms. {messages(boards)} messages of the boards, and the follower's "
        "clock is 500 parts per million fast, so that its cycles begin at all distances from those of the leader.",
        "Position: the follower's axis behind the leader's, a least squares fit in steps of 1 ms. Ratio: two Picos "
        "divided by the simulation.",
    ]
    table = Table("Lag of a JIWY that follows another, simulated, ms", HEAD, rows, notes)
    show("teleoperation", [table], options.write, command_line("teleoperation"))


def axis_rows(axis: str, *columns: Sequence[Run]) -> list[list[str]]:
    """Rows with the runs of the boards, and of both simulations."""
    lags = [sorted(message.lag for run in runs for message in run.messages[axis]) for runs in columns]
    numbers = {
        "message, mean": [statistics.fmean(each) for each in lags],
        "message, max": [each[-1] for each in lags],
        "position": [statistics.fmean(run.follows(axis) for run in runs) for runs in columns],
    }
    rows = []
    for name, (boards, default, usb) in numbers.items():
        cells = [f"{1000 * boards:.2f}"]
        for simulation in (default, usb):
            cells += [f"{1000 * simulation:.2f}", f"{boards / simulation:.2f}"]
        rows.append([axis, name, *cells])
    return rows


def messages(runs: Sequence[Run]) -> int:
    return sum(len(some) for run in runs for some in run.messages.values())


if __name__ == "__main__":
    main()
