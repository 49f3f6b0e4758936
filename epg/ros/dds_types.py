# SPDX-License-Identifier: Apache-2.0
"""Messages as types of CycloneDDS, with the names that ROS 2 gives them in DDS.

>>> # Float64 = dds_type(known_message("std_msgs/msg/Float64"), "std_msgs/msg/Float64")
"""

from __future__ import annotations

from functools import cache
from typing import Any

import cyclonedds.idl.annotations as annotate
from cyclonedds.idl import make_idl_struct, types

from epg.generator.messages.definition import FieldType
from epg.generator.messages.library import Library

_PRIMITIVES = {"bool": bool, "byte": types.uint8, "char": types.uint8, "string": str, "wstring": str}


@cache
def dds_type(library: Library, name: str) -> Any:
    """The class of the loaded message ``name``."""
    message = library[name]
    package, _, short = name.partition("/msg/")
    fields = {field.name: _type(library, field.type) for field in message.fields}
    return annotate.final(make_idl_struct(short, f"{package}::msg::dds_::{short}_", fields))


def _type(library: Library, type_: FieldType) -> Any:
    """The type of a field.  Bounds are not checked here, because they do not change the bytes of a message."""
    if type_.is_message:
        one = dds_type(library, type_.base)
    else:
        one = _PRIMITIVES.get(type_.base) or getattr(types, type_.base)
    if type_.form == "one":
        return one
    return types.array[one, type_.count] if type_.form == "array" else types.sequence[one]
