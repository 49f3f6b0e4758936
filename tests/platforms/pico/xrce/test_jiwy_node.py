# SPDX-License-Identifier: Apache-2.0
"""The predefined firmware is a ROS 2 node: names, topics, types and QoS; JIWY follows setpoints; the console works."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest

from tests.doubles.xrce_agent.messages import float64, read_diagnostics
from tests.doubles.xrce_agent.parameters import Parameters
from tests.platforms.pico.closed_loop.robot import AXES
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

from .board import Jiwy
from .checks import ENDS, assert_it_tracks, assert_undisturbed

PAN, TILT = AXES
EVENTS = {"rt/parameter_events": ("rcl_interfaces::msg::dds_::ParameterEvent_", True)}
SERVICES = [
    *("enable", "reset", "list_parameters", "get_parameters", "get_parameter_types", "describe_parameters"),
    *("set_parameters", "set_parameters_atomically", "store_parameters"),
]
STOP, START = 7, 8
"""Orders to the user's program."""


@pytest.fixture(params=PLATFORMS)
def jiwy(request: pytest.FixtureRequest) -> Iterator[Jiwy]:
    skip_unless_emulated(request.param)
    with Jiwy(request.param) as made:
        yield made


def test_what_it_reads_and_writes(jiwy: Jiwy) -> None:
    jiwy.agent.run(1200)
    ends = {end.topic: (end.type, end.reliable) for end in [*jiwy.agent.topics.readers, *jiwy.agent.topics.writers]}
    assert {topic: end for topic, end in ends.items() if topic.startswith("rt/")} == ENDS | EVENTS
    assert {topic for topic in ends if topic.startswith("rq/")} == {f"rq/JIWY_node/{name}Request" for name in SERVICES}
    said = read_diagnostics(jiwy.agent.heard("rt/diagnostics")[-1].data)
    assert (said.name, said.values["fault"], said.values["overruns"]) == ("JIWY_node", "none", "0")
    assert said.hardware == jiwy.pico.call("usb")["serial"]


def test_it_tracks(jiwy: Jiwy) -> None:
    """Follows a sine of 0.4 rad in 2 s, with a setpoint every 10 ms; both axes publish together, every 33 ms."""
    jiwy.home()
    jiwy.begin()
    assert_it_tracks(jiwy, 2)
    stats = assert_undisturbed(jiwy)
    jiwy.agent.run(300)
    assert jiwy.position("pan") == pytest.approx(jiwy.angle("pan"), abs=PAN.rad_per_count)
    assert jiwy.position("tilt") == pytest.approx(jiwy.angle("tilt"), abs=TILT.rad_per_count)
    assert (stats["reconnects"], stats["unsent"], stats["malformed"]) == ("0", "0", "0")


def test_the_console_and_the_topic_enable(jiwy: Jiwy) -> None:
    jiwy.agent.run(1100)  # a `false` right after the connection can be an old one of the agent
    for value, enabled in ((b"\0", "0"), (b"\1", "1")):
        assert jiwy.agent.topics.publish("rt/JIWY_node/enable", value) == 1
        jiwy.agent.run(20)
        assert jiwy.stats()["enabled"] == enabled


def test_the_service_enables_and_disturbs_no_cycle(jiwy: Jiwy) -> None:
    """The reply comes within some control cycles, also if many requests are made at once."""
    jiwy.home()
    jiwy.begin()
    began = jiwy.agent.now()
    assert jiwy.agent.call("/JIWY_node/enable", b"\1") == b"\1\0\0\0" + b"\x08\0\0\0enabled\0"
    assert jiwy.agent.now() - began < 0.02
    asked = [jiwy.agent.topics.ask("/JIWY_node/enable", b"\1") for _ in range(10)]
    assert jiwy.agent.run_until(
        lambda: all(jiwy.agent.topics.answers("/JIWY_node/enable", each) for each in asked), 500
    )
    jiwy.agent.run(300)
    stats = assert_undisturbed(jiwy)
    assert (stats["reconnects"], stats["malformed"]) == ("0", "0")
    assert jiwy.agent.call("/JIWY_node/enable", b"\0")[:1] == b"\1"
    assert jiwy.stats()["enabled"] == "0"


def test_parameters_are_set_and_disturb_no_cycle(jiwy: Jiwy) -> None:
    """All parameters are read, described and set, each in one request, while the robot tracks."""
    parameters = Parameters(jiwy.agent.call, "/JIWY_node")
    names = parameters.list()
    values = dict(zip(names, parameters.get(names), strict=True))
    assert (len(names), list(parameters.described(names))) == (30, names)
    jiwy.home()
    jiwy.begin()
    assert parameters.set_atomically(values) == (True, "")
    for factor in (0.9, 1.1, 1.0):
        assert parameters.set({"Pan.PID.kp": factor * values["Pan.PID.kp"]}) == [(True, "")]
        assert parameters.get(["Pan.PID.kp"]) == [factor * values["Pan.PID.kp"]]
    assert_it_tracks(jiwy, 1)
    stats = assert_undisturbed(jiwy)
    assert (stats["reconnects"], stats["malformed"]) == ("0", "0")


def test_a_value_that_is_none_is_dropped(jiwy: Jiwy) -> None:
    jiwy.agent.topics.publish("rt/pan_subscriber", float64(math.nan), reliable=False)
    jiwy.agent.run(20)
    stats = jiwy.stats()
    assert (stats["setpoints_dropped"], stats["fault"]) == ("1", "none")


@pytest.mark.parametrize("platform", PLATFORMS)
def test_in_a_program_of_the_users(platform: str) -> None:
    """The program runs from flash and has its own main(); the control cycle does not read flash."""
    skip_unless_emulated(platform)
    with Jiwy(platform, "user_jiwy") as jiwy:
        jiwy.begin()
        jiwy.agent.run(500)
        jiwy.agent.restart()
        jiwy.agent.wait_for("rt/pan_publisher")
        span = jiwy.pico.call("span", name="tick")
        assert len(span["passages"]) > 500
        assert span["flash_total"] == 0
        assert jiwy.stats()["missed"] == "0"


@pytest.mark.parametrize("platform", PLATFORMS)
def test_stopped_and_started_it_is_a_node_again(platform: str) -> None:
    """The agent keeps running; while the target is stopped, the board sends no message."""
    skip_unless_emulated(platform)
    with Jiwy(platform, "user_jiwy") as jiwy:
        for _ in range(3):
            jiwy.pico.write_word("order", STOP)
            jiwy.agent.run(30)
            stopped = jiwy.agent.now()
            jiwy.agent.run(150)
            assert jiwy.agent.heard("rt/pan_publisher", since=stopped) == []
            jiwy.pico.write_word("order", START)
            jiwy.agent.wait_for("rt/pan_publisher")
            jiwy.agent.run(50)
            assert jiwy.stats()["missed"] == "0"
        assert not jiwy.faults()
