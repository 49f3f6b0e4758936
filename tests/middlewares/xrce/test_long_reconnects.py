# SPDX-License-Identifier: Apache-2.0
"""A thousand restarts of the agent."""

from __future__ import annotations

import statistics
from pathlib import Path

from tests.xrce_agent import Agent

from .reconnecting import check, reconnect


def test_a_thousand_restarts_of_the_agent(robot: Path, agent: Agent) -> None:
    account = reconnect(robot, agent, 1000)
    quantiles = statistics.quantiles(account.latency, n=100)
    grown = account.memory[-1] - account.memory[20]
    print(
        f"latency median {statistics.median(account.latency):.3f} s, 99% {quantiles[98]:.3f} s, "
        f"largest {max(account.latency):.3f} s; memory {account.memory[20] >> 10} KiB, grown by {grown >> 10} KiB; "
        f"descriptors {account.descriptors[-1]}"
    )
    check(account, warm=20)
