# SPDX-License-Identifier: Apache-2.0
"""Thirty restarts of the agent; test_long_reconnects.py has a thousand."""

from __future__ import annotations

import statistics
from pathlib import Path

from tests.xrce_agent import Agent

from .reconnecting import check, reconnect


def test_thirty_restarts_of_the_agent(robot: Path, agent: Agent) -> None:
    account = reconnect(robot, agent, 30)
    check(account, warm=5)
    assert statistics.median(account.latency) < 1.0
