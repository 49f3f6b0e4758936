"""Names that C and ROS 2 allow."""

from __future__ import annotations

import pytest

from epg.check.names import absolute_topic, identifier_problem, namespace_problem, node_name_problem, topic_problem


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


@pytest.mark.parametrize("name", ["", "/", "~/pan", "pan/", "a//b", "1/a", "pan__x", "a b", "t" * 300])
def test_no_topics(name: str) -> None:
    assert topic_problem(name)


def test_topics_stand_below_the_namespace_unless_they_are_absolute() -> None:
    assert absolute_topic("pan", "") == "/pan"
    assert absolute_topic("pan", "/robot1/") == "/robot1/pan"
    assert absolute_topic("/pan", "/robot1") == "/pan"
