# SPDX-License-Identifier: Apache-2.0
"""The services of a target with the middleware `dds`, called by a client of rmw_cyclonedds: EPG's own peer."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("tests.ros2.packages", exc_type=ImportError)

from tests.ros2.messages import DiagnosticArray_
from tests.ros2.network import Network
from tests.ros2.peer import Client, Peer, user_data
from tests.ros2.test_dds_node import NODE, jiwy, meet, robot

__all__ = ["jiwy"]


def malformed(peer: Peer) -> int:
    """The count of malformed messages in a new message with diagnostics."""
    diagnostics = peer.subscription("/diagnostics", DiagnosticArray_)
    assert peer.spin_until(lambda: len(diagnostics.received) >= 2)
    values = {pair.key: pair.value for pair in diagnostics.messages[-1].status[0].values}
    return int(values["malformed"])


def client(peer: Peer, name: str, type_: str) -> Client:
    return peer.client(f"{NODE}/{name}", type_)


def test_enable_and_reset_answer(jiwy: Path, net: Network, tmp_path: Path) -> None:
    with robot(net, jiwy, tmp_path), Peer(net.domain, "tool") as peer:
        enable, reset = client(peer, "enable", "std_srvs/srv/SetBool"), client(peer, "reset", "std_srvs/srv/Trigger")
        replies = [enable.call(False), reset.call(0), enable.call(True), reset.call(0)]
        assert [(reply.success, reply.message) for reply in replies] == [
            (True, "disabled"),
            (True, "disabled, without a fault"),
            (True, "enabled"),
            (True, "enabled"),
        ]


def test_both_endpoints_of_a_service_belong_to_the_node(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """rmw_cyclonedds regards a service as available if the reader and the writer have the same `serviceid`."""
    with robot(net, jiwy, tmp_path), Peer(net.domain, "monitor") as peer:
        meet(peer)
        ids = {}
        for samples, which in ((peer.graph.readers, "reader_gid_seq"), (peer.graph.writers, "writer_gid_seq")):
            for gid, sample in samples.items():
                if sample.topic_name.startswith(("rq/", "rr/")):
                    assert peer.graph._owner(gid, which) == NODE
                    ids[sample.topic_name] = user_data(sample.qos)["serviceid"]
        assert ids[f"rq{NODE}/enableRequest"] == ids[f"rr{NODE}/enableReply"]
        assert ids[f"rq{NODE}/resetRequest"] == ids[f"rr{NODE}/resetReply"]
        assert len(set(ids.values())) == 2


def test_requests_of_two_clients_are_answered_one_after_the_other(jiwy: Path, net: Network, tmp_path: Path) -> None:
    with robot(net, jiwy, tmp_path), Peer(net.domain, "one") as peer:
        clients = [client(peer, "reset", "std_srvs/srv/Trigger") for _ in range(3)]
        assert all(c.wait_for_service() for c in clients)
        peer.spin(0.3)
        sent = [(c, c.send(0)) for _ in range(3) for c in clients]
        assert all(c.reply(number).success for c, number in sent)


def test_a_request_without_the_header_of_rmw_cyclonedds_is_malformed(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """A client without `clientid` is another implementation's, whose header is not in the request."""
    with robot(net, jiwy, tmp_path), Peer(net.domain, "tool") as peer:
        foreign = peer.client(f"{NODE}/enable", "std_srvs/srv/SetBool", identified=False)
        assert foreign.wait_for_service()
        peer.spin(0.3)
        numbers = [foreign.send(False) for _ in range(30)]
        assert foreign.reply(numbers[-1], timeout=1.0) is None
        assert malformed(peer) >= 10  # the reader keeps the last ten
        assert client(peer, "enable", "std_srvs/srv/SetBool").call(True).success
