# SPDX-License-Identifier: Apache-2.0
"""Races between stops and enables whose order is known: whatever is read when, the last of them counts.

Bytes that were written to a terminal have arrived.  In some rounds the program stands still, so that all of them wait.
"""

from __future__ import annotations

import os
import random
import select
import signal
import time
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from epg.live.frames import Decoder, encode
from tests.live.target import Target
from tests.waiting import until

from .client import Lines, stat

TEXTS = ["enable\n", "disable\n"]


@pytest.fixture
def target(jiwy_host: Path, tmp_path: Path) -> Iterator[Target]:
    found = Target(jiwy_host, tmp_path)
    yield found
    found.process.kill()
    found.process.communicate()


@contextmanager
def terminal(target: Target) -> Iterator[int]:
    """The terminal of a target."""
    file = os.open(target.port, os.O_RDWR | os.O_NOCTTY)
    try:
        tty.setraw(file)
        yield file
    finally:
        os.close(file)


@contextmanager
def perhaps_held(target: Target, held: bool) -> Iterator[None]:
    """The program stands still while the body runs."""
    if held:
        os.kill(target.process.pid, signal.SIGSTOP)
        os.waitid(os.P_PID, target.process.pid, os.WSTOPPED)
    yield
    if held:
        os.kill(target.process.pid, signal.SIGCONT)


class Program:
    """A program that uses frames."""

    def __init__(self, file: int) -> None:
        self._file = file
        self._decoder = Decoder()

    def send(self, line: str, tag: int) -> None:
        os.write(self._file, encode(b"C" + bytes([tag]) + line.encode()))

    def stats(self) -> str:
        """The first line of the answer to ``stats``."""
        self.send("stats", 7)
        lines: list[str] = []

        def answered() -> bool:
            if select.select([self._file], [], [], 0.5)[0]:
                for message in self._decoder.feed(os.read(self._file, 65536)):
                    if isinstance(message, bytes) and message[:2] == b"A\7":
                        lines.append(message[2:].decode())
            return any(line.startswith("ok stats") for line in lines)

        until(answered, lambda: f"no answer after {lines}", pause=0.0)
        return lines[0]


@pytest.mark.parametrize("rounds", [200, 1000])
def test_the_last_line_counts(target: Target, rounds: int) -> None:
    chance = random.Random(rounds)
    with terminal(target) as file:
        console = Lines(file, file)
        for number in range(rounds):
            lines = [*chance.choices(TEXTS, k=chance.randint(1, 5)), TEXTS[number % 2]]
            with perhaps_held(target, chance.random() < 0.2):
                for line in lines:
                    console.send(line)
                    time.sleep(chance.choice([0.0, 0.0, 0.001, 0.003]))  # any phase of the control cycle
            answer = [line for line in console.ask("stats") if line.startswith("stat enabled=")]
            assert stat(answer, "enabled") == "01"[TEXTS[number % 2] == "enable\n"], (number, lines)


@pytest.mark.parametrize("rounds", [200, 1000])
def test_the_last_frame_counts(target: Target, rounds: int) -> None:
    """A program's enable names the newest stop that it knows, so that one after another stop is refused."""
    chance = random.Random(rounds)
    with terminal(target) as file:
        program = Program(file)
        for number in range(rounds):
            known = stat([program.stats()], "stop")
            with perhaps_held(target, chance.random() < 0.2):
                program.send(f"enable unattended after={known}", 1)
                time.sleep(chance.choice([0.0, 0.0, 0.001, 0.003]))  # any phase of the control cycle
                program.send("disable", 2)
                if number % 2:
                    program.send(f"enable unattended after={known}", 3)
            assert stat([program.stats()], "enabled") == "0", number
        known = stat([program.stats()], "stop")
        program.send(f"enable unattended after={known}", 1)
        assert stat([program.stats()], "enabled") == "1"
