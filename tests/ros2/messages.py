# SPDX-License-Identifier: Apache-2.0
"""ROS 2 messages as types of CycloneDDS's Python package, and the hashes by which ROS 2 distinguishes types.

The definitions are those of ROS 2 Jazzy's common_interfaces and rmw_dds_common.  Hashes are computed here from the
definitions (REP 2016), independently of the constants in EPG's runtime.

(No ``from __future__ import annotations`` here: the package needs annotations that are types.)
"""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass

import cyclonedds.idl.annotations as annotate
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float32, float64, int32, sequence, uint8, uint32


@dataclass
@annotate.final
class Float64_(IdlStruct, typename="std_msgs::msg::dds_::Float64_"):
    data: float64


@dataclass
@annotate.final
class Float32_(IdlStruct, typename="std_msgs::msg::dds_::Float32_"):
    data: float32


@dataclass
@annotate.final
class Int32_(IdlStruct, typename="std_msgs::msg::dds_::Int32_"):
    data: int32


@dataclass
@annotate.final
class Bool_(IdlStruct, typename="std_msgs::msg::dds_::Bool_"):
    data: bool


@dataclass
@annotate.final
class Time_(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
@annotate.final
class Header_(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time_
    frame_id: str


@dataclass
@annotate.final
class MultiArrayDimension_(IdlStruct, typename="std_msgs::msg::dds_::MultiArrayDimension_"):
    label: str
    size: uint32
    stride: uint32


@dataclass
@annotate.final
class MultiArrayLayout_(IdlStruct, typename="std_msgs::msg::dds_::MultiArrayLayout_"):
    dim: sequence[MultiArrayDimension_]
    data_offset: uint32


@dataclass
@annotate.final
class Float64MultiArray_(IdlStruct, typename="std_msgs::msg::dds_::Float64MultiArray_"):
    layout: MultiArrayLayout_
    data: sequence[float64]


@dataclass
@annotate.final
class JointState_(IdlStruct, typename="sensor_msgs::msg::dds_::JointState_"):
    header: Header_
    name: sequence[str]
    position: sequence[float64]
    velocity: sequence[float64]
    effort: sequence[float64]


@dataclass
@annotate.final
class KeyValue_(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    key: str
    value: str


@dataclass
@annotate.final
class DiagnosticStatus_(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    level: uint8
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue_]


@dataclass
@annotate.final
class DiagnosticArray_(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    header: Header_
    status: sequence[DiagnosticStatus_]


@dataclass
@annotate.final
class Gid_(IdlStruct, typename="rmw_dds_common::msg::dds_::Gid_"):
    data: array[uint8, 16]


@dataclass
@annotate.final
class NodeEntitiesInfo_(IdlStruct, typename="rmw_dds_common::msg::dds_::NodeEntitiesInfo_"):
    node_namespace: str
    node_name: str
    reader_gid_seq: sequence[Gid_]
    writer_gid_seq: sequence[Gid_]


@dataclass
@annotate.final
class ParticipantEntitiesInfo_(IdlStruct, typename="rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"):
    gid: Gid_
    node_entities_info_seq: sequence[NodeEntitiesInfo_]


@dataclass
@annotate.final
class ShortFloat64_(IdlStruct, typename="std_msgs::msg::dds_::Float64_"):
    """Another type with this name, which is too short."""

    data: uint8


@dataclass
@annotate.final
class LongFloat64_(IdlStruct, typename="std_msgs::msg::dds_::Float64_"):
    """Another type with this name, so long that it arrives in fragments."""

    data: float64
    more: array[uint8, 20_000]


@dataclass
@annotate.final
class HugeFloat64_(IdlStruct, typename="std_msgs::msg::dds_::Float64_"):
    """Another type with this name, which is much too long."""

    data: array[uint8, 200_000]


_NUMBERS = {"int32": 6, "uint32": 7, "float32": 10, "float64": 11, "uint8": 3, "bool": 15, "byte": 16, "string": 17}
_ARRAY, _SEQUENCE, _BOUNDED_STRING = 48, 144, 21

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


def _field(name: str, type_: str) -> dict[str, object]:
    string_capacity = capacity = 0
    nested = ""
    base, bracket, size = type_.partition("[")
    if base.startswith("string<="):
        number, string_capacity = _BOUNDED_STRING, int(base.removeprefix("string<="))
    elif "/" in base:
        number, nested = 1, base
    else:
        number = _NUMBERS[base]
    if bracket:
        capacity = int(size.rstrip("]") or 0)
        number += _ARRAY if capacity else _SEQUENCE
    described = {
        "type_id": number,
        "capacity": capacity,
        "string_capacity": string_capacity,
        "nested_type_name": nested,
    }
    return {"name": name, "type": described}


def _describe(type_: str) -> dict[str, object]:
    return {"type_name": type_, "fields": [_field(name, text) for name, text in _DEFINITIONS[type_]]}


def _referenced(type_: str) -> set[str]:
    direct = {text.partition("[")[0] for _, text in _DEFINITIONS[type_] if "/" in text}
    return direct.union(*(_referenced(other) for other in direct)) if direct else set()


def type_hash(type_: str) -> str:
    """The RIHS01 hash of ``std_msgs/msg/Float64``.

    >>> type_hash("std_msgs/msg/String")  # as `ros2 topic info --verbose /chatter` shows it
    'RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18'
    """
    description = {
        "type_description": _describe(type_),
        "referenced_type_descriptions": [_describe(other) for other in sorted(_referenced(type_))],
    }
    text = json.dumps(description, ensure_ascii=True, separators=(", ", ": "))
    return "RIHS01_" + hashlib.sha256(text.encode()).hexdigest()


def ros_type(dds_type: str) -> str:
    """``std_msgs/msg/Float64`` for ``std_msgs::msg::dds_::Float64_``, as in ``ros2 topic list -t``."""
    parts = dds_type.split("::")
    if len(parts) < 3 or parts[-2] != "dds_" or not parts[-1].endswith("_"):
        raise ValueError(f"'{dds_type}' is no type of ROS 2")
    return "/".join((*parts[:-2], parts[-1][:-1]))


def numbers(messages: Sequence[object]) -> list[float]:
    """The ``data`` of messages that contain one number."""
    return [message.data for message in messages]  # type: ignore[attr-defined]
