# SPDX-License-Identifier: Apache-2.0
"""Many restarts of the agent."""

from __future__ import annotations

import statistics
from pathlib import Path

import pytest

from tests.doubles.xrce_agent import Agent

from .reconnecting import check, reconnect


@pytest.mark.parametrize(("count", "warm"), [(30, 5), (1000, 20)])
def test_restarts_of_the_agent(robot: Path, agent: Agent, count: int, warm: int) -> None:
    account = reconnect(robot, agent, count)
    middle, largest = statistics.median(account.latency), max(account.latency)
    grown = account.memory[-1] - account.memory[warm]
    print(f"latency median {middle:.3f} s, largest {largest:.3f} s; memory grown by {grown >> 10} KiB")
    check(account, warm)
    assert middle < 1.0
