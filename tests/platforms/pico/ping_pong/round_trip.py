# SPDX-License-Identifier: Apache-2.0
"""Round trips of a Float64 through ``examples/ping_pong`` on an emulated Pico, in simulated time.

>>> # images = programs("bare_metal")
>>> # with Board(images["best", "best"], ("best", "best")) as board:
>>> #     board.measure(rate=30.0, count=100).times     # seconds

A time begins when the agent hands the ping to USB, and ends when the pong has arrived there.  It contains the host's
packets, the board's poll of its communication, the echo, and the way back; no operating system, agent process or DDS.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Iterable
from pathlib import Path

from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.toolchain import ROOT
from tests.doubles.xrce_agent.messages import float64, read_float64
from tests.platforms.pico.xrce.agent import BoardAgent

EXAMPLE = "examples/ping_pong"
sys.path.insert(0, str(ROOT / EXAMPLE / "peer"))

from summary import Run, head, rows, summarise, table  # noqa: E402  # of the example

__all__ = ["COMBINATIONS", "QOS", "Board", "Combination", "Run", "head", "programs", "rows", "summarise", "table"]

QOS = {"default": True, "best": False}
"""The names of QoS in the example's programs; True if reliable."""
Combination = tuple[str, str]
"""The QoS of the publisher of /pong and of the subscriber of /ping."""
COMBINATIONS: tuple[Combination, ...] = tuple((publisher, subscriber) for publisher in QOS for subscriber in QOS)
PATIENCE = 500
"""Milliseconds after which a ping counts as lost."""


def programs(platform: str, combinations: Iterable[Combination] = COMBINATIONS) -> dict[Combination, Path]:
    """The example's images for a Pico; SDK and compiler must be installed."""
    target = f"rpi_pico_{platform}"
    names = {each: f"ping_pong_{each[0]}_{each[1]}_{target}" for each in combinations}
    folder = build(EXAMPLE, targets=sorted(names.values()), variables={"PING_PONG_TARGET": target})
    return {each: folder / f"{name}.elf" for each, name in names.items()}


class Board:
    """A Pico with one of the images, connected to its agent; ``seed`` sets phase and packet times of the USB host."""

    def __init__(self, image: Path, combination: Combination, seed: int = 1) -> None:
        self._reliable = QOS[combination[1]]
        self._draw = random.Random(seed)
        usb = {"seed": seed, "phase": self._draw.uniform(0, 1000), "clock_error": self._draw.uniform(-500, 500)}
        self.pico = Emulator(image, usb={**usb, "open": False})
        self.pico.run(milliseconds=40)
        self.agent = BoardAgent(self.pico)
        self.agent.topics.taps.append(lambda writer, data: self._take(writer.topic, data))
        self._pongs: dict[float, float] = {}
        self._count = 0
        while not self._one():  # until the node on the board answers
            assert self.agent.now() < 3, f"no answer; {self.agent.tail()}"

    def __enter__(self) -> Board:
        return self

    def __exit__(self, *_: object) -> None:
        self.agent.close()
        self.pico.close()

    def burst(self, count: int) -> list[float]:
        """The answers, in their order, to ``count`` pings that are sent together."""
        self._pongs.clear()
        for number in range(1, count + 1):
            self.agent.topics.publish("rt/ping", float64(number), reliable=self._reliable)
        self.agent.run_until(lambda: len(self._pongs) == count, PATIENCE)
        return list(self._pongs)

    def _take(self, topic: str, data: bytes) -> None:
        if topic == "rt/pong":
            self._pongs[read_float64(data)] = self.agent.now()

    def _one(self) -> float | None:
        """Seconds of a round trip; None if there is no answer."""
        self._count += 1
        number = float(self._count)
        begin = self.agent.now()
        self.agent.topics.publish("rt/ping", float64(number), reliable=self._reliable)
        if not self.agent.run_until(lambda: number in self._pongs, PATIENCE):
            return None
        return self._pongs[number] - begin

    def measure(self, rate: float, count: int, label: str = "") -> Run:
        """Sends ``count`` pings: at random times with about ``rate`` in Hz; if 0, each after the last answer."""
        times = []
        for _ in range(count):
            time = self._one()
            if time is not None:
                times.append(time)
            if rate > 0.0:
                self.agent.run(1000 / rate * self._draw.uniform(0.9, 1.1) - 1000 * (time or 0.0))
        return Run(label, times, count - len(times))
