# SPDX-License-Identifier: Apache-2.0
"""The promises of control loop and board that hold for every fault of communication."""

from __future__ import annotations

import itertools
import math

import pytest

from tests.platforms.pico.closed_loop.robot import AXES, MOTOR_PERIOD
from tests.platforms.pico.timing.checks import LARGEST_ENTRY, LARGEST_SECOND_READ

from .board import Jiwy

STACK_RESERVE = 1.25
"""A stack must be at least this many times as large as its largest use."""
PUBLISHED = 0.033
"""Seconds between two publications."""
NUMBER, SWITCH = "std_msgs::msg::dds_::Float64_", "std_msgs::msg::dds_::Bool_"
ENDS = {
    "rt/pan_subscriber": (NUMBER, False),
    "rt/tilt_subscriber": (NUMBER, False),
    "rt/JIWY_node/enable": (SWITCH, True),
    "rt/pan_publisher": (NUMBER, False),
    "rt/tilt_publisher": (NUMBER, False),
    "rt/diagnostics": ("diagnostic_msgs::msg::dds_::DiagnosticArray_", True),
}
"""The topics of the node, each with its type; True if it is reliable."""


def assert_undisturbed(jiwy: Jiwy) -> dict[str, str]:
    """No late cycle, no counted error, stacks large enough; returns the console's statistics."""
    stats = assert_nothing_counted(jiwy)
    assert_on_time(jiwy)
    assert jiwy.faults() == []
    assert jiwy.pico.run(cycles=1)["resets"] == []
    return stats


def assert_nothing_counted(jiwy: Jiwy) -> dict[str, str]:
    """Enabled, no counted error, stacks large enough; returns the console's statistics."""
    stats = jiwy.stats()
    assert (stats["enabled"], stats["fault"]) == ("1", "none")
    for name in ("overruns", "missed", "faults", "outputs_late", "setpoints_dropped", "setpoint_timeouts"):
        assert stats[name] == "0", name
    for side in ("control", "communication"):
        assert int(stats[f"{side}_stack_used"]) * STACK_RESERVE <= int(stats[f"{side}_stack_size"]), side
    return stats


def assert_it_tracks(jiwy: Jiwy, seconds: float) -> None:
    """Follows a sine of 0.4 rad in 2 s, with a setpoint every 10 ms; both axes publish together, every 33 ms."""
    begin = jiwy.agent.now()
    distances = []
    while (time := jiwy.agent.now() - begin) < seconds:
        setpoint = 0.5 + 0.4 * math.sin(math.pi * time)
        jiwy.point(setpoint, setpoint)
        jiwy.agent.run(10)
        if time > 0.5:
            distances.append(max(abs(jiwy.angle(axis.name) - setpoint) for axis in AXES))
    assert max(distances) < 0.15
    pan, tilt = (jiwy.agent.heard(f"rt/{axis.name}_publisher", begin) for axis in AXES)
    assert len(pan) == len(tilt) == pytest.approx(seconds / PUBLISHED, abs=2)
    gaps = [later.time - sooner.time for sooner, later in itertools.pairwise(pan)]
    assert max(gaps) < PUBLISHED + 0.004, "a millisecond of the service, and packets of USB"


def assert_on_time(jiwy: Jiwy) -> None:
    """Each cycle since the last call began at its tick, and its outputs acted at the same wrap after it.

    This holds however long the cycle computes: the compiler's doubles take longer for some numbers than for others, but
    ``control.output_delay`` hides the difference.
    """
    timing = jiwy.timing()
    assert timing.cycles > 300
    assert timing.missed == 0
    assert max(map(abs, timing.entry)) <= LARGEST_ENTRY
    assert max(map(abs, timing.first_read)) <= LARGEST_ENTRY
    assert max(map(abs, timing.last_read)) <= LARGEST_SECOND_READ
    assert len({written // MOTOR_PERIOD for written in timing.written}) == 1
    assert set(timing.actuation) <= {0}, "no level has acted at another wrap"
