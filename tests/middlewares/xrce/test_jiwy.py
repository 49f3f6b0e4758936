"""JIWY follows setpoints from the agent's side, in real time, and is indifferent to the agent's fate."""

from __future__ import annotations

import math
import subprocess
import time
from pathlib import Path

from tests.xrce_agent import Agent, float64, read_float64

HOMED = 3.5
"""Seconds after which both axes have found their end stops."""


def follow(agent: Agent, seconds: float) -> float:
    """Pan goes to and fro by 0.4 rad in 4 s; the largest distance between setpoint and position, in rad."""
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


def test_it_tracks_over_a_restart_of_the_agent(jiwy: Path, agent: Agent, tmp_path: Path) -> None:
    command = [str(jiwy), "--realtime", "--quiet", "--agent", agent.address]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            agent.topics.wait_for_sample("rt/pan_publisher")
            agent.topics.publish("rt/pan_subscriber", float64(0.5), reliable=False)
            time.sleep(HOMED)
            assert follow(agent, 4.5) < 0.12
            agent.restart(0.5)
            agent.topics.wait_for_reader("rt/pan_subscriber")
            agent.topics.wait_for_sample("rt/pan_publisher")
            assert follow(agent, 4.5) < 0.12
            process.terminate()
            output, errors = process.communicate(timeout=20)
            assert (process.returncode, output + errors) == (130, "")
        finally:
            process.kill()
