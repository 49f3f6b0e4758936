# SPDX-License-Identifier: Apache-2.0
"""The thesis's five network situations as systems in simulated time, and the lags in their traces."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from pathlib import Path

from epg.simulate import simulate_system
from tests.ros2.correlation import Log, fine_lag

ROOT = Path(__file__).resolve().parents[2]
SITUATIONS = ROOT / "examples" / "network_situations"

JIWY, RELBOT = ("pan", "tilt"), ("left", "right")  # axes
BEGIN = {JIWY: 4.5, RELBOT: 0.5}  # s: a JIWY homes before


def _shared(situation: int, robot: str, profiles: Mapping[int, str]) -> dict[str, tuple[str, str]]:
    name = {"jiwy": "JIWY", "relbot": "RELbot"}[robot]
    return {
        f"{situation}: {name} {n}, {profile}": (f"{profile}_{{axis}}", f"{robot}_{n}")
        for n, profile in profiles.items()
    }


def _teleoperation(leader: int, follower: int) -> dict[str, tuple[str, str]]:
    return {
        f"3: setpoint to robot {leader}": ("profile_{axis}", f"jiwy_{leader}"),
        f"3: robot {leader} to robot {follower}": (f"jiwy_{leader}/{{axis}}_publisher", f"jiwy_{follower}"),
        f"3: setpoint to robot {follower}": ("profile_{axis}", f"jiwy_{follower}"),
    }


ROWS: Mapping[int, Mapping[str, tuple[str, str]]] = {
    1: _shared(1, "jiwy", {1: "profile", 2: "profile", 3: "profile", 4: "profile"}),
    2: _shared(2, "jiwy", {1: "profile", 2: "profile", 3: "other_profile", 4: "other_profile"}),
    3: _teleoperation(1, 3) | _teleoperation(2, 4),
    4: _shared(4, "relbot", {1: "profile", 2: "profile", 3: "profile"}),
    5: {f"5: RELbot 1 to {n}": ("relbot_1/{axis}_publisher", f"relbot_{n}") for n in (2, 3)},
}
"""The rows of the tables of ``benchmarks/network_situations.py``: for each, a topic, and the robot that follows it."""


def simulated_lags(number: int, program: Path, folder: Path) -> dict[str, list[int]]:
    """The lags in ms of both axes for each row of a situation, whose ``program`` runs in ``folder``.

    The values are those of the messages, at the times at which they are sent.
    """
    result = simulate_system(program, SITUATIONS / f"situation_{number}.yaml", folder)
    assert result.passed, result
    logs: dict[str, Log] = _read(folder / "setpoints.csv", number) | _read(folder / "topics.csv", number)
    found = {}
    for row, (source, robot) in ROWS[number].items():
        axes = JIWY if robot.startswith("jiwy") else RELBOT
        pairs = ((logs[source.format(axis=axis)], logs[f"{robot}/{axis}_publisher"]) for axis in axes)
        found[row] = [round(1000 * fine_lag(*(_after(log, BEGIN[axes]) for log in pair))) for pair in pairs]
    return found


def _read(file: Path, number: int) -> dict[str, list[tuple[float, float]]]:
    """The values of each topic with their times, by its name without the namespace of the system."""
    found: dict[str, list[tuple[float, float]]] = {}
    with file.open(newline="") as text:
        for row in csv.DictReader(text):
            topic = row["topic"].removeprefix(f"/situation_{number}/")
            found.setdefault(topic, []).append((float(row["time"]), float(row["value"])))
    return found


def _after(log: Log, begin: float) -> list[tuple[float, float]]:
    return [(time, value) for time, value in log if time >= begin and math.isfinite(value)]
