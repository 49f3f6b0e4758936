# SPDX-License-Identifier: Apache-2.0
"""Measures lags in the thesis's network situations through DDS, as in its tables 5.5 and 5.6, in real time.

Setpoints are sent every 33 ms, best effort.  The robots are simulated on this computer, the network is the loopback
interface, and there is no agent.  The whole chain from setpoint to position is compared with the thesis.  Most of the
lag is due to the dynamics of the robot and to the two intervals of 33 ms.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from measure import JIWY, ROOT
from report import Table, arguments, command_line, show

sys.path.insert(0, str(ROOT))

from epg.diagnostics import Diagnostics
from epg.simulate.load_scenario import load_scenario
from epg.simulate.scenario import Profile
from tests.emulator.toolchain import Missing
from tests.ros2.build import Build, build_robots
from tests.ros2.correlation import errors, fine_lag, lag
from tests.ros2.network import network
from tests.ros2.situations import JIWY as JIWY_AXES
from tests.ros2.situations import RELBOT, SITUATIONS, Follower, Logs, run

RELBOT_FOLDER = ROOT / "examples" / "relbot"
FROM = {"JIWY": 4.5, "RELbot": 0.5}  # s: errors and lags are measured from this time on; JIWY homes before it

THESIS_SHARED = {1: ("66", "99"), 2: ("66", "66"), 3: ("99", "133"), 4: ("99", "99")}
"""The thesis's table 5.5, pan and tilt in ms: Pico on Pi 4, Pico on Pi 5, Pico 2 on Pi 4, Pico 2 on Pi 5."""
THESIS_TELEOPERATION = {"setpoint to robot 1": ("66", "100"), "robot 1 to robot 3": ("0", "0")}
THESIS_TELEOPERATION |= {"setpoint to robot 3": ("99", "133")}
"""The thesis's table 5.6, pan and tilt in ms."""

RESOLUTION = (
    "The thesis's table 5.5 has real JIWYs behind agents on two Raspberry Pis. Its resolution, and that of the columns "
    "beside it, is the interval of 33 ms; the finer columns are a least squares fit in steps of 1 ms."
)


def main() -> None:
    options = arguments(__doc__, seconds=0, only=0)
    try:
        with tempfile.TemporaryDirectory() as folder:
            build = build_robots(Path(folder) / "build", "-O2")
            numbers = [options.only] if options.only else list(SITUATIONS)
            logs = {number: measure(number, build, Path(folder), options.seconds) for number in numbers}
            tables = [shared_table(logs), teleoperation_table(logs), tracking_table(logs), timing_table(logs)]
    except Missing as missing:
        raise SystemExit(str(missing)) from None
    show("network_situations", tables, options.write, command_line("network_situations"))


def profiles_of(example: Path) -> dict[str, Profile]:
    """The motion profiles of the example's scenario, by axis."""
    scenario = load_scenario(example / "tracking.yaml", Diagnostics())
    assert scenario is not None
    return {topic.removesuffix("_subscriber"): profile for topic, profile in scenario.profiles.items()}


def profiles_for(number: int) -> dict[str, Profile]:
    jiwy, relbot = profiles_of(JIWY), profiles_of(RELBOT_FOLDER)
    if number == 4:
        return {f"/profile/{axis}": relbot[axis] for axis in RELBOT}
    if number == 5:
        return {}
    found = {f"/profile/{axis}": jiwy[axis] for axis in JIWY_AXES}
    if number == 2:
        found |= {f"/other_profile/{axis}": smaller(jiwy[axis]) for axis in JIWY_AXES}
    return found


def smaller(profile: Profile) -> Profile:
    """A similar profile with 0.6 times the size; each part begins half a second later."""
    parts = tuple(
        type(part)(part.shape, part.start + 0.5, part.duration, 0.6 * part.target, part.frequency)
        for part in profile.parts
    )
    return Profile(profile.initial, parts)


def duration_of(number: int, seconds: int) -> float:
    if seconds:
        return float(seconds)
    return {4: 14.0, 5: 12.0}.get(number, 18.0)


def measure(number: int, build: Build, folder: Path, seconds: int) -> Logs:
    results = folder / str(number)
    results.mkdir()
    with network() as net:
        return run(SITUATIONS[number], profiles_for(number), duration_of(number, seconds), net, build, results)


def begin_of(robot: Follower) -> float:
    return FROM["JIWY" if robot.axes == JIWY_AXES else "RELbot"]


