# SPDX-License-Identifier: Apache-2.0
"""Teleoperation of one JIWY by another: the lags of two emulated Picos, and those of the simulation of their system.

A peer sends setpoints to the leader.  Each position that the leader publishes is a setpoint of the follower.  Both runs
have the same system file, setpoints and robots.

>>> # emulated(programs()).messages["pan"][0].lag
"""

from __future__ import annotations

import csv
import hashlib
import subprocess
import sys
from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from epg.generator.bootstrap import cache_folder
from epg.generator.diagnostics import Diagnostics
from epg.runs.scenario import Profile, ProfilePart
from epg.system.load_system import load_system
from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND
from tests.doubles.toolchain import ROOT, locked
from tests.doubles.xrce_agent.messages import float64
from tests.platforms.pico.closed_loop.robot import AXES, angle, connect
from tests.ros2.correlation import Log, fine_lag

from .system import DELAY, Member, System

PROJECT = "tests/platforms/pico/teleoperation/project"
FILE = ROOT / PROJECT / "two_jiwys.system.yaml"
TARGETS = ("leader", "follower")
START = {"pan": 0.12, "tilt": 0.12}
"""The first angles of both robots in rad, as in plant.bindings.yaml."""
ENUMERATED = 40
"""Milliseconds from the reset until a board is configured on USB."""
INTERVAL = 0.01
"""Seconds between two setpoints of the peer."""
MOVES = 1.0
"""Seconds at which the motion begins.  Both robots have homed then."""
MOTION = Profile(0.0, (ProfilePart("raised_cosine", start=MOVES, duration=1.5, target=0.5),))
DURATION = 2.7
LARGEST_LAG = 0.1
"""Seconds: the lag of one robot behind the other is sought up to here."""
SAMPLE = 4
"""Milliseconds between two samples of the emulated robots."""
SECOND = 1000 * CYCLES_PER_MILLISECOND

SPANS: Mapping[str, Mapping[str, tuple[str, int, int | None]]] = {
    "leader": {
        "tick": ("on_wrap", 1, None),
        "stored": ("epg_exchange_write", 1, 0),
        "copied": ("epg_control_monitor", 0, None),
        "sent": ("send_message", 0, 0),
    },
    "follower": {
        "tick": ("on_wrap", 1, None),
        "given": ("epg_control_receive", 0, 1),
        "taken": ("epg_setpoints_take", 1, None),
    },
}
"""Functions of the images, their cores, and the register whose value tells the calls apart.

The leader's cycle stores its values, and the communication side copies them and sends them.  The follower's
communication side is given a value, and its control cycle takes it.
"""


@dataclass(frozen=True)
class Message:
    """A position on its way, in seconds of the system: the leader's tick and the tick of the follower that uses it.

    ``heard``: at the agent; ``given``: at the follower's control side.  Both are 0 in the simulation of the system.
    """

    sent: float
    used: float
    heard: float = 0.0
    given: float = 0.0

    @property
    def lag(self) -> float:
        return self.used - self.sent


@dataclass(frozen=True)
class Run:
    """The messages and the angles of each axis; angles are logs of each target's robot."""

    messages: Mapping[str, Sequence[Message]]
    angles: Mapping[str, Mapping[str, Log]]

    def follows(self, axis: str) -> float:
        """Seconds by which the follower's axis is behind the leader's."""
        leader, follower = (
            [sample for sample in self.angles[target][axis] if sample[0] >= MOVES] for target in TARGETS
        )
        return fine_lag(leader, follower, largest=LARGEST_LAG)


def topic(axis: str, kind: str) -> str:
    return f"/two_jiwys/leader/{axis}_{kind}"


def setpoints() -> list[tuple[float, float]]:
    """The times and the values that the peer sends to both axes of the leader."""
    times = [number * INTERVAL for number in range(round(DURATION / INTERVAL))]
    return [(time, MOTION.value(time)) for time in times]


