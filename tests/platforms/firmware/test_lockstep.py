# SPDX-License-Identifier: Apache-2.0
"""JIWY in closed loop on Cortex-M processors in QEMU: the same bits as the host, in every cycle.

The controller runs on the board, as a library in a program with drivers of its own.  The robot is that of the host
target.  Its counts travel over a UART, and levels of PWM and pins come back.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

import pytest

from epg.generator.diagnostics import Diagnostics
from epg.runs.executable import run_executable
from epg.runs.recording import read_table
from epg.runs.setpoint_file import SetpointRow, setpoint_rows, write_setpoints
from epg.simulate.load_scenario import load_scenario
from tests.doubles.mps2.qemu import Board
from tests.doubles.toolchain import ROOT, skip_if_missing

from .builds import HERE, PROCESSORS, build
from .images import MACHINES, image
from .lockstep import SIGNALS, run

DURATION = 6.0
"""Seconds: homing from the example's first angles, and a third of its motion profile's first motion."""

FIRST = (300, 50)
"""Counts of pan and tilt at the start.  Homing moves both below 0, where a counter wraps, and the profile moves them up
through 0 again."""


@lru_cache
def scenario() -> tuple[SetpointRow, ...]:
    """The rows of the example's scenario."""
    diagnostics = Diagnostics()
    loaded = load_scenario(ROOT / "examples" / "jiwy" / "tracking.yaml", diagnostics)
    diagnostics.stop_if_errors()
    assert loaded is not None
    return tuple(row for row in setpoint_rows(loaded) if row[0] < DURATION)


def setpoints() -> dict[int, tuple[float, float]]:
    """Setpoints of pan and tilt by the number of the tick."""
    found: dict[Fraction, dict[str, float]] = {}
    for time, topic, value in scenario():
        if not topic.startswith("$"):
            found.setdefault(time, {})[topic] = float(value)
    return {round(1000 * time): (row["pan_subscriber"], row["tilt_subscriber"]) for time, row in found.items()}


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[float, ...]]:
    """The model's ports in each cycle of the host's own run."""
    skip_if_missing(lambda: PROCESSORS["host"].tool("gcc"))
    folder = tmp_path_factory.mktemp("host")
    write_setpoints(list(scenario()), folder / "setpoints.csv")
    program = build(PROCESSORS["host"], HERE / "robot") / "jiwy_host"
    run_executable(
        program, folder, DURATION, folder / "setpoints.csv", realtime=False, progress=lambda message: None
    )  # fmt: skip
    trace = read_table(folder / "trace.csv").signals
    return list(zip(*(trace[name].value for name in SIGNALS), strict=True))


@pytest.mark.parametrize(("processor", "system"), [("m3", "bare"), ("m4f", "freertos"), ("m7", "bare")])
def test_every_bit_is_the_hosts(processor: str, system: str, host: list[tuple[float, ...]]) -> None:
    robot = build(PROCESSORS["host"], HERE / "robot") / "librobot.so"
    with Board(MACHINES[processor], image(processor, f"lockstep_{system}"), uarts=1) as board:
        result = run(board, robot, len(host), setpoints(), FIRST)
    for number, rows in enumerate(zip(result.rows, host, strict=True)):
        assert rows[0] == rows[1], f"cycle {number}: {dict(zip(SIGNALS, zip(*rows)))}"
    assert (result.cycles, result.missed, result.overruns, result.fault) == (round(1000 * DURATION), 0, 0, 0)
    columns = dict(zip(SIGNALS, zip(*result.rows)))
    for axis, counts in zip(("pan", "tilt"), zip(*result.counts, strict=True), strict=True):
        assert max(columns[f"outputs.encoder_reset_{axis}"]) == 1.0, "homing has ended"
        assert counts[0] > 0 > min(counts) and counts[-1] > 0, "the counter has wrapped both ways"
        assert len(set(columns[f"outputs.pwm_{axis}"])) > 100, "there was something to compare"
