# SPDX-License-Identifier: Apache-2.0
"""JIWY on boards in QEMU as a ROS 2 node, whose agent is on a UART."""

from __future__ import annotations

import pytest

from tests.doubles.xrce_agent import Agent, float64, read_float64

from .free_running import FreeRunning
from .socket_link import SocketLink


def position(board: FreeRunning, agent: Agent, setpoint: float) -> float:
    """The newest position that the agent has received, after the setpoint was sent for two seconds."""
    for _ in range(20):
        agent.topics.publish("rt/pan_subscriber", float64(setpoint), reliable=False)
        board.let_pass(100)
    count = len(agent.topics.samples("rt/pan_publisher"))
    agent.wait_until(lambda: len(agent.topics.samples("rt/pan_publisher")) > count)
    return read_float64(agent.topics.samples("rt/pan_publisher")[-1].data)


def test_it_is_a_node_of_an_agent(board: FreeRunning) -> None:
    """Setpoints arrive, positions come back, also from an agent that has restarted."""
    with Agent(SocketLink(board.agent)) as agent:
        agent.topics.wait_for_reader("rt/pan_subscriber")
        board.console.ask("enable")
        board.let_pass(1500)  # homing
        assert position(board, agent, 0.5) == pytest.approx(0.5, abs=0.02)
        agent.restart(0.5)
        agent.topics.wait_for_reader("rt/pan_subscriber")
        assert position(board, agent, 1.0) == pytest.approx(1.0, abs=0.02)
        state = board.order("?")
        assert (state.missed, state.overruns, state.fault) == (0, 0, 0)
        assert "stat reconnects=1" in board.console.ask("stats")
