# SPDX-License-Identifier: Apache-2.0
"""Two Picos in lockstep, one of which follows the other: the simulation of their system has the same lags."""

from __future__ import annotations

import contextlib
import statistics
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.toolchain import skip_if_missing
from tests.doubles.xrce_agent.agent import Agent
from tests.doubles.xrce_agent.bare import libraries
from tests.doubles.xrce_agent.links import DeviceLink
from tests.doubles.xrce_agent.real_agent import RealAgent, free_domain, program
from tests.doubles.xrce_agent.topics import Topics
from tests.platforms.pico.closed_loop.recording import INPUTS
from tests.platforms.pico.closed_loop.robot import AXES, connect
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated
from tests.platforms.pico.xrce.line import Line

from .lags import ENUMERATED, START, Run, emulated, programs, simulated, simulators
from .system import DELAY

SHORT = 0.6
"""Seconds: the robots home meanwhile."""
LONGEST = 0.0055
"""Seconds of a message: a cycle and a poll of each board, a packet of USB that waits for a frame, and the agents."""

LONGEST_START = 200
"""Turns of 10 ms until both boards are connected and the leader has moved."""
SETPOINT_PAN = 8 * INPUTS.index("setpoint_pan")
"""Offset of this double in the model's inputs."""


@pytest.fixture(scope="module")
def images() -> dict[str, Path]:
    for platform in PLATFORMS:
        skip_unless_emulated(platform)
    skip_if_missing(libraries)
    return programs()


def test_equal_runs_are_equal_and_the_agents_delay_is_added(images: dict[str, Path]) -> None:
    once, again = (emulated(images, duration=SHORT) for _ in range(2))
    assert once == again
    later = emulated(images, delay=DELAY + 1, duration=SHORT)
    for axis in AXES:
        sooner_mean, later_mean = (mean(run, axis.name) for run in (once, later))
        assert later_mean - sooner_mean == pytest.approx(0.001, abs=0.0005)


def test_the_simulation_of_the_system_has_the_lags_of_the_boards(images: dict[str, Path], tmp_path: Path) -> None:
    boards = emulated(images)
    programs = simulators()
    default, usb = (simulated(programs[name], tmp_path) for name in ("two_jiwys", "two_jiwys_usb"))
    for axis in AXES:
        lags = [message.lag for message in boards.messages[axis.name]]
        assert len(lags) > 60
        assert min(lags) > 0.001 and max(lags) < LONGEST
        assert mean(usb, axis.name) == pytest.approx(statistics.fmean(lags), rel=0.15)
        assert mean(default, axis.name) < statistics.fmean(lags), "a message takes longer than the default of 1 ms"
        for simulation in (default, usb):
            assert simulation.follows(axis.name) == pytest.approx(boards.follows(axis.name), abs=0.006)


def mean(run: Run, axis: str) -> float:
    return statistics.fmean(message.lag for message in run.messages[axis])


@contextlib.contextmanager
def agent(kind: str, path: str, topics: Topics, domain: int, folder: Path) -> Iterator[None]:
    """An agent in real time on a serial port: the project's own, or eProsima's."""
    if kind == "own":
        with Agent(DeviceLink(Path(path)), topics):
            yield
    else:
        with RealAgent(["serial", "-b", "115200", "--dev", path], domain, folder):
            yield


@pytest.mark.parametrize("kind", ["own", "eprosima"])
def test_two_boards_on_agents_in_real_time(kind: str, images: dict[str, Path], tmp_path: Path) -> None:
    """The follower's setpoint is 0 until it hears the leader, whose axis moves."""
    if kind == "eprosima":
        skip_if_missing(program)
    topics, domain = Topics(), free_domain()
    with contextlib.ExitStack() as stack:
        lines = []
        for elf in images.values():
            pico = stack.enter_context(Emulator(elf, usb={"seed": 3, "open": False}))
            connect(pico, START)
            pico.run(milliseconds=ENUMERATED)
            lines.append(Line(pico))
            stack.callback(lines[-1].close)
            stack.enter_context(agent(kind, lines[-1].path, topics, domain, tmp_path))
        leader, follower = lines
        for _ in range(LONGEST_START):
            leader.run(10)
            follower.run(10)
            if follower.pico.read("follower_inputs", 8, offset=SETPOINT_PAN) != bytes(8):
                break
        else:
            pytest.fail("no position of the leader has reached the follower")