# Emulated ---------------------------------------------------------------------------------------------------------


def programs() -> dict[str, Path]:
    """The images; SDK, kernel and compiler must be installed."""
    names = [f"{target}_firmware" for target in TARGETS]
    folder = build(PROJECT, targets=names)
    return {target: folder / f"{name}.elf" for target, name in zip(TARGETS, names, strict=True)}


def emulated(images: Mapping[str, Path], delay: float = DELAY, seed: int = 1, duration: float = DURATION) -> Run:
    """A run of both images; ``seed`` sets the times of packets on USB, ``delay`` is that of the agents in ms."""
    diagnostics = Diagnostics()
    file = load_system(FILE, diagnostics)
    assert file is not None
    members = [
        Member(images[name], seed=2 * seed + number, drift=file.targets[name].clock.drift)
        for number, name in enumerate(TARGETS)
    ]
    with System(members, delay) as system:
        for member in members:
            connect(member.emulator, START)
        system.run(ENUMERATED)
        system.connect()
        for name, member in zip(TARGETS, members, strict=True):
            for span, (symbol, core, register) in SPANS[name].items():
                watched = {"name": span, "core": core, "from": symbol, "to": "return"}
                member.emulator.call("watch_span", **watched, **({} if register is None else {"register": register}))
        wanted = {f"rt{topic(axis.name, 'publisher')}" for axis in AXES}
        system.run_until(
            lambda: wanted <= {end.topic for end in system.topics.readers} & {said.topic for said in system.said}, 1000
        )
        system.run(10)  # so that no message is on its way
        for name, member in zip(TARGETS, members, strict=True):
            for span in SPANS[name]:
                member.emulator.call("span", name=span)
        begin = system.now()
        angles = move(system, duration)
        spans = {
            name: {span: member.emulator.call("span", name=span)["passages"] for span in SPANS[name]}
            for name, member in zip(TARGETS, members, strict=True)
        }
        messages = {}
        for number, axis in enumerate(AXES):
            heard = [s.time for s in system.said if s.topic == f"rt{topic(axis.name, 'publisher')}" and s.time > begin]
            messages[axis.name] = _messages(spans, number, heard, members)
        assert [member.emulator.call("faults") for member in members] == [[], []]
    return Run(messages, angles)


def move(system: System, duration: float) -> dict[str, dict[str, list[tuple[float, float]]]]:
    """Sends the setpoints; returns the angles of both robots.  Ends when no message is on its way."""
    angles: dict[str, dict[str, list[tuple[float, float]]]] = {
        target: {axis.name: [] for axis in AXES} for target in TARGETS
    }
    left = [each for each in setpoints() if each[0] > system.now()]
    while system.now() < duration or system.now() - system.said[-1].time < 0.01:
        for axis in AXES:
            for target, member in zip(TARGETS, system.members, strict=True):
                angles[target][axis.name].append((system.now(), angle(member.emulator, axis.name)))
        if left and left[0][0] <= system.now():
            _, value = left.pop(0)
            for axis in AXES:
                system.topics.publish(f"rt{topic(axis.name, 'subscriber')}", float64(value), reliable=False)
        system.run(SAMPLE if not left else min(SAMPLE, 1000 * max(0.0, left[0][0] - system.now()) + 0.001))
    return angles


