# SPDX-License-Identifier: Apache-2.0
"""Finds the definitions of messages, and of all messages that they refer to.

A folder of packages has the form of ROS 2: ``<package>/msg/<Name>.msg``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from epg.generator.data import data_folder
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.documents.text_file import is_file, read_text
from epg.generator.messages.definition import Message, parse_message
from epg.generator.source import Span

_DEPTH = 16  # messages inside each other

_FULL_NAME = r"([a-z][a-z0-9_]*)/(?:msg/)?([A-Z][A-Za-z0-9]*)"


def full_name(text: str) -> str | None:
    """``sensor_msgs/msg/Imu`` for ``sensor_msgs/Imu`` and for itself; None if ``text`` is not the name of a message.

    >>> full_name("sensor_msgs/Imu"), full_name("Own.msg")
    ('sensor_msgs/msg/Imu', None)
    """
    match = re.fullmatch(_FULL_NAME, text)
    return f"{match[1]}/msg/{match[2]}" if match else None


class Library:
    """The messages in ``folders`` of packages.  EPG's own folder, ``targets/messages``, is searched last.

    ``files`` are all files that were read.
    """

    def __init__(self, folders: Sequence[Path] = ()) -> None:
        self._folders = (*folders, data_folder("targets") / "messages")
        self._messages: dict[str, Message] = {}

    @property
    def files(self) -> tuple[Path, ...]:
        return tuple(message.path for message in self._messages.values())

    def names(self) -> list[str]:
        """The full names of all messages in the folders."""
        files = (file for folder in self._folders for file in folder.glob("*/msg/*.msg"))
        return sorted({f"{file.parent.parent.name}/msg/{file.stem}" for file in files})

    def load(self, name: str, wanted_by: Span, diagnostics: Diagnostics) -> Message | None:
        """The message with the full name ``name``, after reading all messages that it refers to.

        ``wanted_by`` is the position of its name.  Returns None after reporting mistakes.
        """
        return self._load(name, wanted_by, (), diagnostics)

    def _load(self, name: str, wanted_by: Span, outer: tuple[str, ...], diagnostics: Diagnostics) -> Message | None:
        if name in outer or len(outer) > _DEPTH:
            what = "itself" if name in outer else f"more than {_DEPTH} messages inside each other"
            diagnostics.error("message-definition", wanted_by, f"the message {outer[0]} contains {what}")
            return None
        if name in self._messages:
            return self._messages[name]
        message = self._read(name, wanted_by, diagnostics)
        if message is None:
            return None
        for field in message.fields:
            if field.type.is_message and self._load(field.type.base, field.span, (*outer, name), diagnostics) is None:
                return None
        self._messages[name] = message
        return message

    def _read(self, name: str, wanted_by: Span, diagnostics: Diagnostics) -> Message | None:
        package, _, short = name.partition("/msg/")
        for folder in self._folders:
            path = folder / package / "msg" / f"{short}.msg"
            if is_file(path):
                text = read_text(path, diagnostics, wanted_by)
                return None if text is None else parse_message(name, text, path, diagnostics)
        hint = did_you_mean(name, self.names())
        diagnostics.error("unknown-message", wanted_by, f"EPG does not know the message {name}", hint=hint)
        return None

    def add(self, name: str, text: str) -> bool:
        """Adds the message ``name`` and those in it, from a complete definition.  False if the text is not one."""
        first, *others = re.split(r"^={80}\n", text, flags=re.MULTILINE)
        parts = {name: first}
        for other in others:
            head, _, body = other.partition("\n")
            parts[full_name(head.removeprefix("MSG:").strip()) or head] = body
        diagnostics = Diagnostics()
        for one, body in parts.items():
            message = parse_message(one, body, Path(one), diagnostics)
            if message is not None:
                self._messages[one] = message
        needed = {name, *(other for one in self._messages.values() for other in one.dependencies)}
        return not diagnostics.has_errors and needed <= self._messages.keys()

    def __getitem__(self, name: str) -> Message:
        """A message that has been loaded."""
        return self._messages[name]

    def with_dependencies(self, name: str) -> list[Message]:
        """The loaded message ``name``, then all messages that it refers to, each before those that it refers to."""
        messages: dict[str, Message] = {}

        def add(name: str) -> None:
            if name not in messages:
                messages[name] = self[name]
                for other in self[name].dependencies:
                    add(other)

        add(name)
        return list(messages.values())


def complete_definition(library: Library, name: str) -> str:
    """The definition of a loaded message with those of all messages in it, in the encoding ``ros2msg`` of rosbag2.

    See rosbag2's docs/message_definition_encoding.md.
    """
    first, *others = library.with_dependencies(name)
    parts = [first.text] + [f"{'=' * 80}\nMSG: {other.name.replace('/msg/', '/')}\n{other.text}" for other in others]
    return "\n".join(parts)


def known_message(name: str) -> Library:
    """A library with the message ``name`` of EPG's own folder.  Raises KeyError if EPG does not have it."""
    library = Library()
    if library.load(name, Span(name), Diagnostics()) is None:
        raise KeyError(name)
    return library
