# SPDX-License-Identifier: Apache-2.0
"""ROS 2 messages as types of CycloneDDS's Python package."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import cyclonedds.idl.annotations as annotate
from cyclonedds.idl import make_idl_struct
from cyclonedds.idl.types import array, float32, float64, int16, int32, int64, sequence, uint8, uint32, uint64

from tests.doubles.ros2_peer.definitions import fields_of

_IDL = {
    "int16": int16,
    "int32": int32,
    "uint32": uint32,
    "float32": float32,
    "float64": float64,
    "uint8": uint8,
    "byte": uint8,
}
_IDL |= {"bool": bool, "string": str, "int64": int64, "uint64": uint64}

_DEFINITIONS: dict[str, list[tuple[str, str]]] = {
    "std_msgs/msg/Float64": [("data", "float64")],
    "std_msgs/msg/Float32": [("data", "float32")],
    "std_msgs/msg/Int32": [("data", "int32")],
    "std_msgs/msg/Bool": [("data", "bool")],
    "std_msgs/msg/String": [("data", "string")],
    "std_msgs/msg/Header": [("stamp", "builtin_interfaces/msg/Time"), ("frame_id", "string")],
    "builtin_interfaces/msg/Time": [("sec", "int32"), ("nanosec", "uint32")],
    "std_msgs/msg/MultiArrayDimension": [("label", "string"), ("size", "uint32"), ("stride", "uint32")],
    "std_msgs/msg/MultiArrayLayout": [("dim", "std_msgs/msg/MultiArrayDimension[]"), ("data_offset", "uint32")],
    "std_msgs/msg/Float64MultiArray": [("layout", "std_msgs/msg/MultiArrayLayout"), ("data", "float64[]")],
    "sensor_msgs/msg/JointState": [
        ("header", "std_msgs/msg/Header"),
        ("name", "string[]"),
        ("position", "float64[]"),
        ("velocity", "float64[]"),
        ("effort", "float64[]"),
    ],
    "diagnostic_msgs/msg/KeyValue": [("key", "string"), ("value", "string")],
    "diagnostic_msgs/msg/DiagnosticStatus": [
        ("level", "byte"),
        ("name", "string"),
        ("message", "string"),
        ("hardware_id", "string"),
        ("values", "diagnostic_msgs/msg/KeyValue[]"),
    ],
    "diagnostic_msgs/msg/DiagnosticArray": [
        ("header", "std_msgs/msg/Header"),
        ("status", "diagnostic_msgs/msg/DiagnosticStatus[]"),
    ],
    "rmw_dds_common/msg/Gid": [("data", "uint8[16]")],  # char[16], which is uint8 in IDL
    "rmw_dds_common/msg/NodeEntitiesInfo": [
        ("node_namespace", "string<=256"),
        ("node_name", "string<=256"),
        ("reader_gid_seq", "rmw_dds_common/msg/Gid[]"),
        ("writer_gid_seq", "rmw_dds_common/msg/Gid[]"),
    ],
    "rmw_dds_common/msg/ParticipantEntitiesInfo": [
        ("gid", "rmw_dds_common/msg/Gid"),
        ("node_entities_info_seq", "rmw_dds_common/msg/NodeEntitiesInfo[]"),
    ],
}


def _idl_type(text: str) -> Any:
    """The type of CycloneDDS for a field of a definition: ``float64[]`` is a sequence.  Strings have no bounds."""
    base, bracket, size = text.partition("[")
    one = _struct(base) if "/" in base else _IDL[base.partition("<=")[0]]
    if not bracket:
        return one
    return sequence[one] if size == "]" or size.startswith("<=") else array[one, int(size.rstrip("]"))]


def _idl_struct(type_: str, fields: dict[str, Any]) -> Any:
    package, kind, name = type_.split("/")
    return annotate.final(make_idl_struct(f"{name}_", f"{package}::{kind}::dds_::{name}_", fields))


@cache
def _struct(type_: str) -> Any:
    """The type of CycloneDDS for the ROS 2 message ``type_``."""
    return _idl_struct(type_, {name: _idl_type(text) for name, text in fields_of(type_)})


@cache
def service_struct(type_: str) -> Any:
    """The type of a request or a reply, such as ``std_srvs/srv/SetBool_Request``, with rmw_cyclonedds' header."""
    header = {"client_guid": uint64, "sequence_number": int64}
    return _idl_struct(type_, header | {name: _idl_type(text) for name, text in fields_of(type_)})


Clock_ = _struct("rosgraph_msgs/msg/Clock")
Float64_ = _struct("std_msgs/msg/Float64")
Float32_ = _struct("std_msgs/msg/Float32")
Int32_ = _struct("std_msgs/msg/Int32")
Bool_ = _struct("std_msgs/msg/Bool")
MultiArrayDimension_ = _struct("std_msgs/msg/MultiArrayDimension")
MultiArrayLayout_ = _struct("std_msgs/msg/MultiArrayLayout")
Float64MultiArray_ = _struct("std_msgs/msg/Float64MultiArray")
JointState_ = _struct("sensor_msgs/msg/JointState")
Imu_ = _struct("sensor_msgs/msg/Imu")
Vector3_ = _struct("geometry_msgs/msg/Vector3")
Gripper_ = _struct("robot_msgs/msg/Gripper")
Header_ = _struct("std_msgs/msg/Header")
Time_ = _struct("builtin_interfaces/msg/Time")
DiagnosticArray_ = _struct("diagnostic_msgs/msg/DiagnosticArray")
Parameter_ = _struct("rcl_interfaces/msg/Parameter")
ParameterEvent_ = _struct("rcl_interfaces/msg/ParameterEvent")
ParameterValue_ = _struct("rcl_interfaces/msg/ParameterValue")
Gid_ = _struct("rmw_dds_common/msg/Gid")
NodeEntitiesInfo_ = _struct("rmw_dds_common/msg/NodeEntitiesInfo")
ParticipantEntitiesInfo_ = _struct("rmw_dds_common/msg/ParticipantEntitiesInfo")

# Other types with the name of Float64: too short, so long that it arrives in fragments, and much too long.
ShortFloat64_ = _idl_struct("std_msgs/msg/Float64", {"data": uint8})
LongFloat64_ = _idl_struct("std_msgs/msg/Float64", {"data": float64, "more": array[uint8, 20_000]})
HugeFloat64_ = _idl_struct("std_msgs/msg/Float64", {"data": array[uint8, 200_000]})


def numbers(messages: Sequence[object]) -> list[float]:
    """The ``data`` of messages that contain one number."""
    return [message.data for message in messages]  # type: ignore[attr-defined]
