# SPDX-License-Identifier: Apache-2.0
"""The runtime's messages have the hashes that follow from their definitions in ROS 2."""

from __future__ import annotations

import re

import pytest

from tests.doubles.ros2_peer.definitions import ros_type, type_hash

from .program import RUNTIME


def messages() -> list[tuple[str, str]]:
    """The type and hash of each message, and of each request and reply, in the runtime's sources."""
    found = []
    for source in sorted((RUNTIME / "src").glob("*/*.c")):
        text = source.read_text().replace("\\\n", "\n")  # also in macros
        found += re.findall(r'\.type = "([^"]*)",\s*\.hash =\s*EPG_TYPE_HASH\("([^"]*)"\)', text)
    return found


def test_the_computation_gives_a_hash_that_is_known() -> None:
    known = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
    assert type_hash("std_msgs/msg/String") == known


def test_all_messages_are_found() -> None:
    declared = sum(
        len(re.findall(r"^const epg_message_t ", s.read_text(), re.M)) for s in (RUNTIME / "src").glob("*/*.c")
    )
    services = {"SetBool", "Trigger", "ListParameters", "GetParameters", "GetParameterTypes", "DescribeParameters"}
    services |= {"SetParameters", "SetParametersAtomically"}
    assert declared == 11
    assert len(messages()) == declared + 2 * len(services)


@pytest.mark.parametrize(("dds_type", "hash"), messages())
def test_hash(dds_type: str, hash: str) -> None:
    assert hash == type_hash(ros_type(dds_type))
