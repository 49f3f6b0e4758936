# SPDX-License-Identifier: Apache-2.0
"""Stopping and enabling by UDP, as close together as possible, with a real target.

On the loopback, a datagram has arrived when its sending returns, so each trial knows the order in which they arrived.
Some of them arrive while the program stands still.  A trial whose last request is a stop must end disabled.  One whose
last request is to enable must end enabled, unless the target had a fault, such as overruns on a busy computer.
"""

from __future__ import annotations

import os
import random
import signal
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from epg.live.client import Client, words_of
from epg.live.frames import encode

from .target import client_of
from .test_udp import Person
from .udp_target import UdpTarget

HELD = 0.02  # seconds
QUIET = 0.012  # seconds of control time after which all requests have acted
STOP = "disable"


class TextUser:
    """A person who uses the target."""

    def __init__(self, target: UdpTarget) -> None:
        self._person = Person(target)
        self._person.ask("version", "ok version")

    def request(self, chance: random.Random, stops: bool) -> None:
        self._person.socket.send(b"disable\n" if stops else b"enable\n")

    def enable_after_newest(self) -> None:
        self._person.socket.send(b"enable\n")

    def state(self) -> dict[str, str]:
        lines = self._person.ask("stats", "ok stats").splitlines()
        return dict(words_of(next(line for line in lines if line.startswith("stat enabled="))))


class FrameUser:
    """A program that uses the target."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._newest = self.state()["stop"]

    def request(self, chance: random.Random, stops: bool) -> None:
        boot, _, number = self._newest.partition("-")  # one of the next stops, as if this program knew it
        line = STOP if stops else f"enable unattended after={boot}-{int(number) + chance.randrange(3)}"
        self._send(line)

    def enable_after_newest(self) -> None:
        self._send(f"enable unattended after={self.state()['stop']}")

    def state(self) -> dict[str, str]:
        state = dict(words_of(self._client.command("stats")[0]))
        self._newest = state["stop"]
        return state

    def _send(self, line: str) -> None:
        self._client._port.write(encode(b"C\0" + line.encode()))


@contextmanager
def text_user(target: UdpTarget) -> Iterator[TextUser]:
    yield TextUser(target)


@contextmanager
def frame_user(target: UdpTarget) -> Iterator[FrameUser]:
    with client_of(target.port) as client:
        yield FrameUser(client)


def settled(user: TextUser | FrameUser) -> dict[str, str]:
    """The state after all that was sent has acted."""
    begin = float(user.state()["time"])
    while True:
        state = user.state()
        if float(state["time"]) > begin + QUIET:
            return state


def race(target: UdpTarget, user: TextUser | FrameUser, count: int, held: bool) -> None:
    chance = random.Random(count + held)
    other = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    other.connect(("127.0.0.1", target.number))
    stop_of_program = b"\x01EPG" + bytes([4]) + bytes(16)
    pauses: tuple[Callable[[], float], ...] = (lambda: 0.0, lambda: 0.0, lambda: chance.uniform(0, 0.003))
    faults = 0
    enabled = 0
    for trial in range(count):
        requests = [chance.choice(("enable", "enable", "own stop", "stop")) for _ in range(chance.randrange(2, 7))]
        begin, end = sorted(chance.randrange(len(requests) + 1) for _ in range(2))
        for index, request in enumerate(requests):
            if held and index == begin:
                os.kill(target.process.pid, signal.SIGSTOP)
            if held and index == end and begin < end:
                time.sleep(HELD)
                os.kill(target.process.pid, signal.SIGCONT)
            if request == "stop":
                other.send(chance.choice((b"disable\n", stop_of_program)))
            else:
                user.request(chance, request == "own stop")
            time.sleep(chance.choice(pauses)())
        if held and begin < len(requests) <= max(begin + 1, end):
            time.sleep(HELD)
        os.kill(target.process.pid, signal.SIGCONT)
        if requests[-1] != "enable":
            state = settled(user)
            assert state["enabled"] == "0", (trial, requests, begin, end, state)
            continue
        if isinstance(user, FrameUser):  # whether it named the newest stop is chance
            settled(user)
            user.enable_after_newest()
        state = settled(user)
        faults += state["fault"] != "none"
        enabled += state["enabled"] == "1"
        assert state["enabled"] == "1" or state["fault"] != "none", (trial, requests, begin, end, state)
    assert enabled > faults


@pytest.mark.parametrize("held", [False, True], ids=["running", "held"])
@pytest.mark.parametrize("kind", [text_user, frame_user])
def test_nothing_enables_after_the_last_stop(
    jiwy_host: Path, tmp_path: Path, kind: Callable[[UdpTarget], object], held: bool
) -> None:
    run(jiwy_host, tmp_path, kind, 200, held)


@pytest.mark.parametrize("held", [False, True], ids=["running", "held"])
@pytest.mark.parametrize("kind", [text_user, frame_user])
def test_nothing_enables_after_the_last_stop_in_many_trials(
    jiwy_host: Path, tmp_path: Path, kind: Callable[[UdpTarget], object], held: bool
) -> None:
    run(jiwy_host, tmp_path, kind, 1000, held)


def run(program: Path, folder: Path, kind: Callable[[UdpTarget], object], count: int, held: bool) -> None:
    target = UdpTarget(program, folder, duration=3600)
    try:
        with kind(target) as user:  # type: ignore[attr-defined]
            race(target, user, count, held)
    finally:
        target.process.kill()
        target.process.communicate()
