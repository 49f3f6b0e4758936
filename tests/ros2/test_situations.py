# SPDX-License-Identifier: Apache-2.0
"""The thesis's network situations in short: tracking, teleoperation and their delays, in real time through DDS."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

pytest.importorskip("tests.doubles.ros2_peer.packages", exc_type=ImportError)

from epg.runs.scenario import Profile, ProfilePart
from tests.ros2.build import Build
from tests.ros2.correlation import errors, fine_lag, lag
from tests.ros2.network import Network
from tests.ros2.situations import JIWY, PERIOD, RELBOT, SITUATIONS, Follower, Logs, run

HOMED = 4.5  # s: until then JIWY's axes search their end stops
JIWY_PROFILE = Profile(0.0, (ProfilePart("raised_cosine", HOMED, 3.0, 1.0),))
OTHER_PROFILE = Profile(0.0, (ProfilePart("raised_cosine", HOMED + 0.4, 2.6, 0.7),))
RELBOT_PROFILE = Profile(0.0, (ProfilePart("move", 0.5, 2.0, 3.0), ProfilePart("move", 2.6, 1.5, 0.0)))

SHARE_OF_THE_NETWORK = 1.25
"""Largest factor by which the network's delay of setpoints may increase the errors of a robot."""

LIMITS = {
    axis: (rms * SHARE_OF_THE_NETWORK, largest * SHARE_OF_THE_NETWORK)
    for axis, rms, largest in (("pan", 0.03, 0.06), ("tilt", 0.05, 0.1), ("left", 0.1, 0.2), ("right", 0.1, 0.2))
}
"""RMS and largest error in rad: those of examples/jiwy/tracking.yaml and examples/relbot/tracking.yaml, increased."""


def jiwy_profiles(other: bool = False) -> dict[str, Profile]:
    profiles = {f"/profile/{axis}": JIWY_PROFILE for axis in JIWY}
    return profiles | ({f"/other_profile/{axis}": OTHER_PROFILE for axis in JIWY} if other else {})


def node_names(situation: int) -> list[str]:
    robots = SITUATIONS[situation]
    return sorted(["/Monitoring", "/Setpoints", *(f"{robot.namespace}/{robot.node}" for robot in robots)])


def check_tracking(logs: Logs, robot: Follower, profiles: dict[str, Profile], begin: float, end: float) -> None:
    """Compares the positions with the profile itself, at the times at which the positions arrive."""
    for axis in robot.axes:
        profile = profiles[f"{robot.follows}/{axis}"]
        heard = logs.window(logs.positions[f"{robot.namespace}/{axis}"], begin, end)
        assert len(heard) >= 0.9 * (end - begin) / PERIOD
        rms, largest = errors(heard, [profile.value(at - logs.begin) for at, _ in heard])
        assert (rms, largest) <= LIMITS[axis] and largest <= LIMITS[axis][1], (robot, axis, rms, largest)
        sent = logs.window(logs.setpoints[f"{robot.follows}/{axis}"], begin, end)
        # The resolution is 33 ms.  The thesis measured 66 to 133 ms, mostly due to the robot's own dynamics.
        assert 0.0 <= lag(sent, heard) <= 3.5 * PERIOD, (robot, axis)


def check_mirror(logs: Logs, follower: Follower, begin: float, end: float, limit: float) -> None:
    """Compares a robot with the robot that it follows."""
    for axis in follower.axes:
        leader = logs.window(logs.positions[f"{follower.follows}/{axis}"], begin, end)
        own = logs.window(logs.positions[f"{follower.namespace}/{axis}"], begin, end)
        assert 0.0 <= lag(leader, own) <= 3.5 * PERIOD, (follower, axis)
        assert 0.0 < fine_lag(leader, own) <= 0.1, (follower, axis)
        assert max(value for _, value in own) == pytest.approx(max(value for _, value in leader), abs=limit)
        assert max(value for _, value in leader) > 0.5  # the leader has moved


def test_four_jiwys_follow_one_profile(build: Build, net: Network, tmp_path: Path) -> None:
    logs = run(SITUATIONS[1], jiwy_profiles(), HOMED + 3.5, net, build, tmp_path)
    assert logs.nodes == node_names(1)  # six nodes, as in the thesis
    for robot in SITUATIONS[1]:
        check_tracking(logs, robot, jiwy_profiles(), HOMED, HOMED + 3.2)


def test_two_profiles_at_once(build: Build, net: Network, tmp_path: Path) -> None:
    profiles = jiwy_profiles(other=True)
    logs = run(SITUATIONS[2], profiles, HOMED + 3.5, net, build, tmp_path)
    assert logs.nodes == node_names(2)
    for robot in SITUATIONS[2]:
        check_tracking(logs, robot, profiles, HOMED, HOMED + 3.2)


def test_jiwys_follow_the_positions_of_others(build: Build, net: Network, tmp_path: Path) -> None:
    logs = run(SITUATIONS[3], jiwy_profiles(), HOMED + 3.7, net, build, tmp_path)
    assert logs.nodes == node_names(3)
    for robot in SITUATIONS[3]:
        if robot.follows == "/profile":
            check_tracking(logs, robot, jiwy_profiles(), HOMED, HOMED + 3.2)
        else:
            check_mirror(logs, robot, HOMED, HOMED + 3.5, limit=0.1)


def test_three_relbots_follow_one_profile(build: Build, net: Network, tmp_path: Path) -> None:
    profiles = {f"/profile/{axis}": RELBOT_PROFILE for axis in RELBOT}
    logs = run(SITUATIONS[4], profiles, 4.4, net, build, tmp_path)
    assert logs.nodes == node_names(4)
    for robot in SITUATIONS[4]:
        check_tracking(logs, robot, profiles, 0.3, 4.2)


def test_relbots_follow_one_that_is_moved_by_hand(build: Build, net: Network, tmp_path: Path) -> None:
    """The moved robot is disabled: its PWM is off, but its encoders and topics are active."""
    logs = run(SITUATIONS[5], {}, 5.2, net, build, tmp_path)
    assert logs.nodes == node_names(5)
    for robot in SITUATIONS[5][1:]:
        check_mirror(logs, robot, 0.5, 5.1, limit=0.15)
    with logs.traces["/robot_1"].open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {float(row["plant.outputs.duty_seen"]) for row in rows} == {0.0}
    assert max(float(row["plant.outputs.angle_left"]) for row in rows) > 3.0
