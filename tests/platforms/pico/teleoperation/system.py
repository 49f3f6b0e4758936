# SPDX-License-Identifier: Apache-2.0
"""Several emulated Picos and their agents in one simulated time: equal runs are equal to the cycle.

Each board has its agent, as `epg launch` starts them.  The agents share their topics, as agents on one DDS network do.
An agent handles a frame at the time at which it arrives; of frames at the same time, that of the first board comes
first.  What the agents then send is given to USB after `delay`, which stands for the time of agents and network.

The boards take turns in slices of this delay.  No frame of a slice can reach a board within the same slice, so that the
boards need not wait for each other within it.

>>> # with System([Member(leader_elf), Member(follower_elf, drift=500)]) as system:
>>> #     system.run(500)
>>> #     system.members[1].emulator.call("motor_state", name="pan")
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND, Emulator
from tests.doubles.xrce_agent.topics import Topics
from tests.platforms.pico.xrce.agent import BoardAgent, Said, UsbLink

DELAY = 0.25
"""Milliseconds from a frame of a board at its agent to the frames that follow from it at the USB of the boards."""
BILLION = 10**9


@dataclass(frozen=True)
class Clock:
    """The clock of a board that runs fast by ``drift`` parts per 10^9.  Times of the system are in cycles of 8 ns."""

    drift: int = 0

    def cycle_at(self, time: int) -> int:
        """The cycle of the board at a time of the system."""
        return time * (BILLION + self.drift) // BILLION

    def time_of(self, cycle: int) -> int:
        """The first time of the system at which the board has reached a cycle."""
        return -(-cycle * BILLION // (BILLION + self.drift))


class FrameLink(UsbLink):
    """A serial port whose bytes come from the system, and which sends at a time that the system says."""

    def __init__(self, pico: Emulator, due: Callable[[], int]) -> None:
        super().__init__(pico)
        self._due = due
        self._arrived = b""

    def arrive(self, data: bytes) -> None:
        self._arrived += data

    def receive(self) -> list[tuple[Any, bytes]]:
        data, self._arrived = self._arrived, b""
        return [*self._deframer.feed(data)]

    def send_raw(self, peer: Any, data: bytes) -> None:
        if self.is_open:
            self._pico.send(data, port=self._port, at=self._due())


class Member:
    """A board of the system.  ``seed`` sets the times of packets on its USB; ``drift`` is in parts per 10^9."""

    def __init__(self, elf: Path, *, seed: int = 1, drift: int = 0) -> None:
        self.clock = Clock(drift)
        # The host's frames have the time of the system, so that the host seems slow to a board with a fast clock.
        usb = {"seed": seed, "phase": 137 * seed, "clock_error": -drift / 1000, "open": False}
        self.emulator = Emulator(elf, usb=usb)

    def run(self, until: int) -> list[tuple[int, bytes]]:
        """Runs up to a time of the system; returns the packets for the agent, each with its time."""
        end = self.clock.cycle_at(until)
        packets = []
        while self.emulator.cycle < end:
            self.emulator.run(until=end, data=True)
            data = self.emulator.receive_bytes()
            if data:
                packets.append((min(until, self.clock.time_of(self.emulator.cycle)), data))
        return packets


class System:
    """The boards, each on its USB and with its agent.  ``cycle`` is the time, in cycles of 8 ns."""

    def __init__(self, members: Sequence[Member], delay: float = DELAY) -> None:
        """``delay`` in milliseconds, more than 0."""
        self.cycle = 0
        self.members = members
        self._delay = round(delay * CYCLES_PER_MILLISECOND)
        assert self._delay > 0
        self._pool = ThreadPoolExecutor(len(members))
        self._agents: list[BoardAgent] = []
        self._links: list[FrameLink] = []
        self.topics = Topics()
        self.said: list[Said] = []
        """The messages of all boards, at the times at which they arrived at an agent."""
        self.topics.taps.append(lambda writer, data: self.said.append(Said(self.now(), writer.topic, data)))

    def connect(self) -> None:
        """Starts the agents.  Before this, each board must have had the time to appear on USB."""
        for number, member in enumerate(self.members):
            assert member.emulator.call("usb")["state"] == "configured"
            link = FrameLink(member.emulator, lambda clock=member.clock: clock.cycle_at(self.cycle + self._delay))  # type: ignore[misc]
            self._links.append(link)
            self._agents.append(BoardAgent(self, link, seed=number, topics=self.topics))

    def __enter__(self) -> System:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._pool.shutdown()
        for agent in self._agents:
            agent.close()
        for member in self.members:
            member.emulator.close()

    def now(self) -> float:
        """The time in seconds."""
        return self.cycle / (1000 * CYCLES_PER_MILLISECOND)

    def run(self, milliseconds: float, **_: Any) -> None:
        end = self.cycle + round(milliseconds * CYCLES_PER_MILLISECOND)
        while self.cycle < end:
            self._slice(min(end, self.cycle + self._delay))

    def _slice(self, until: int) -> None:
        taken = self._pool.map(lambda member: member.run(until), self.members)
        packets = [(time, number, data) for number, some in enumerate(taken) for time, data in some]
        for time, number, data in sorted(packets, key=lambda packet: packet[:2]):
            self.cycle = time
            if self._links:
                self._links[number].arrive(data)
                self._agents[number].turn()
        self.cycle = until
        for agent in self._agents:
            agent.turn()

    def run_until(self, condition: Callable[[], bool], milliseconds: float) -> None:
        """Runs until ``condition`` is true; fails after this time."""
        left = math.ceil(milliseconds)
        while not condition():
            assert left > 0, f"not within {milliseconds} ms; {[agent.tail(5) for agent in self._agents]}"
            self.run(1)
            left -= 1
