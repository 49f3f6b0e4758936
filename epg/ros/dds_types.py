# SPDX-License-Identifier: Apache-2.0
"""The ROS 2 messages that targets use, as types of CycloneDDS with the names that ROS 2 gives them in DDS."""

from __future__ import annotations

from typing import Any

import cyclonedds.idl.annotations as annotate
from cyclonedds.idl import IdlStruct, make_idl_struct
from cyclonedds.idl.types import float32, float64, int32, sequence, uint32


def _message(package: str, name: str, /, **fields: Any) -> Any:
    """The type ``name`` of a package of ROS 2, with its fields in their order."""
    return annotate.final(make_idl_struct(name, f"{package}::msg::dds_::{name}_", fields))


Float64 = _message("std_msgs", "Float64", data=float64)
Float32 = _message("std_msgs", "Float32", data=float32)
Int32 = _message("std_msgs", "Int32", data=int32)
Bool = _message("std_msgs", "Bool", data=bool)

MultiArrayDimension = _message("std_msgs", "MultiArrayDimension", label=str, size=uint32, stride=uint32)
MultiArrayLayout = _message("std_msgs", "MultiArrayLayout", dim=sequence[MultiArrayDimension], data_offset=uint32)
Float64MultiArray = _message("std_msgs", "Float64MultiArray", layout=MultiArrayLayout, data=sequence[float64])

Time = _message("builtin_interfaces", "Time", sec=int32, nanosec=uint32)
Header = _message("std_msgs", "Header", stamp=Time, frame_id=str)
JointState = _message(
    "sensor_msgs",
    "JointState",
    header=Header,
    name=sequence[str],
    position=sequence[float64],
    velocity=sequence[float64],
    effort=sequence[float64],
)

Vector3 = _message("geometry_msgs", "Vector3", x=float64, y=float64, z=float64)
Twist = _message("geometry_msgs", "Twist", linear=Vector3, angular=Vector3)
TwistStamped = _message("geometry_msgs", "TwistStamped", header=Header, twist=Twist)

TYPES: dict[str, type[IdlStruct]] = {
    "std_msgs/msg/Float64": Float64,
    "std_msgs/msg/Float32": Float32,
    "std_msgs/msg/Int32": Int32,
    "std_msgs/msg/Bool": Bool,
    "std_msgs/msg/Float64MultiArray": Float64MultiArray,
    "sensor_msgs/msg/JointState": JointState,
    "geometry_msgs/msg/Twist": Twist,
    "geometry_msgs/msg/TwistStamped": TwistStamped,
}
