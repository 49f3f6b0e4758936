# SPDX-License-Identifier: Apache-2.0
"""The services of a target with the middleware `dds`, called by a client of rmw_cyclonedds: EPG's own peer."""

from __future__ import annotations

import itertools
import os
import signal
from pathlib import Path

import pytest

pytest.importorskip("tests.doubles.ros2_peer.packages", exc_type=ImportError)

from tests.doubles.ros2_peer.messages import Bool_, DiagnosticArray_, Parameter_, ParameterEvent_, ParameterValue_
from tests.doubles.ros2_peer.peer import Client, Peer, user_data
from tests.ros2.build import Build
from tests.ros2.network import Network
from tests.ros2.test_dds_node import NODE, diagnostics_of, jiwy, meet, meet_and_wait, robot

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
        assert len(ids) == 2 * len(set(ids.values()))


def test_requests_of_two_clients_are_answered_one_after_the_other(jiwy: Path, net: Network, tmp_path: Path) -> None:
    with robot(net, jiwy, tmp_path), Peer(net.domain, "one") as peer:
        clients = [client(peer, "reset", "std_srvs/srv/Trigger") for _ in range(3)]
        assert all(c.wait_for_service() for c in clients)
        peer.spin(0.3)
        sent = [(c, c.send(0)) for _ in range(3) for c in clients]
        assert all(c.reply(number).success for c, number in sent)


