# SPDX-License-Identifier: Apache-2.0
"""JIWY driven from the agent's side, in real time, which the publications of the board tell."""

from __future__ import annotations

import math

from tests.doubles.xrce_agent import Agent, float64, read_float64

PERIOD = 0.033
"""Seconds from one publication of JIWY to the next."""


def follow(agent: Agent, seconds: float) -> float:
    """Moves pan by 0.4 rad to each side in 4 s; the largest difference between setpoint and position, in rad."""
    largest, since = 0.0, agent.topics.count
    now = 0.0
    while now < seconds:
        setpoint = 0.5 + 0.4 * math.sin(2 * math.pi * now / 4)
        agent.topics.publish("rt/pan_subscriber", float64(setpoint), reliable=False)
        position = read_float64(agent.topics.wait_for_sample("rt/pan_publisher").data)
        largest = max(largest, abs(position - setpoint)) if now > 0.5 else 0.0
        now = PERIOD * len(agent.topics.samples("rt/pan_publisher", since))
    return largest
