# SPDX-License-Identifier: Apache-2.0
"""Definitions of ROS 2 messages, and the hashes by which ROS 2 distinguishes types.

The definitions are those of ROS 2 Jazzy's common_interfaces and rmw_dds_common.  They leave out constants, which are
not part of a type.  Hashes are computed from the definitions (REP 2016), independently of the constants in EPG's
runtime.  A hash is the SHA-256 of the descriptions of a type and of all types that it refers to, as JSON text with a
fixed order of keys.
"""

from __future__ import annotations

import hashlib
import json

DEFINITIONS = {
    "builtin_interfaces/msg/Time": "int32 sec, uint32 nanosec",
    "std_msgs/msg/Header": "builtin_interfaces/msg/Time stamp, string frame_id",
    "rosgraph_msgs/msg/Clock": "builtin_interfaces/msg/Time clock",
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
    "geometry_msgs/msg/Quaternion": "float64 x, float64 y, float64 z, float64 w",
    "sensor_msgs/msg/Imu": "std_msgs/msg/Header header, geometry_msgs/msg/Quaternion orientation, "
    "float64[9] orientation_covariance, geometry_msgs/msg/Vector3 angular_velocity, "
    "float64[9] angular_velocity_covariance, geometry_msgs/msg/Vector3 linear_acceleration, "
    "float64[9] linear_acceleration_covariance",
    "robot_msgs/msg/Gripper": "std_msgs/msg/Header header, bool holding, uint8 state, float32[3] force, int16 raw, "
    "string<=10 label, float64 width",
    "geometry_msgs/msg/TwistStamped": "std_msgs/msg/Header header, geometry_msgs/msg/Twist twist",
    "sensor_msgs/msg/JointState": "std_msgs/msg/Header header, string[] name, float64[] position, float64[] velocity, "
    "float64[] effort",
    "diagnostic_msgs/msg/KeyValue": "string key, string value",
    "diagnostic_msgs/msg/DiagnosticStatus": "byte level, string name, string message, string hardware_id, "
    "diagnostic_msgs/msg/KeyValue[] values",
    "diagnostic_msgs/msg/DiagnosticArray": "std_msgs/msg/Header header, diagnostic_msgs/msg/DiagnosticStatus[] status",
    "std_srvs/srv/SetBool_Request": "bool data",
    "std_srvs/srv/SetBool_Response": "bool success, string message",
    "std_srvs/srv/Trigger_Request": "uint8 structure_needs_at_least_one_member",
    "std_srvs/srv/Trigger_Response": "bool success, string message",
    "rcl_interfaces/msg/ParameterValue": "uint8 type, bool bool_value, int64 integer_value, float64 double_value, "
    "string string_value, byte[] byte_array_value, bool[] bool_array_value, int64[] integer_array_value, "
    "float64[] double_array_value, string[] string_array_value",
    "rcl_interfaces/msg/Parameter": "string name, rcl_interfaces/msg/ParameterValue value",
    "rcl_interfaces/msg/ParameterEvent": "builtin_interfaces/msg/Time stamp, string node, "
    "rcl_interfaces/msg/Parameter[] new_parameters, rcl_interfaces/msg/Parameter[] changed_parameters, "
    "rcl_interfaces/msg/Parameter[] deleted_parameters",
    "rcl_interfaces/msg/FloatingPointRange": "float64 from_value, float64 to_value, float64 step",
    "rcl_interfaces/msg/IntegerRange": "int64 from_value, int64 to_value, uint64 step",
    "rcl_interfaces/msg/ParameterDescriptor": "string name, uint8 type, string description, "
    "string additional_constraints, bool read_only, bool dynamic_typing, "
    "rcl_interfaces/msg/FloatingPointRange[<=1] floating_point_range, "
    "rcl_interfaces/msg/IntegerRange[<=1] integer_range",
    "rcl_interfaces/msg/ListParametersResult": "string[] names, string[] prefixes",
    "rcl_interfaces/msg/SetParametersResult": "bool successful, string reason",
    "rcl_interfaces/srv/ListParameters_Request": "string[] prefixes, uint64 depth",
    "rcl_interfaces/srv/ListParameters_Response": "rcl_interfaces/msg/ListParametersResult result",
    "rcl_interfaces/srv/GetParameters_Request": "string[] names",
    "rcl_interfaces/srv/GetParameters_Response": "rcl_interfaces/msg/ParameterValue[] values",
    "rcl_interfaces/srv/GetParameterTypes_Request": "string[] names",
    "rcl_interfaces/srv/GetParameterTypes_Response": "uint8[] types",
    "rcl_interfaces/srv/DescribeParameters_Request": "string[] names",
    "rcl_interfaces/srv/DescribeParameters_Response": "rcl_interfaces/msg/ParameterDescriptor[] descriptors",
    "rcl_interfaces/srv/SetParameters_Request": "rcl_interfaces/msg/Parameter[] parameters",
    "rcl_interfaces/srv/SetParameters_Response": "rcl_interfaces/msg/SetParametersResult[] results",
    "rcl_interfaces/srv/SetParametersAtomically_Request": "rcl_interfaces/msg/Parameter[] parameters",
    "rcl_interfaces/srv/SetParametersAtomically_Response": "rcl_interfaces/msg/SetParametersResult result",
    "rmw_dds_common/msg/Gid": "uint8[16] data",  # char[16], which is uint8 in IDL
    "rmw_dds_common/msg/NodeEntitiesInfo": "string<=256 node_namespace, string<=256 node_name, "
    "rmw_dds_common/msg/Gid[] reader_gid_seq, rmw_dds_common/msg/Gid[] writer_gid_seq",
    "rmw_dds_common/msg/ParticipantEntitiesInfo": "rmw_dds_common/msg/Gid gid, "
    "rmw_dds_common/msg/NodeEntitiesInfo[] node_entities_info_seq",
}

# type_description_interfaces/msg/FieldType
_NUMBERS = {
    "int16": 4,
    "int32": 6,
    "uint32": 7,
    "int64": 8,
    "uint64": 9,
    "float32": 10,
    "float64": 11,
    "uint8": 3,
    "bool": 15,
    "byte": 16,
    "string": 17,
}
_NESTED, _BOUNDED_STRING, _ARRAY, _BOUNDED_SEQUENCE, _SEQUENCE = 1, 21, 48, 96, 144


def fields_of(type_: str) -> list[tuple[str, str]]:
    """The fields of a message: pairs of name and type."""
    pairs = (field.split(" ") for field in DEFINITIONS[type_].split(", "))
    return [(name, text) for text, name in pairs]


def _field(name: str, type_: str) -> dict[str, object]:
    string_capacity = capacity = 0
    nested = ""
    base, bracket, size = type_.partition("[")
    if base.startswith("string<="):
        number, string_capacity = _BOUNDED_STRING, int(base.removeprefix("string<="))
    elif "/" in base:
        number, nested = _NESTED, base
    else:
        number = _NUMBERS[base]
    if bracket:
        capacity = int(size.removeprefix("<=").rstrip("]") or 0)
        number += _BOUNDED_SEQUENCE if size.startswith("<=") else _ARRAY if capacity else _SEQUENCE
    described = {
        "type_id": number,
        "capacity": capacity,
        "string_capacity": string_capacity,
        "nested_type_name": nested,
    }
    return {"name": name, "type": described}


def _describe(type_: str) -> dict[str, object]:
    return {"type_name": type_, "fields": [_field(name, text) for name, text in fields_of(type_)]}


def _referenced(type_: str) -> set[str]:
    direct = {text.partition("[")[0] for _, text in fields_of(type_) if "/" in text}
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
