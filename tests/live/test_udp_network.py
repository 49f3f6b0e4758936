# SPDX-License-Identifier: Apache-2.0
"""The console by UDP over bad networks: lost, repeated and late datagrams, and two computers."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from itertools import dropwhile, pairwise
from pathlib import Path

import pytest

from epg.live.client import CommandRefused, Lost, Rows
from epg.live.rows import Stream
from tests.doubles.network.relay import LATE
from tests.waiting import until

from .target import begin_of, client_of, let_pass, tick_of
from .test_live import ROOT
from .udp_target import Trace, UdpTarget

LEASE = 0.3
PERIOD = 0.001
OPERATOR = 16  # the number of this fault in a trace
DUTY = "plant.inputs.duty_pan"


@pytest.fixture
def target(jiwy_host: Path, tmp_path: Path) -> Iterator[UdpTarget]:
    found = UdpTarget(jiwy_host, tmp_path)
    yield found
    found.process.kill()
    found.process.communicate()


@pytest.fixture
def bad(target: UdpTarget) -> Iterator[Path]:
    """The port of a relay that loses 20 % of the datagrams, and repeats 20 %."""
    command = [sys.executable, "-m", "tests.doubles.network.relay", str(target.number), "0.2", "0.2"]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as relay:
        assert relay.stdout is not None
        yield Path(f"udp:{int(relay.stdout.readline())}")
        relay.kill()


def pulses(trace: Trace, signal: str) -> list[int]:
    """The lengths, in cycles, of the times in which a signal is not 0."""
    found: list[int] = []
    before = 0.0
    for row in trace:
        if row[signal] != 0 and before == 0:
            found.append(0)
        if row[signal] != 0:
            found[-1] += 1
        before = row[signal]
    return found


# Datagrams that are lost, repeated and late


def test_answers_are_complete_and_commands_act(target: UdpTarget, bad: Path) -> None:
    with client_of(target.port) as client:
        whole = client.description
    with client_of(bad) as client:
        assert client.description == whole
        for number in range(20):
            assert client.command(f"set Pan\\PID\\kp={number + 0.5}") == ["ok set"]
            assert client.parameters()[[p.name for p in whole.parameters].index("Pan\\PID\\kp")].value == number + 0.5
        assert client.command("capture position_pan setpoint_pan rows=500") == ["ok capture rows=500"]
        let_pass(client, 0.7)
        recorded = [line for line in client.command("capture read") if line.startswith("csv ")]
        times = [float(line.removeprefix("csv ").split(",")[0]) for line in recorded[1:]]
        assert len(times) == 500 and times == sorted(times)
        assert client.damaged == 0
    target.end()


def test_gaps_of_rows_are_counted(target: UdpTarget, bad: Path) -> None:
    got: list[Rows] = []
    with client_of(bad) as client:
        count = len(client.description.streamed)
        client.start_stream(range(count), 1, got.append)
        until(lambda: got and got[-1].number > 2000)
        client.stop_stream()
    stream = Stream([str(number) for number in range(count)], PERIOD)
    rows = [row for each in got for row in stream.take(each)]
    assert [round(before.time - after.time, 6) for after, before in pairwise(rows) if before.time <= after.time] == []
    last = got[-1].number + len(got[-1].values) // count
    assert stream.rows + stream.dropped == last - got[0].number
    assert 0.1 * last < stream.dropped < 0.5 * last
    target.end()


def test_a_jog_is_never_repeated(target: UdpTarget, bad: Path) -> None:
    with client_of(bad) as client:
        client.disable()
        let_pass(client, 0.5)
        for _ in range(5):
            assert client.command("jog pwm_pan 0.1 50")[-1] == "ok jog"
        let_pass(client, LATE + 0.2)
        assert client.command("jog pwm_pan 0.1 50")[-1] == "ok jog"
        let_pass(client, LATE + 0.2)
    trace = target.end()
    disabled = next(index for index, row in enumerate(trace) if not row["enabled"])
    assert pulses(trace[disabled + 1 :], DUTY) == [50] * 6


def test_a_movement_by_hand_ends_with_the_last_command(target: UdpTarget, bad: Path) -> None:
    with client_of(bad) as client:
        client.disable()
        for _ in range(20):
            client.move("pwm_pan", 0.1)
            time.sleep(0.05)  # the period of the page's commands
        released = time.monotonic()  # the release, compared with the target's time
        let_pass(client, LATE + 0.3)
    tick = tick_of(target.port)
    trace = target.end()
    disabled = next(index for index, row in enumerate(trace) if not row["enabled"])
    again = next(index for index, row in enumerate(trace) if index > disabled and row["enabled"])
    moving = [row["time"] for row in trace[disabled + 1 : again] if row[DUTY] != 0]
    assert moving[0] < moving[-1] <= released + LEASE + PERIOD - begin_of(trace, tick)


def test_disable_always_acts_and_nothing_enables_afterwards(target: UdpTarget, bad: Path) -> None:
    with client_of(bad) as client:
        client.disable()
        for _ in range(10):
            with contextlib.suppress(CommandRefused):  # a target that the loss of numbers has disabled meanwhile
                client.enable()
            client.disable()
            assert "enabled=0" in client.command("stats")[0]
        let_pass(client, LATE + 0.2)
        assert "enabled=0" in client.command("stats")[0], "an old 'enable' has arrived meanwhile"
    target.end()


def test_a_lease_holds_or_ends_safely(target: UdpTarget, bad: Path) -> None:
    """The network can lose all messages of one lease, but hardly those of the first lease of four enablings."""
    with client_of(bad) as client:
        client.disable()
        for _ in range(4):
            with contextlib.suppress(CommandRefused):  # the loss of the answer's number has disabled the target
                client.enable()
            let_pass(client, 1)
            state = client.command("stats")[0]
            assert "enabled=1 leased=1 fault=none" in state or "enabled=0 fault=operator" in state, state
            client.disable()
    trace = target.end()
    disabled = list(dropwhile(lambda row: row["enabled"], trace))
    assert max(pulses(disabled, "enabled")) > 350, "it stays enabled for longer than one lease"
    assert all(row[DUTY] == 0 for row in disabled if not row["enabled"])


def test_a_network_that_loses_everything_is_noticed(target: UdpTarget) -> None:
    command = [sys.executable, "-m", "tests.doubles.network.relay", str(target.number), "0", "0"]
    told: list[str] = []
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as relay:
        assert relay.stdout is not None
        port = f"udp:{int(relay.stdout.readline())}"
        with client_of(Path(port)) as client:
            client._told = told.append
            client.disable()
            client.enable()
            relay.send_signal(signal.SIGSTOP)
            with pytest.raises(Lost):
                client.command("set Pan\\PID\\kp=1")
            client._over.wait(5)
            assert told[-1] == f"lost {port} does not answer any more"
        relay.kill()
    trace = target.end()
    assert (trace[-1]["enabled"], trace[-1]["fault"], trace[-1][DUTY]) == (0, OPERATOR, 0)


# Clients that fail


# Two computers


def ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True, capture_output=True)


@pytest.fixture
def computers() -> Iterator[tuple[str, str]]:
    """Two network namespaces with the addresses 10.77.0.1 and fd77::1, and 10.77.0.2 and fd77::2."""
    if os.geteuid() != 0:
        pytest.skip("EPG: network namespaces need root")
    robot, desk = (f"epg_{name}_{os.getpid()}" for name in ("robot", "desk"))
    try:
        ip("netns", "add", robot)
    except (OSError, subprocess.CalledProcessError) as error:
        pytest.skip(f"EPG: network namespaces cannot be made here: {error}")
    try:
        ip("netns", "add", desk)
        ip("link", "add", "wire1", "netns", robot, "type", "veth", "peer", "name", "wire2", "netns", desk)
        for name, wire, number in ((robot, "wire1", 1), (desk, "wire2", 2)):
            ip("-n", name, "address", "add", f"10.77.0.{number}/24", "dev", wire)
            ip("-n", name, "address", "add", f"fd77::{number}/64", "dev", wire, "nodad")
            ip("-n", name, "link", "set", wire, "up")
            ip("-n", name, "link", "set", "lo", "up")
        yield robot, desk
    finally:
        for name in (robot, desk):
            subprocess.run(["ip", "netns", "delete", name], check=False, capture_output=True)


@pytest.mark.parametrize(("address", "nobody"), [("10.77.0.1", "10.77.0.9"), ("[fd77::1]", "[fd77::9]")])
def test_a_robot_is_reached_from_another_computer(
    jiwy_host: Path,
    tmp_path: Path,
    computers: tuple[str, str],
    address: str,
    nobody: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    robot, desk = computers
    target = UdpTarget(jiwy_host, tmp_path, f"{address}:7000", namespace=("ip", "netns", "exec", robot))
    try:
        assert target.said == f"jiwy: the console listens on udp:{address}:7000\n"
        assert target.process.stderr is not None
        key = tmp_path / "key"
        key.write_text(target.process.stderr.readline().rpartition(": ")[2])
        command = [
            "ip",
            "netns",
            "exec",
            desk,
            sys.executable,
            "-m",
            "epg",
            "live",
            "--key",
            str(key),
            str(target.port),
        ]
        arguments = ("--send", "disable", "--send", "enable", "--duration", "1", "--signals", "position_pan")
        done = subprocess.run([*command, *arguments], cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
        assert done.returncode == 0, done.stderr
        assert done.stdout.startswith("ok disable\nok enable\n") and " 0 dropped, 0 damaged frames" in done.stdout
        elsewhere = [*command[:-1], f"udp:{nobody}:7000"]
        done = subprocess.run(elsewhere, cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
        assert done.returncode == 1 and "hint: look at" in done.stderr, done.stderr
    finally:
        target.process.kill()
        target.process.communicate()
