# SPDX-License-Identifier: Apache-2.0
"""The thesis's five situations of robots on a network (sections 5.3 and 5.4), with robots simulated in real time.

| situation | robots |
|---|---|
| 1 | four JIWYs follow one motion profile |
| 2 | two of them follow another one |
| 3 | teleoperation: two JIWYs follow a profile, two others follow their positions |
| 4 | three RELbots follow one motion profile |
| 5 | teleoperation: two RELbots follow a third, whose motors are off and whose wheels are turned by hand |

As in the thesis, a node Setpoints publishes the profiles every 33 ms, a node Monitoring receives the positions, all
topics are best effort, and both nodes log the time of each message that they send or receive.
"""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from epg.runs.scenario import Profile
from tests.doubles.ros2_peer.messages import Float64_
from tests.doubles.ros2_peer.peer import Peer, Publisher
from tests.ros2.build import Build
from tests.ros2.network import Network, running

PERIOD = 0.033  # s, between two setpoints
ATTEMPTS = 3
JIWY, RELBOT = ("pan", "tilt"), ("left", "right")  # axes


@dataclass(frozen=True)
class Follower:
    """A robot: ``image`` of robots/CMakeLists.txt, number ``serial``.

    ``follows`` is a profile ("/profile") or another robot ("/robot_1").
    """

    image: str
    serial: int
    node: str
    axes: tuple[str, str]
    follows: str

    @property
    def namespace(self) -> str:
        return f"/robot_{self.serial}"


def _jiwy(image: str, serial: int, follows: str) -> Follower:
    return Follower(image, serial, "JIWY_node", JIWY, follows)


def _relbot(image: str, serial: int, follows: str) -> Follower:
    return Follower(image, serial, "RELbot_node", RELBOT, follows)


SITUATIONS: Mapping[int, Sequence[Follower]] = {
    1: [_jiwy("follower", serial, "/profile") for serial in (1, 2, 3, 4)],
    2: [_jiwy("follower", serial, "/profile") for serial in (1, 2)]
    + [_jiwy("other_follower", serial, "/other_profile") for serial in (3, 4)],
    3: [_jiwy("follower", serial, "/profile") for serial in (1, 2)]
    + [_jiwy("mirror", 3, "/robot_1"), _jiwy("other_mirror", 4, "/robot_2")],
    4: [_relbot("relbot", serial, "/profile") for serial in (1, 2, 3)],
    5: [_relbot("relbot_by_hand", 1, "")] + [_relbot("relbot_mirror", serial, "/robot_1") for serial in (2, 3)],
}


@dataclass(frozen=True)
class Logs:
    """``setpoints`` by topic ("/profile/pan"), ``positions`` by robot and axis ("/robot_1/pan"); one clock, in s.

    ``begin`` is the profiles' time 0.  ``latest`` is the largest delay of a setpoint in s.  ``traces`` are the robots'
    own, by namespace.
    """

    begin: float
    latest: float
    setpoints: dict[str, list[tuple[float, float]]]
    positions: dict[str, list[tuple[float, float]]]
    nodes: list[str]
    statistics: dict[str, Path]
    traces: dict[str, Path]

    def window(self, log: Sequence[tuple[float, float]], begin: float, end: float) -> list[tuple[float, float]]:
        """The part of a log between two times of the profiles."""
        return [(at, value) for at, value in log if begin <= at - self.begin <= end]

    @property
    def in_time(self) -> bool:
        """Returns whether neither this process nor a robot was stopped for longer than half a period."""
        reports = [json.loads(file.read_text()) for file in self.statistics.values()]
        return max(self.latest, *(report["lateness_max"] for report in reports)) < PERIOD / 2


def run(
    robots: Sequence[Follower],
    profiles: Mapping[str, Profile],
    duration: float,
    net: Network,
    build: Build,
    folder: Path,
) -> Logs:
    """Runs a situation.  Repeats it if the computer was too busy with other work to measure delays."""
    for _ in range(ATTEMPTS):
        logs = _run(robots, profiles, duration, net, build, folder)
        if logs.in_time:
            break
    return logs


def _run(
    robots: Sequence[Follower],
    profiles: Mapping[str, Profile],
    duration: float,
    net: Network,
    build: Build,
    folder: Path,
) -> Logs:
    """Starts robots and nodes, waits until all have found each other, and publishes ``profiles`` for ``duration`` s.

    ``profiles`` are by topic ("/profile/pan"): the setpoint of that axis is published on "/profile/pan_subscriber".
    """
    programs = {robot.image: build(robot.image) for robot in robots}
    statistics = {robot.namespace: folder / f"statistics_{robot.serial}.json" for robot in robots}
    traces = {robot.namespace: folder / f"trace_{robot.serial}.csv" for robot in robots}
    processes = [
        net.run(
            programs[robot.image],
            *("--quiet", "--serial", str(robot.serial), "--duration", str(duration + 30.0)),
            *("--statistics", str(statistics[robot.namespace]), "--trace", str(traces[robot.namespace])),
        )
        for robot in robots
    ]
    with running(processes), Peer(net.domain, "Monitoring") as monitoring, Peer(net.domain, "Setpoints") as setpoints:
        positions = {
            f"{robot.namespace}/{axis}": monitoring.subscription(
                f"{robot.namespace}/{axis}_publisher", Float64_, reliable=False
            )
            for robot in robots
            for axis in robot.axes
        }
        publishers = {topic: setpoints.publisher(f"{topic}_subscriber", Float64_, reliable=False) for topic in profiles}
        expected = {
            topic: sum(topic == f"{robot.follows}/{axis}" for robot in robots for axis in robot.axes)
            for topic in publishers
        }
        _meet(monitoring, positions.values(), publishers, expected)
        begin, latest = _publish(publishers, profiles, duration, monitoring)
        nodes = monitoring.graph.node_names()
        for process in processes:
            process.send_signal(2)
        for process in processes:
            output, errors = process.communicate(timeout=30)
            assert process.returncode == 130 and errors == "", output + errors
    return Logs(
        begin,
        latest,
        {topic: [(at, message.data) for at, message in publisher.sent] for topic, publisher in publishers.items()},
        {name: [(at, message.data) for at, message in heard.received] for name, heard in positions.items()},
        nodes,
        statistics,
        traces,
    )


def _meet(monitoring: Peer, heard: object, publishers: Mapping[str, Publisher], expected: Mapping[str, int]) -> None:
    def all_here() -> bool:
        matched = all(publishers[topic].matched >= count for topic, count in expected.items())
        return matched and all(subscription.received for subscription in heard)  # type: ignore[attr-defined]

    assert monitoring.spin_until(all_here, 30.0), "the robots have not been found"
    # The robots' services follow.  Reading their QoS keeps this process busy for up to a quarter of a second.
    known = -1
    while known < (known := len(monitoring.graph.writers) + len(monitoring.graph.readers)):
        monitoring.spin(0.3)


def _publish(
    publishers: Mapping[str, Publisher], profiles: Mapping[str, Profile], duration: float, monitoring: Peer
) -> tuple[float, float]:
    """Publishes at integer multiples of the period, without drift; returns time 0 and the largest delay."""
    begin = time.monotonic()  # the profile's time, compared with the robots' traces
    number, latest = 0, 0.0
    while (due := number * PERIOD) < duration:
        for topic, publisher in publishers.items():
            publisher.publish(Float64_(profiles[topic].value(due)))
        number += 1
        while (left := begin + number * PERIOD - time.monotonic()) > 0:  # the period of the setpoints
            monitoring.spin(left)
        latest = max(latest, -left)
    return begin, latest
