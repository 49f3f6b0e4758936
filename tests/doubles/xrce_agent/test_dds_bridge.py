# SPDX-License-Identifier: Apache-2.0
"""A client's topics appear on DDS, and the topics of a DDS peer at the client."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.doubles.xrce_agent import Agent, UdpLink

pytest.importorskip("tests.doubles.ros2_peer.packages", exc_type=ImportError)

from tests.doubles.ros2_peer.messages import Float64_, numbers
from tests.doubles.ros2_peer.peer import Peer
from tests.doubles.xrce_agent.dds_bridge import DdsBridge
from tests.ros2.network import network


def test_a_client_and_a_peer_talk(client_program: Path) -> None:
    with (
        network() as net,
        Agent(UdpLink()) as agent,
        DdsBridge(agent.topics, net.domain),
        Peer(net.domain, "m") as peer,
    ):
        pongs, pings = peer.subscription("/pong", Float64_), peer.publisher("/ping", Float64_)
        process = subprocess.Popen([str(client_program), f"udp:{agent.address}"], stdout=subprocess.DEVNULL)
        try:
            assert peer.spin_until(lambda: pings.matched == 1 and len(peer.graph.writers) > 1)
            agent.wait_until(lambda: any(client.readings for client in agent.clients.values()))
            for number in range(20):
                pings.publish(Float64_(float(number)))
                peer.spin(0.005)
            assert peer.spin_until(lambda: len(pongs.messages) == 20)
            assert numbers(pongs.messages) == list(range(20))
        finally:
            process.kill()
            process.wait()
        agent.kill()
        assert peer.spin_until(lambda: pings.matched == 0)
