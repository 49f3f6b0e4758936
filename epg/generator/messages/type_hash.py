# SPDX-License-Identifier: Apache-2.0
"""The hash by which ROS 2 distinguishes types (REP 2016): the SHA-256 of the description of a type as JSON text.

rosidl_generator_type_description writes that text.  It has the type and all types that it refers to, sorted by name,
with a fixed order of keys and without default values.
"""

from __future__ import annotations

import hashlib
import json

from epg.generator.messages.definition import Field, Message
from epg.generator.messages.library import Library

# The constants FIELD_TYPE_ of type_description_interfaces/msg/FieldType.  A char of a .msg file is a uint8 in IDL.
_NUMBERS = {
    "int8": 2,
    "uint8": 3,
    "char": 3,
    "int16": 4,
    "uint16": 5,
    "int32": 6,
    "uint32": 7,
    "int64": 8,
    "uint64": 9,
    "float32": 10,
    "float64": 11,
    "bool": 15,
    "byte": 16,
    "string": 17,
    "wstring": 18,
}
_NESTED, _BOUNDED_STRING = 1, 4  # a bounded string has the number of its string plus 4
_FORMS = {"one": 0, "array": 48, "bounded": 96, "sequence": 144}
# IDL has no empty structures, so rosidl puts this field into a message without fields.
_EMPTY = "structure_needs_at_least_one_member"


def type_hash(library: Library, name: str) -> str:
    """``RIHS01_`` and 64 hexadecimal digits, for a message that ``library`` has loaded.

    >>> from epg.generator.messages.library import known_message
    >>> type_hash(known_message("std_msgs/msg/String"), "std_msgs/msg/String")  # as `ros2 topic info --verbose`
    'RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18'
    """
    first, *others = library.with_dependencies(name)
    description = {
        "type_description": _describe(first),
        "referenced_type_descriptions": [_describe(other) for other in sorted(others, key=lambda other: other.name)],
    }
    text = json.dumps(description, ensure_ascii=True, separators=(", ", ": "))
    return "RIHS01_" + hashlib.sha256(text.encode()).hexdigest()


def _describe(message: Message) -> dict[str, object]:
    fields = [_field(field) for field in message.fields]
    empty = {"name": _EMPTY, "type": _type(_NUMBERS["uint8"])}
    return {"type_name": message.name, "fields": fields or [empty]}


def _field(field: Field) -> dict[str, object]:
    type_ = field.type
    if type_.is_message:
        number, nested = _NESTED, type_.base
    else:
        number, nested = _NUMBERS[type_.base] + (_BOUNDED_STRING if type_.string_bound else 0), ""
    return {"name": field.name, "type": _type(number + _FORMS[type_.form], type_.count, type_.string_bound, nested)}


def _type(number: int, capacity: int = 0, string_capacity: int = 0, nested: str = "") -> dict[str, object]:
    return {"type_id": number, "capacity": capacity, "string_capacity": string_capacity, "nested_type_name": nested}
