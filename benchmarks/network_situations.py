# SPDX-License-Identifier: Apache-2.0
"""Measures lags in the thesis's network situations, as in its tables 5.5 and 5.6: through DDS and in simulated time.

Setpoints are sent every 33 ms, best effort.  The robots are simulated on this computer, the network is the loopback
interface, and there is no agent.  The whole chain from setpoint to position is compared with the thesis.  Most of the
lag is due to the dynamics of the robot and to the two intervals of 33 ms.

The same situations are systems in examples/network_situations.  Their lags in simulated time are always the same.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from measure import run
from report import Table, arguments, command_line, show

from epg.generator.diagnostics import Diagnostics
from epg.runs.scenario import Profile, Scenario
from epg.simulate.load_scenario import load_scenario
from tests.doubles.toolchain import Missing
from tests.ros2.build import Build, build_robots
from tests.ros2.correlation import fine_lag
from tests.ros2.network import network
from tests.ros2.situations import JIWY as JIWY_AXES
from tests.ros2.situations import SITUATIONS, Follower, Logs
from tests.ros2.situations import run as run_situation
from tests.system.situations import SITUATIONS as FOLDER
from tests.system.situations import simulated_lags

FROM = {"JIWY": 4.5, "RELbot": 0.5}  # s: errors and lags are measured from this time on; JIWY homes before it

THESIS_SHARED = {1: ("66", "99"), 2: ("66", "66"), 3: ("99", "133"), 4: ("99", "99")}
"""The thesis's table 5.5, pan and tilt in ms: Pico on Pi 4, Pico on Pi 5, Pico 2 on Pi 4, Pico 2 on Pi 5."""
THESIS_TELEOPERATION = {"setpoint to robot 1": ("66", "100"), "robot 1 to robot 3": ("0", "0")}
THESIS_TELEOPERATION |= {"setpoint to robot 3": ("99", "133")}
"""The thesis's table 5.6, pan and tilt in ms."""

COLUMNS = ["thesis: pan", "thesis: tilt", "pan or left", "tilt or right"]
COLUMNS += ["simulated: pan or left", "simulated: tilt or right"]
"""The columns of the tables of lags."""

RESOLUTION = (
    "The thesis's table 5.5 has real JIWYs behind agents on two Raspberry Pis, in steps of its interval of 33 ms. The "
    "other columns are least squares fits in steps of 1 ms."
)


def main() -> None:
    options = arguments(__doc__, seconds=0, only=0, systems=1)
    try:
        with tempfile.TemporaryDirectory() as folder:
            build = build_robots(Path(folder) / "build", "-O2")
            numbers = [options.only] if options.only else list(SITUATIONS)
            logs = {number: measure(number, build, Path(folder), options.seconds) for number in numbers}
            simulated = simulate(numbers, Path(folder) / "systems") if options.systems else {}
            tables = [shared_table(logs, simulated), teleoperation_table(logs, simulated)]
            tables.append(timing_table(logs))
    except Missing as missing:
        raise SystemExit(str(missing)) from None
    show("network_situations", tables, options.write, command_line("network_situations"))


def scenario_of(number: int) -> Scenario:
    """The scenario of the situation as a system: its motion profiles and its duration."""
    scenario = load_scenario(FOLDER / f"situation_{number}.yaml", Diagnostics())
    assert scenario is not None
    return scenario


def profiles_for(number: int) -> dict[str, Profile]:
    """The motion profiles by topic: "profile_pan" of the system is "/profile/pan" here."""
    return {f"/{'/'.join(name.rsplit('_', 1))}": profile for name, profile in scenario_of(number).profiles.items()}


def simulate(numbers: Sequence[int], folder: Path) -> dict[str, list[str]]:
    """The lags of the situations as systems in simulated time, by the names of the rows."""
    run(["cmake", "-S", FOLDER, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", f"-DPython3_EXECUTABLE={sys.executable}"])
    targets = [f"situation_{number}" for number in numbers]
    run(["cmake", "--build", folder, "--parallel", "2", "--target", *targets])
    found: dict[str, list[str]] = {}
    for number, target in zip(numbers, targets):
        lags = simulated_lags(number, folder / target, folder / f"{target}_results")
        found |= {row: [str(lag) for lag in pair] for row, pair in lags.items()}
    return found


def measure(number: int, build: Build, folder: Path, seconds: int) -> Logs:
    results = folder / str(number)
    results.mkdir()
    with network() as net:
        duration = float(seconds or scenario_of(number).duration)
        return run_situation(SITUATIONS[number], profiles_for(number), duration, net, build, results)


def begin_of(robot: Follower) -> float:
    return FROM["JIWY" if robot.axes == JIWY_AXES else "RELbot"]


def after_begin(logs: Logs, robot: Follower, log: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    return logs.window(log, begin_of(robot), float("inf"))


def lags(logs: Logs, robot: Follower, source: str) -> list[str]:
    """The lag of a robot's position behind ``source`` for each axis, in ms."""
    found = []
    for axis in robot.axes:
        logged = logs.setpoints | logs.positions
        reference = after_begin(logs, robot, logged[f"{source}/{axis}"])
        own = after_begin(logs, robot, logs.positions[f"{robot.namespace}/{axis}"])
        found.append(f"{1000 * fine_lag(reference, own):.0f}")
    return found


Simulated = Mapping[str, Sequence[str]]
"""The lags in simulated time by the names of the rows."""


def shared_table(logs: dict[int, Logs], simulated: Simulated) -> Table:
    rows = []
    for number in sorted({1, 2, 4} & logs.keys()):
        for robot in SITUATIONS[number]:
            name = f"{number}: {robot.node.removesuffix('_node')} {robot.serial}, {robot.follows.removeprefix('/')}"
            thesis = THESIS_SHARED[robot.serial] if number == 1 else ("-", "-")
            cells = lags(logs[number], robot, robot.follows)
            rows.append([name, *thesis, *cells, *simulated.get(name, ("-", "-"))])
    return Table("Lag of positions behind setpoints, ms", ["situation and robot", *COLUMNS], rows, [RESOLUTION])


def teleoperation_table(logs: dict[int, Logs], simulated: Simulated) -> Table:
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
        [f"3: {name}", *THESIS_TELEOPERATION.get(name, ("-", "-")), *lags(logs[3], robot, source)]
        for name, (robot, source) in pairs.items()
        if 3 in logs
    ]
    rows += [
        [f"5: RELbot 1 to {robot.serial}", "-", "-", *lags(logs[5], robot, robot.follows)]
        for robot in SITUATIONS[5][1:]
        if 5 in logs
    ]
    rows = [[*row, *simulated.get(row[0], ("-", "-"))] for row in rows]
    return Table("Lag in teleoperation, ms", ["situation, from and to", *COLUMNS], rows)


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
