# SPDX-License-Identifier: Apache-2.0
"""JIWY driven from the agent's side, in real time."""

from __future__ import annotations

import math
import time

from tests.doubles.xrce_agent import Agent, float64, read_float64


def follow(agent: Agent, seconds: float) -> float:
    """Moves pan by 0.4 rad to each side in 4 s; the largest difference between setpoint and position, in rad."""
    largest = 0.0
    began = time.monotonic()
    while (now := time.monotonic() - began) < seconds:
        setpoint = 0.5 + 0.4 * math.sin(2 * math.pi * now / 4)
        agent.topics.publish("rt/pan_subscriber", float64(setpoint), reliable=False)
        positions = agent.topics.samples("rt/pan_publisher", began)
        if now > 0.5 and positions:
            largest = max(largest, abs(read_float64(positions[-1].data) - setpoint))
        time.sleep(0.01)
    return largest
