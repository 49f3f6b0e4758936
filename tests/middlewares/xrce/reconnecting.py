# SPDX-License-Identifier: Apache-2.0
"""A board that must connect many times, and its use of memory, descriptors and time."""

from __future__ import annotations

import statistics
from dataclasses import dataclass, field
from pathlib import Path

from tests.doubles.xrce_agent import Agent
from tests.waiting import until

from .board import Board


@dataclass
class Account:
    """For each turn: resident bytes, open descriptors, and seconds from the agent's start to the first sample."""

    memory: list[int] = field(default_factory=list)
    descriptors: list[int] = field(default_factory=list)
    latency: list[float] = field(default_factory=list)


def reconnect(robot: Path, agent: Agent, count: int) -> Account:
    """Restarts the agent ``count`` times; asserts that each restart was counted and that the loop has continued."""
    account = Account()
    with Board(robot, agent) as board:
        board.running()
        first_time, first = board.timed("cycles_too")[-1]
        for turn in range(count):
            agent.topics.clear()
            agent.log.clear()
            agent.restart()
            account.latency.append(board.running())
            value = turn / 1024

            def arrived(value: float = value) -> bool:
                board.set("reliable", value)
                return board.values("got_reliable")[-1:] == [value]

            until(arrived, lambda turn=turn: f"no setpoint arrives in turn {turn}:\n{agent.tail()}", pause=0.005)
            account.memory.append(board.memory())
            account.descriptors.append(board.descriptors())
        agent.wait_until(lambda: board.statistic("reconnects") == count)
        last_time, last = board.timed("cycles_too")[-1]
        missed = board.statistic("missed")
        assert abs(last + missed - first - (last_time - first_time) * 1000) < 100
        assert board.stop() == ""
    return account


def check(account: Account, warm: int) -> None:
    """Asserts that memory and descriptors do not grow after the first ``warm`` turns."""
    assert max(account.memory[warm:]) - account.memory[warm] <= 256 * 1024
    assert set(account.descriptors[warm:]) == {account.descriptors[warm]}
    half = (len(account.latency) + warm) // 2
    before, after = statistics.median(account.latency[warm:half]), statistics.median(account.latency[half:])
    assert after < 1.5 * before + 0.05, (before, after)
