# SPDX-License-Identifier: Apache-2.0
"""A setpoint acts in the next control cycle after its arrival, and not before the output delay."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.doubles.toolchain import ROOT, skip_if_missing, xrce_libraries
from tests.examples.pico_project import configure, run
from tests.middlewares.xrce.steps import DELAYS, PERIOD, PROJECT, executable

from .latency import measure

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="real time on the host needs Linux")
STEPS = 150
RESOLUTION = 5e-6
"""Seconds: the program records the begin of a cycle by two readings of the clock."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    skip_if_missing(xrce_libraries)
    made = tmp_path_factory.mktemp("latency")
    configure(ROOT / PROJECT, build=made)
    run(made, "cmake", "--build", ".")
    return made


@pytest.mark.parametrize("delay", DELAYS)
def test_the_next_cycle(folder: Path, delay: int) -> None:
    steps = measure(folder / executable(delay, "host"), STEPS, folder)
    assert len(steps) > 0.8 * STEPS, "best effort, and of two that came within a cycle the newer acts"
    assert {step.cycles for step in steps} <= {0, 1}
    soonest = 1e-6 * delay
    assert all(step.after_tick > soonest - RESOLUTION for step in steps), "a cycle that starts late waits less"
    on_time = [step for step in steps if step.after_arrival <= PERIOD + soonest + 0.0005]
    assert len(on_time) > len(steps) // 2, "the rest: what else the machine did"
    waited = sorted(step.in_cycle for step in steps)[len(steps) // 2]
    assert 0.5 * soonest <= waited < soonest + 0.0005
