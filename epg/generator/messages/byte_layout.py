# SPDX-License-Identifier: Apache-2.0
"""The bytes of a message (classic CDR), as tables for the runtime (``epg_message_table_t`` in epg/message.h).

All texts and sequences of a message that a target sends are constants.  Therefore the message is a constant array of
bytes, and each number has a constant place in it.  In a message that a target receives, texts and sequences can have
any length.  Therefore the runtime reads it in steps.

The numbers have the names of their fields: ``angular_velocity.x``, and ``effort.0`` for an element of an array.  The
stamp of a message is the time of the control cycle.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.messages.constants import Constant, default_of, number_of
from epg.generator.messages.definition import Field, FieldType, Message
from epg.generator.messages.library import Library, complete_definition
from epg.generator.messages.type_hash import type_hash
from epg.generator.source import Span

FORMATS = {
    "bool": "B",
    "byte": "B",
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
"""The types of numbers, with their formats in :mod:`struct`."""

_C_TYPES = {"byte": "uint8", "char": "uint8"}
_TIME = "builtin_interfaces/msg/Time"

MOST_VALUES = 256
"""The largest number of values of a message.  The elements of larger arrays have no names of their own."""
MOST_BYTES = 4096
_MOST_ITEMS = 4096
_EMPTY = Field("structure_needs_at_least_one_member", FieldType("uint8", form="array", count=1), "", Span(""))
"""The field that rosidl puts into a message without fields, because IDL has no empty structures."""

_ANY_TEXT, _ANY_ELEMENTS = 64, 32  # the room for texts and sequences without a bound in a message that is received


@dataclass(frozen=True)
class MessageValue:
    """One number, text, stamp, array or sequence of a message, in the order of its bytes.

    ``base`` is a primitive type, "stamp", "length" (the number of elements of a sequence, ``count``), or the name of a
    message.  ``form`` and ``count`` are those of :class:`~epg.generator.messages.definition.FieldType`.  ``message`` is
    the message with the field.  For one number of an array, ``elements`` is the number of its elements; otherwise it is
    0.
    """

    path: str
    base: str
    form: str
    count: int
    field: Field
    message: Message
    elements: int = 0

    @property
    def is_number(self) -> bool:
        return self.form == "one" and self.base in FORMATS


@dataclass(frozen=True)
class TypedOffset:
    """The place of a number, or of the stamp, in the bytes of a message."""

    offset: int
    type: str


@dataclass(frozen=True)
class ReadStep:
    """One step of reading: ``count`` values of a type, or one sequence.  ``name`` is the name of a number, or empty."""

    type: str
    sequence: bool
    count: int
    name: str


@dataclass(frozen=True)
class MessageType:
    """A message type for the templates of kinds.

    ``names`` are the names of its numbers.  ``data`` are the bytes of the message with its constants, ``places`` the
    places of its numbers in them, ``stamps`` those of its stamps.  ``largest`` is the size of the largest message that
    can be received.  ``files`` are the files of its definition.
    """

    ros_type: str
    dds_type: str
    hash: str
    names: tuple[str, ...]
    data: tuple[int, ...]
    places: Mapping[str, TypedOffset]
    stamps: tuple[TypedOffset, ...]
    steps: tuple[ReadStep, ...]
    largest: int
    files: tuple[Path, ...]
    definition: str  # complete, with those of the messages in it


def message_type(
    library: Library,
    name: str,
    constants: Mapping[str, Constant],
    lengths: Mapping[str, Constant],
    received: bool,
    wanted_by: Span,
    diagnostics: Diagnostics,
) -> MessageType | None:
    """The loaded message ``name``.  None after reporting what EPG does not support, and wrong ``constants``.

    ``constants`` are the values of fields that the user has written, and ``lengths`` the numbers of elements of
    sequences.  ``received`` is True for a subscription.
    ``wanted_by`` is the position of the name of the message.
    """
    errors = diagnostics.error_count
    checked = _lengths(lengths, diagnostics)
    # The definitions of hostile files can contain each other's arrays without end.
    items = list(islice(_items(library, library[name], "", checked), _MOST_ITEMS + 1))
    if len(items) > _MOST_ITEMS:
        message = f"{name} has more than {_MOST_ITEMS} fields, with those of the messages in it"
        diagnostics.error("message-unsupported", wanted_by, message)
        return None
    _unknown_lengths(lengths, items, diagnostics)
    _unsupported(items, received, wanted_by, diagnostics)
    names = tuple(item.path for item in items if item.is_number)
    if not names:
        diagnostics.error("message-unsupported", wanted_by, f"{name} does not have a field with a single number")
    elif len(names) > MOST_VALUES:
        message = f"{name} has {len(names)} numbers, and EPG supports at most {MOST_VALUES}"
        diagnostics.error("message-unsupported", wanted_by, message)
    if diagnostics.error_count > errors:
        return None
    writer = _Writer(constants, diagnostics)
    for item in items:
        writer.add(item)
    _unknown_constants(constants, writer.used, items, diagnostics)
    if len(writer.data) > MOST_BYTES:
        message = f"{name} has {len(writer.data)} bytes, and EPG supports at most {MOST_BYTES}"
        diagnostics.error("message-unsupported", wanted_by, message)
    if diagnostics.error_count > errors:
        return None
    package, _, short = name.partition("/msg/")
    return MessageType(
        ros_type=name,
        dds_type=f"{package}::msg::dds_::{short}_",
        hash=type_hash(library, name),
        names=names,
        data=tuple(writer.data),
        places=writer.places,
        stamps=tuple(writer.stamps),
        steps=tuple(_step(item) for item in items),
        largest=_largest(items),
        files=library.files,
        definition=complete_definition(library, name),
    )


def _items(library: Library, message: Message, prefix: str, lengths: Mapping[str, int]) -> Iterator[MessageValue]:
    for field in message.fields or (_EMPTY,):
        path, form, count = prefix + field.name, field.type.form, field.type.count
        if form in ("bounded", "sequence") and path in lengths:
            form, count = "array", lengths[path]
            yield MessageValue(path, "length", "one", count, field, message)
        yield from _parts(library, MessageValue(path, field.type.base, form, count, field, message), lengths)


def _parts(library: Library, whole: MessageValue, lengths: Mapping[str, int]) -> Iterator[MessageValue]:
    """The items of one field: those of its messages, its numbers, or the field as a ``whole``.

    A time with the name ``stamp`` is that of the control cycle.
    """
    field, is_message = whole.field, whole.field.type.is_message
    if whole.base == _TIME and field.name == "stamp" and whole.form == "one":
        yield MessageValue(whole.path, "stamp", "one", 0, field, whole.message)
    elif is_message and whole.form == "one":
        yield from _items(library, library[whole.base], f"{whole.path}.", lengths)
    elif whole.form != "array" or whole.count > MOST_VALUES or field is _EMPTY:
        yield whole
    elif is_message:
        for number in range(whole.count):
            yield from _items(library, library[whole.base], f"{whole.path}.{number}.", lengths)
    elif whole.base in FORMATS:
        for number in range(whole.count):
            yield MessageValue(f"{whole.path}.{number}", whole.base, "one", 0, field, whole.message, whole.count)
    else:
        yield whole


def _lengths(lengths: Mapping[str, Constant], diagnostics: Diagnostics) -> dict[str, int]:
    """The lengths that are whole numbers.  Reports the others."""
    result = {}
    for path, length in lengths.items():
        if isinstance(length.value, int) and not isinstance(length.value, bool) and 0 <= length.value <= MOST_VALUES:
            result[path] = length.value
        else:
            message = f"the length of '{path}' must be a whole number from 0 to {MOST_VALUES}"
            diagnostics.error("message-constant", length.span, message)
    return result


def _unknown_lengths(lengths: Mapping[str, Constant], items: list[MessageValue], diagnostics: Diagnostics) -> None:
    """Reports lengths of fields that are not sequences, or that cannot be so long."""
    sequences = {item.path: item for item in items if item.base == "length" or item.form in ("bounded", "sequence")}
    for path, length in lengths.items():
        if path not in sequences:
            hint = did_you_mean(path, sorted(sequences), "sequences")
            diagnostics.error("message-constant", length.key, f"the message has no sequence '{path}'", hint=hint)
            continue
        type_ = sequences[path].field.type
        if type_.form == "bounded" and sequences[path].base == "length" and sequences[path].count > type_.count:
            message = f"'{path}' must have at most {type_.count} elements"
            diagnostics.error("message-constant", length.span, message)


def _unsupported(items: list[MessageValue], received: bool, wanted_by: Span, diagnostics: Diagnostics) -> None:
    """Reports the fields that EPG cannot write, or cannot read, once for each line of a definition."""
    told = set()
    for item in items:
        sequence = item.form in ("bounded", "sequence")
        if item.base == "wstring":
            message = "EPG does not support wstring"
        elif "/" in item.base and received and sequence:
            message = f"EPG cannot receive a sequence of messages, '{item.field.name}'"
        elif "/" in item.base and not sequence:
            message = f"'{item.field.name}' has {item.count} messages, and EPG supports at most {MOST_VALUES}"
        else:
            continue
        if item.field.span not in told:
            told.add(item.field.span)
            notes = [Note("the message is used here", wanted_by)]
            diagnostics.error("message-unsupported", item.field.span, message, notes=notes)


def _unknown_constants(
    constants: Mapping[str, Constant], used: set[str], items: list[MessageValue], diagnostics: Diagnostics
) -> None:
    for path, constant in constants.items():
        if path in used:
            continue
        item = next((item for item in items if item.path == path), None)
        if item is not None and item.base == "stamp":
            message = f"'{path}' cannot be a constant: it is the time of the control cycle"
            diagnostics.error("message-constant", constant.key, message)
            continue
        known = sorted(
            {item.path for item in items if item.base != "stamp"} | {_array_of(item) for item in items} - {""}
        )
        hint = did_you_mean(path, known, "fields")
        diagnostics.error("message-constant", constant.key, f"the message has no field '{path}'", hint=hint)


def _array_of(item: MessageValue) -> str:
    """The path of the array of numbers that ``item`` is an element of; empty if it is not an element."""
    return item.path.rpartition(".")[0] if item.elements else ""


class _Writer:
    """Collects the bytes of a message that is sent."""

    def __init__(self, constants: Mapping[str, Constant], diagnostics: Diagnostics) -> None:
        self._constants, self._diagnostics = constants, diagnostics
        self.data = bytearray()
        self.places: dict[str, TypedOffset] = {}
        self.stamps: list[TypedOffset] = []
        self.used: set[str] = set()

    def add(self, item: MessageValue) -> None:
        if item.base == "stamp":
            self.stamps.append(TypedOffset(self._put("I", 0), "STAMP"))
            self._put("I", 0)
        elif item.base == "length":
            self._put("I", item.count)
        elif item.is_number:
            self.places[item.path] = TypedOffset(self._put(FORMATS[item.base], self._number(item)), c_type(item.base))
        elif item.base in FORMATS:
            values = self._list(item)
            if item.form != "array":
                self._put("I", len(values))
            for value in values:
                self._put(FORMATS[item.base], number_of(item.base, value, item.message, self._diagnostics))
        elif item.base == "string" and item.form == "one":
            constant = self._take(item.path) or default_of(item.field)
            self._text(item, constant)
        elif item.base == "string":
            values = self._list(item)
            if item.form != "array":
                self._put("I", len(values))
            for value in values:
                self._text(item, value)
        else:  # a sequence of messages
            self._put("I", 0)

    def _put(self, format: str, value: float) -> int:
        """Appends a number after padding to its size.  Returns its offset."""
        size = struct.calcsize(format)
        self.data += bytes(-len(self.data) % size)
        self.data += struct.pack(f"<{format}", value)
        return len(self.data) - size

    def _take(self, path: str) -> Constant | None:
        if path in self._constants:
            self.used.add(path)
        return self._constants.get(path)

    def _number(self, item: MessageValue) -> float:
        """The constant of a number: its own, its element of a list, its default in the definition, or 0."""
        array = _array_of(item)
        constant = self._take(item.path)
        listed = self._take(array) if array else None
        if constant is None and listed is not None:
            constant = self._element(item, listed, int(item.path.rpartition(".")[2]))
        if constant is None:
            default = default_of(item.field)
            if default is not None and isinstance(default.value, tuple):
                at = int(item.path.rpartition(".")[2])
                default = default.value[at] if at < len(default.value) else None
            constant = default
        return 0 if constant is None else number_of(item.base, constant, item.message, self._diagnostics)

    def _element(self, item: MessageValue, listed: Constant, at: int) -> Constant | None:
        wanted = item.elements
        if not isinstance(listed.value, tuple) or len(listed.value) != wanted:
            if at == 0:
                message = f"'{item.path.rpartition('.')[0]}' must be a list of {wanted} values"
                self._diagnostics.error("message-constant", listed.span, message)
            return None
        return listed.value[at]

    def _list(self, item: MessageValue) -> tuple[Constant, ...]:
        """The constants of an array or a sequence.  An array has all its elements."""
        constant = self._take(item.path) or default_of(item.field)
        values: tuple[Constant, ...] = ()
        if constant is not None:
            if not isinstance(constant.value, tuple):
                self._diagnostics.error("message-constant", constant.span, f"'{item.path}' must be a list")
                return ()
            values = constant.value
            allowed = (
                len(values) == item.count
                if item.form == "array"
                else item.form != "bounded" or (len(values) <= item.count)
            )
            if not allowed:
                most = "" if item.form == "array" else "at most "
                message = f"'{item.path}' must have {most}{item.count} elements"
                self._diagnostics.error("message-constant", constant.span, message)
                return ()
        if item.form == "array" and not values:
            zero: str | int = "" if item.base == "string" else 0
            return (Constant(zero, item.field.span, item.field.span),) * item.count
        return values

    def _text(self, item: MessageValue, constant: Constant | None) -> None:
        text = "" if constant is None else constant.value
        bound = item.field.type.string_bound
        if not isinstance(text, str):
            assert constant is not None
            self._diagnostics.error("message-constant", constant.span, f"'{item.path}' must be text")
            return
        data = text.encode("utf-8")
        if constant is not None and ("\0" in text or len(data) > (bound or MOST_BYTES)):
            message = f"'{item.path}' must be text of at most {bound or MOST_BYTES} bytes, without NUL"
            self._diagnostics.error("message-constant", constant.span, message)
            return
        self._put("I", len(data) + 1)
        self.data += data + b"\0"


def c_type(base: str) -> str:
    """The name of a type in C after ``EPG_FIELD_``: FLOAT64."""
    return _C_TYPES.get(base, base).upper()


def _step(item: MessageValue) -> ReadStep:
    if item.base == "stamp":
        return ReadStep("UINT32", False, 2, "")
    if "/" in item.base:  # only in a message that is sent, which is not read
        return ReadStep("STRING", True, 0, "")
    sequence = item.form in ("bounded", "sequence")
    count = item.count if item.form == "array" else 1
    return ReadStep(c_type(item.base), sequence, 0 if sequence else count, item.path if item.is_number else "")


def _largest(items: list[MessageValue]) -> int:
    """The size of the largest message that has room in the buffer, in bytes: each item with its largest padding."""
    total = 0
    for item in items:
        if item.base == "stamp":
            total += 3 + 8
            continue
        count = item.count if item.form in ("array", "bounded") else 1 if item.form == "one" else _ANY_ELEMENTS
        length = 4 if item.form in ("bounded", "sequence") else 0
        if item.base == "string":
            total += length + count * (3 + 4 + (item.field.type.string_bound or _ANY_TEXT) + 1)
        elif item.base in FORMATS:
            size = struct.calcsize(FORMATS[item.base])
            total += length + 3 * (length > 0) + size - 1 + count * size
    return total