def _messages(
    spans: Mapping[str, Mapping[str, list[list[int]]]], number: int, heard: Sequence[float], members: Sequence[Member]
) -> list[Message]:
    """The messages of publication ``number`` of the leader, which is also the number of the follower's setpoint."""
    leader, follower = (spans[target] for target in TARGETS)
    ticks = [begin for begin, *_ in leader["tick"]]
    # A cycle writes several exchanges: first the one with its values.
    values_of = next(exchange for begin, *_, exchange in leader["stored"] if begin > ticks[0])
    stored = [begin + length for begin, length, _, exchange in leader["stored"] if exchange == values_of]
    copied = [begin for begin, *_ in leader["copied"]]
    sent = [begin for begin, _, _, publication in leader["sent"] if publication == number]
    given = [begin + length for begin, length, _, setpoint in follower["given"] if setpoint == number]
    taken = [begin for begin, *_ in follower["taken"]]
    starts = [begin for begin, *_ in follower["tick"]]
    assert len(sent) == len(heard) == len(given)
    found = []
    for at, arrival, gift in zip(sent, heard, given, strict=True):
        tick = _last(ticks, _last(stored, _last(copied, at)))
        use = _last(starts, taken[bisect_left(taken, gift)])
        used, received = (members[1].clock.time_of(cycle) / SECOND for cycle in (use, gift))
        found.append(Message(members[0].clock.time_of(tick) / SECOND, used, arrival, received))
    assert all(each.sent < each.heard < min(each.given, each.used) for each in found)
    return found


def _last(times: Sequence[int], until: int) -> int:
    """The last of the sorted ``times`` up to ``until``."""
    return times[bisect_right(times, until) - 1]


# Simulated --------------------------------------------------------------------------------------------------------


def simulators() -> dict[str, Path]:
    """The programs that simulate the system: ``two_jiwys``, and ``two_jiwys_usb`` with the transport of boards."""
    source = ROOT / PROJECT / "simulation"
    digest = hashlib.sha256(repr((str(source), sys.executable)).encode()).hexdigest()[:16]
    folder = cache_folder() / "test-build" / f"two-jiwys-{digest}"
    with locked(folder):
        settings = [f"-DEPG_PATH={ROOT}", f"-DPython3_EXECUTABLE={sys.executable}"]
        for command in (
            ["cmake", "-S", str(source), "-B", str(folder), "-G", "Ninja", *settings],
            ["cmake", "--build", str(folder), "--parallel", "2"],
        ):
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stdout + done.stderr
    return {name: folder / name for name in ("two_jiwys", "two_jiwys_usb")}


def simulated(program: Path, folder: Path, *options: str) -> Run:
    """The same run in the simulation of the system."""
    lines = [f"{time:.3f},{topic(axis.name, 'subscriber')},{value!r}" for time, value in setpoints() for axis in AXES]
    (folder / "leader.in").write_text("\n".join(["time,topic,value", *lines, ""]), encoding="utf-8")
    command: list[str | Path] = [program, "--duration", str(DURATION), "--trace", folder, *options]
    command += ["--topics", folder / "topics.csv", "--setpoints", f"leader={folder / 'leader.in'}"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    traces = {target: _rows(folder / f"{target}.csv") for target in TARGETS}
    sent = _rows(folder / "topics.csv")
    messages, angles = {}, {target: {} for target in TARGETS}  # type: ignore[var-annotated]
    for axis in AXES:
        name = topic(axis.name, "publisher")
        published = _changes([(float(row["time"]), float(row["value"])) for row in sent if row["topic"] == name])
        signal = f"inputs.setpoint_{axis.name}"
        used = _changes([(float(row["time"]), float(row[signal])) for row in traces["follower"]])
        pairs = zip(published, used, strict=False)
        messages[axis.name] = [Message(first[0], second[0]) for first, second in pairs]
        assert [value for _, value in used] == [value for _, value in published[: len(used)]]
        for target in TARGETS:
            log = [(float(row["time"]), float(row[f"plant.outputs.angle_{axis.name}"])) for row in traces[target]]
            angles[target][axis.name] = log
    return Run(messages, angles)


def _rows(file: Path) -> list[dict[str, str]]:
    with file.open(newline="", encoding="utf-8") as text:
        return list(csv.DictReader(text))


def _changes(log: Log) -> list[tuple[float, float]]:
    """The entries whose value is not that of the entry before.  Before the first, it is 0."""
    return [now for before, now in zip([(0.0, 0.0), *log], log, strict=False) if now[1] != before[1]]
