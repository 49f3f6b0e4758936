# SPDX-License-Identifier: Apache-2.0
"""JIWY follows setpoints from the agent in real time, and a fault of the agent does not affect its control loop."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path

from tests.doubles.xrce_agent import Agent, float64
from tests.middlewares.xrce.follow import follow

from .board import without_connection

HOMED = 3.5
"""Seconds after which both axes have found their end stops."""


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
            assert (process.returncode, output + without_connection(errors)) == (130, "")
        finally:
            process.kill()