def after_begin(logs: Logs, robot: Follower, log: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    return logs.window(log, begin_of(robot), float("inf"))


def lags(logs: Logs, robot: Follower, source: str) -> list[tuple[float, float]]:
    """The lag of a robot's position behind ``source`` for each axis, in ms: with the thesis's resolution, and finer."""
    found = []
    for axis in robot.axes:
        logged = logs.setpoints | logs.positions
        reference = after_begin(logs, robot, logged[f"{source}/{axis}"])
        own = after_begin(logs, robot, logs.positions[f"{robot.namespace}/{axis}"])
        found.append((1000 * lag(reference, own), 1000 * fine_lag(reference, own)))
    return found


def lag_cells(found: Sequence[tuple[float, float]]) -> list[str]:
    return [*(f"{coarse:.0f}" for coarse, _ in found), *(f"{fine:.0f}" for _, fine in found)]


def shared_table(logs: dict[int, Logs]) -> Table:
    rows = []
    for number in sorted({1, 2, 4} & logs.keys()):
        for robot in SITUATIONS[number]:
            name = f"{number}: {robot.node.removesuffix('_node')} {robot.serial}, {robot.follows.removeprefix('/')}"
            thesis = THESIS_SHARED[robot.serial] if number == 1 else ("-", "-")
            rows.append([name, *thesis, *lag_cells(lags(logs[number], robot, robot.follows))])
    head = ["situation and robot", "thesis: pan", "thesis: tilt", "pan or left", "tilt or right"]
    return Table(
        "Lag of positions behind setpoints, ms",
        [*head, "finer: pan or left", "finer: tilt or right"],
        rows,
        [RESOLUTION],
    )


def teleoperation_table(logs: dict[int, Logs]) -> Table:
    robots = {robot.serial: robot for robot in SITUATIONS[3]}
    pairs = {
        "setpoint to robot 1": (robots[1], "/profile"),
        "robot 1 to robot 3": (robots[3], "/robot_1"),
        "setpoint to robot 3": (robots[3], "/profile"),
        "setpoint to robot 2": (robots[2], "/profile"),
        "robot 2 to robot 4": (robots[4], "/robot_2"),
        "setpoint to robot 4": (robots[4], "/profile"),
    }
    rows = [
        [f"3: {name}", *THESIS_TELEOPERATION.get(name, ("-", "-")), *lag_cells(lags(logs[3], robot, source))]
        for name, (robot, source) in pairs.items()
        if 3 in logs
    ]
    rows += [
        [f"5: RELbot 1 to {robot.serial}", "-", "-", *lag_cells(lags(logs[5], robot, robot.follows))]
        for robot in SITUATIONS[5][1:]
        if 5 in logs
    ]
    head = ["situation, from and to", "thesis: pan", "thesis: tilt", "pan or left", "tilt or right"]
    return Table("Lag in teleoperation, ms", [*head, "finer: pan or left", "finer: tilt or right"], rows)


def tracking_table(logs: dict[int, Logs]) -> Table:
    rows = []
    for number in sorted({1, 2, 3, 4} & logs.keys()):
        profiles = profiles_for(number)
        for robot in SITUATIONS[number]:
            if robot.follows in ("/profile", "/other_profile"):
                cells = []
                for axis in robot.axes:
                    heard = after_begin(logs[number], robot, logs[number].positions[f"{robot.namespace}/{axis}"])
                    profile = profiles[f"{robot.follows}/{axis}"]
                    rms, largest = errors(heard, [profile.value(at - logs[number].begin) for at, _ in heard])
                    cells += [f"{1000 * rms:.1f}", f"{1000 * largest:.1f}"]
                name = f"{number}: {robot.node.removesuffix('_node')} {robot.serial}"
                rows.append([name, *cells])
    head = ["situation and robot", "RMS: pan or left", "largest", "RMS: tilt or right", "largest: tilt or right"]
    return Table("Error of positions when they are heard, against the profile, mrad", head, rows)


def timing_table(logs: dict[int, Logs]) -> Table:
    rows = []
    for number, log in logs.items():
        read = [json.loads(path.read_text(encoding="utf-8")) for path in log.statistics.values()]
        cycles = sum(statistics["cycles"] for statistics in read)
        rows.append(
            [
                str(number),
                f"{len(read) + 2}",
                f"{1e6 * max(statistics['lateness_p99'] for statistics in read):.0f}",
                f"{1e6 * max(statistics['lateness_max'] for statistics in read):.0f}",
                f"{cycles}",
                f"{sum(statistics['missed'] for statistics in read)}",
                read[0]["scheduler"],
            ]
        )
    head = [
        "situation",
        "nodes",
        "99 % of cycles late by less than, us",
        "largest, us",
        "cycles",
        "missed",
        "scheduler",
    ]
    return Table(
        "Control cycles meanwhile, of all robots", head, rows, ["The robots share two threads of a processor."]
    )


if __name__ == "__main__":
    main()
