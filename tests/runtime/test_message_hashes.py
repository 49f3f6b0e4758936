# SPDX-License-Identifier: Apache-2.0
"""Names and hashes by which ROS 2 distinguishes message types, computed from the definitions by REP 2016.

A hash is the SHA-256 of the descriptions of a type and of all types that it refers to, as JSON text with the
keys in the order below.
"""

from __future__ import annotations

import hashlib
import json
import re

import pytest

from .program import RUNTIME

DEFINITIONS = {
    "builtin_interfaces/msg/Time": "int32 sec, uint32 nanosec",
    "std_msgs/msg/Header": "builtin_interfaces/msg/Time stamp, string frame_id",
    "std_msgs/msg/String": "string data",
    "std_msgs/msg/Float64": "float64 data",
    "std_msgs/msg/Float32": "float32 data",
    "std_msgs/msg/Int32": "int32 data",
    "std_msgs/msg/Bool": "bool data",
    "std_msgs/msg/MultiArrayDimension": "string label, uint32 size, uint32 stride",
    "std_msgs/msg/MultiArrayLayout": "std_msgs/msg/MultiArrayDimension[] dim, uint32 data_offset",
    "std_msgs/msg/Float64MultiArray": "std_msgs/msg/MultiArrayLayout layout, float64[] data",
    "geometry_msgs/msg/Vector3": "float64 x, float64 y, float64 z",
    "geometry_msgs/msg/Twist": "geometry_msgs/msg/Vector3 linear, geometry_msgs/msg/Vector3 angular",
    "geometry_msgs/msg/TwistStamped": "std_msgs/msg/Header header, geometry_msgs/msg/Twist twist",
    "sensor_msgs/msg/JointState": "std_msgs/msg/Header header, string[] name, float64[] position, float64[] velocity, "
    "float64[] effort",
    "diagnostic_msgs/msg/KeyValue": "string key, string value",
    "diagnostic_msgs/msg/DiagnosticStatus": "byte level, string name, string message, string hardware_id, "
    "diagnostic_msgs/msg/KeyValue[] values",
    "diagnostic_msgs/msg/DiagnosticArray": "std_msgs/msg/Header header, diagnostic_msgs/msg/DiagnosticStatus[] status",
}
"""Fields of the messages of ROS 2 Jazzy's common_interfaces and rcl_interfaces (constants are not part of a type)."""

# type_description_interfaces/msg/FieldType
NESTED, UNBOUNDED_SEQUENCE = 1, 144
TYPE_IDS = {"int32": 6, "uint32": 7, "float32": 10, "float64": 11, "bool": 15, "byte": 16, "string": 17}


def described(name: str) -> dict[str, object]:
    fields = []
    for field in DEFINITIONS[name].split(", "):
        written, _, field_name = field.partition(" ")
        base = written.removesuffix("[]")
        nested = base if base in DEFINITIONS else ""
        type_id = (NESTED if nested else TYPE_IDS[base]) + (UNBOUNDED_SEQUENCE if written.endswith("[]") else 0)
        kind = {"type_id": type_id, "capacity": 0, "string_capacity": 0, "nested_type_name": nested}
        fields.append({"name": field_name, "type": kind})
    return {"type_name": name, "fields": fields}


def referenced(name: str) -> set[str]:
    bases = {field.partition(" ")[0].removesuffix("[]") for field in DEFINITIONS[name].split(", ")} & set(DEFINITIONS)
    return bases.union(*(referenced(base) for base in bases))


def hash_of(name: str) -> str:
    description = {
        "type_description": described(name),
        "referenced_type_descriptions": [described(other) for other in sorted(referenced(name))],
    }
    return f"RIHS01_{hashlib.sha256(json.dumps(description).encode()).hexdigest()}"


def messages() -> list[tuple[str, str]]:
    """The type and hash of each message in the runtime's sources."""
    found = []
    for source in sorted((RUNTIME / "src").glob("*.c")):
        found += re.findall(r'\.type = "([^"]*)",\s*\.hash =\s*"([^"]*)"', source.read_text())
    return found


def test_the_computation_gives_a_hash_that_is_known() -> None:
    known = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
    assert hash_of("std_msgs/msg/String") == known


def test_all_messages_are_found() -> None:
    declared = sum(
        len(re.findall(r"^const epg_message_t ", s.read_text(), re.M)) for s in (RUNTIME / "src").glob("*.c")
    )
    assert len(messages()) == declared == 9


@pytest.mark.parametrize(("dds_type", "hash"), messages())
def test_hash(dds_type: str, hash: str) -> None:
    package, name = re.fullmatch(r"(\w+)::msg::dds_::(\w+)_", dds_type).groups()  # type: ignore[union-attr]
    assert hash == hash_of(f"{package}/msg/{name}")