def test_a_request_to_disable_does_not_wait_for_replies(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """A request to enable that waits when one to disable arrives never acts."""
    with robot(net, jiwy, tmp_path), Peer(net.domain, "tool") as peer:
        enable, reset = client(peer, "enable", "std_srvs/srv/SetBool"), client(peer, "reset", "std_srvs/srv/Trigger")
        enable.call(True)
        reset.call(0)
        refused = 0
        for _ in range(20):
            first, on, off = reset.send(0), enable.send(True), enable.send(False)
            assert reset.reply(first).success
            reply = enable.reply(on)
            assert reply.success or reply.message == "refused, stopped by service"
            refused += not reply.success
            assert enable.reply(off).message == "disabled"
        assert refused > 0
        assert enable.call(True).message == "enabled"


def test_a_stop_of_the_topic_beside_the_service_is_never_lost(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """In each round, a `false` of the topic races a `true` of the service."""
    rounds = 200
    with robot(net, jiwy, tmp_path) as jiwy_robot, Peer(net.domain, "tool") as peer:
        enable = client(peer, "enable", "std_srvs/srv/SetBool")
        topic = peer.publisher("/robot_7/JIWY_node/enable", Bool_)
        assert meet_and_wait(peer, lambda: topic.matched == 1)
        enable.call(False)
        for number in range(rounds):
            assert enable.call(True).message == "enabled"
            if number % 2:
                topic.publish(Bool_(False))
            sent = enable.send(True)
            if not number % 2:
                topic.publish(Bool_(False))
            reply = enable.reply(sent)
            assert reply.success or reply.message == "refused, stopped by topic"
            peer.spin(0.01)
        jiwy_robot.end()
        driven = [value != 0.0 for value in jiwy_robot.signal("plant.inputs.duty_pan")]
        assert sum(on and not before for before, on in itertools.pairwise(driven)) >= rounds


def test_requests_that_wait_while_the_topic_stops_never_act(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """Each request is in work for some control cycles: when the `false` arrives, others wait in the queue."""
    rounds, requests = 50, 8
    with robot(net, jiwy, tmp_path) as jiwy_robot, Peer(net.domain, "tool") as peer:
        enable, reset = client(peer, "enable", "std_srvs/srv/SetBool"), client(peer, "reset", "std_srvs/srv/Trigger")
        topic = peer.publisher("/robot_7/JIWY_node/enable", Bool_)
        assert meet_and_wait(peer, lambda: topic.matched == 1)
        enable.call(False)
        reset.call(0)
        refused = 0
        for number in range(rounds):
            if number % 2:  # all of them wait for the program
                os.kill(jiwy_robot.process.pid, signal.SIGSTOP)
            sent = [enable.send(True) for _ in range(requests)]
            topic.publish(Bool_(False))
            os.kill(jiwy_robot.process.pid, signal.SIGCONT)
            replies = [enable.reply(each) for each in sent]
            after = list(itertools.dropwhile(lambda reply: reply.success, replies))
            assert [reply.message for reply in after] == ["refused, stopped by topic"] * len(after), number
            refused += len(after)
            assert reset.call(0).message == "disabled, without a fault", number
        assert refused > rounds
        assert enable.call(True).message == "enabled"


def test_a_request_without_the_header_of_rmw_cyclonedds_is_malformed(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """A client without `clientid` is another implementation's, whose header is not in the request.

    The program says so once for each client, and `/diagnostics` names the RMW.
    """
    with robot(net, jiwy, tmp_path) as jiwy_robot, Peer(net.domain, "tool") as peer:
        foreign = peer.client(f"{NODE}/enable", "std_srvs/srv/SetBool", identified=False)
        assert foreign.wait_for_service()
        peer.spin(0.3)
        numbers = [foreign.send(False) for _ in range(30)]
        assert foreign.reply(numbers[-1], timeout=1.0) is None
        assert malformed(peer) >= 10  # the reader keeps the last ten
        told = peer.subscription("/diagnostics", DiagnosticArray_)
        advice = "a client of another RMW gets no reply: run it with RMW_IMPLEMENTATION=rmw_cyclonedds_cpp"
        diagnostics_of(peer, told, lambda values: values["client_advice"] == advice)
        assert client(peer, "enable", "std_srvs/srv/SetBool").call(True).success
        assert (
            jiwy_robot.end().count(
                f"warning: a client of another RMW asks for {NODE}/enable: it gets no reply\n"
                "hint: run it with RMW_IMPLEMENTATION=rmw_cyclonedds_cpp\n"
            )
            == 1
        )


# Parameters

INTEGER, DOUBLE, STRING = 2, 3, 4
KP = "Pan.PID.kp"


def value(number: float, type_: int = DOUBLE) -> object:
    return ParameterValue_(type_, False, int(number) if type_ == INTEGER else 0, number, "", [], [], [], [], [])


def parameter(name: str, number: float, type_: int = DOUBLE) -> object:
    return Parameter_(name, value(number, type_))


def numbers_of(peer: Peer, names: list[str]) -> list[float]:
    return [
        v.double_value for v in client(peer, "get_parameters", "rcl_interfaces/srv/GetParameters").call(names).values
    ]


def test_parameters_are_listed_described_read_and_set(jiwy: Path, net: Network, tmp_path: Path) -> None:
    with robot(net, jiwy, tmp_path), Peer(net.domain, "tool") as peer:
        listed = client(peer, "list_parameters", "rcl_interfaces/srv/ListParameters").call([], 0).result
        assert len(listed.names) == 30
        assert KP in listed.names
        assert sorted(listed.prefixes) == [
            f"{axis}.{part}" for axis in ("Pan", "Tilt") for part in ("Homing", "Limiter", "PID", "Reference")
        ]
        assert client(peer, "get_parameter_types", "rcl_interfaces/srv/GetParameterTypes").call(listed.names).types == (
            [DOUBLE] * 30
        )
        described = client(peer, "describe_parameters", "rcl_interfaces/srv/DescribeParameters").call([KP])
        (found,) = described.descriptors
        assert (found.name, found.type, found.description, found.read_only) == (
            KP,
            DOUBLE,
            "gain of the pan axis",
            False,
        )
        (limits,) = found.floating_point_range
        assert (limits.from_value, limits.to_value, limits.step) == (0.0, 20.0, 0.0)
        assert numbers_of(peer, [KP]) == [2.6]

        events = peer.subscription("/parameter_events", ParameterEvent_)
        assert peer.spin_until(lambda: bool(events.reader.get_matched_publications()))
        peer.spin(0.3)
        wanted = [parameter(KP, 3.5), parameter(KP, 21.0), parameter(KP, 3, STRING)]
        wanted.append(parameter("Tilt.PID.kp", 4, INTEGER))
        results = client(peer, "set_parameters", "rcl_interfaces/srv/SetParameters").call(wanted).results
        assert [result.successful for result in results] == [True, False, False, True]
        assert numbers_of(peer, [KP, "Tilt.PID.kp"]) == [3.5, 4.0]
        assert peer.spin_until(lambda: bool(events.received))
        (event,) = events.messages
        assert (event.node, event.new_parameters, event.deleted_parameters) == (NODE, [], [])
        assert [(p.name, p.value.double_value) for p in event.changed_parameters] == [(KP, 3.5), ("Tilt.PID.kp", 4.0)]


def test_all_parameters_in_one_request(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """`ros2 param dump` and `load` send all names in one request."""
    with robot(net, jiwy, tmp_path), Peer(net.domain, "tool") as peer:
        names = client(peer, "list_parameters", "rcl_interfaces/srv/ListParameters").call([], 0).result.names
        before = numbers_of(peer, names)
        wanted = [parameter(name, number + 0.001) for name, number in zip(names, before, strict=True)]
        atomically = client(peer, "set_parameters_atomically", "rcl_interfaces/srv/SetParametersAtomically")
        assert atomically.call(wanted).result.successful
        assert numbers_of(peer, names) == [number + 0.001 for number in before]
        refused = atomically.call([*wanted[:-1], parameter(KP, -1.0)]).result
        assert (refused.successful, refused.reason) == (
            False,
            "Parameter {Pan.PID.kp} doesn't comply with floating point range.",
        )
        assert numbers_of(peer, names) == [number + 0.001 for number in before]
        assert malformed(peer) == 0


def test_stored_parameters_are_back_after_a_restart(jiwy: Path, net: Network, tmp_path: Path) -> None:
    store = ("--store", str(tmp_path / "store"))
    trigger = "std_srvs/srv/Trigger"
    with robot(net, jiwy, tmp_path, *store) as board, Peer(net.domain, "tool") as peer:
        assert client(peer, "set_parameters", "rcl_interfaces/srv/SetParameters").call([parameter(KP, 3.5)]).results
        refused = client(peer, "store_parameters", trigger).call(0)
        assert (refused.success, refused.message) == (False, "the actuators must be off: disable first")
        assert client(peer, "enable", "std_srvs/srv/SetBool").call(False).success
        stored = client(peer, "store_parameters", trigger).call(0)
        assert (stored.success, stored.message) == (True, "1 value is stored")
        board.end()
    with robot(net, jiwy, tmp_path, *store), Peer(net.domain, "tool") as peer:
        assert numbers_of(peer, [KP]) == [3.5]


def test_a_target_without_parameters_serves_none(build_checked: Build, net: Network, tmp_path: Path) -> None:
    with robot(net, build_checked("follower"), tmp_path), Peer(net.domain, "monitor") as peer:
        meet(peer)

        def requests() -> set[str]:
            return {r.topic_name for r in peer.graph.readers.values() if r.topic_name.startswith("rq/")}

        wanted = {f"rq{NODE}/enableRequest", f"rq{NODE}/resetRequest"}
        assert peer.spin_until(lambda: requests() >= wanted)
        peer.spin(0.5)  # services of parameters would follow
        assert requests() == wanted
        assert "/parameter_events" not in {endpoint.topic for endpoint in peer.graph.publications()}
