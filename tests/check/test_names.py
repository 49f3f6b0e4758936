# SPDX-License-Identifier: Apache-2.0
"""Names that C and ROS 2 allow."""

from __future__ import annotations

import pytest

from epg.generator.check.names import (
    absolute_topic,
    identifier_problem,
    namespace_problem,
    node_name_problem,
    topic_problem,
)


@pytest.mark.parametrize("name", ["jiwy", "_a", "A1", "x" * 63])
def test_identifiers(name: str) -> None:
    assert identifier_problem(name) is None


@pytest.mark.parametrize("name", ["", "1a", "a-b", "int", "class", "__x", "_X", "epg_x", "x" * 64, "ä", "a\n", "NULL"])
def test_no_identifiers(name: str) -> None:
    assert identifier_problem(name)


@pytest.mark.parametrize("name", ["JIWY_node", "n1"])
def test_node_names(name: str) -> None:
    assert node_name_problem(name) is None


@pytest.mark.parametrize("name", ["", "a/b", "1n", "a b", "n" * 256])
def test_no_node_names(name: str) -> None:
    assert node_name_problem(name)


@pytest.mark.parametrize("name", ["", "/", "/robot1", "robot1", "/lab/robot1"])
def test_namespaces(name: str) -> None:
    assert namespace_problem(name) is None


@pytest.mark.parametrize("name", ["//", "/robot 1", "/robot/", "/1", "a__b"])
def test_no_namespaces(name: str) -> None:
    assert namespace_problem(name)


@pytest.mark.parametrize("name", ["pan", "/pan", "arm/pan_1", "_hidden"])
def test_topics(name: str) -> None:
    assert topic_problem(name) is None


@pytest.mark.parametrize(
    "name", ["", "/", "~pan", "~/", "~//pan", "~/1", "pan/", "a//b", "1/a", "pan__x", "a b", "t" * 300]
)
def test_no_topics(name: str) -> None:
    assert topic_problem(name)


def test_topics_stand_below_the_namespace_unless_they_are_absolute() -> None:
    assert absolute_topic("pan", "", "node") == "/pan"
    assert absolute_topic("pan", "/robot1/", "node") == "/robot1/pan"
    assert absolute_topic("/pan", "/robot1", "node") == "/pan"


def test_private_topics_stand_below_the_node() -> None:
    assert topic_problem("~/enable") is None
    assert absolute_topic("~/enable", "", "node") == "/node/enable"
    assert absolute_topic("~/enable", "robot1", "node") == "/robot1/node/enable"


@pytest.mark.parametrize("name", ["robot_$serial", "r$serial", "r_$serial_x", "r_$serial$serial"])
def test_serial_numbers_in_names(name: str) -> None:
    assert node_name_problem(name) is None
    assert namespace_problem(f"/fleet/{name}") is None


@pytest.mark.parametrize("name", ["$serial", "$serial_robot", "robot_$serials!", "robot_$other", "r" * 48 + "$serial"])
def test_serial_numbers_that_make_no_name(name: str) -> None:
    """They may begin with a digit, and may have up to 16 characters."""
    assert node_name_problem(name) is not None
    assert namespace_problem(f"/fleet/{name}") is not None


def test_names_that_firmware_has_room_for() -> None:
    assert node_name_problem("n" * 63) is None
    assert node_name_problem("n" * 64) is not None
    assert namespace_problem("/" + "n" * 62) is None
    assert namespace_problem("/" + "n" * 63) is not None
