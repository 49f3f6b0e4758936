# SPDX-License-Identifier: Apache-2.0
"""The message of a component whose kind has a parameter of the type ``message``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from epg.generator.catalog.kind import Kind
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.documents.schema import extended_from
from epg.generator.messages.byte_layout import MessageType, message_type
from epg.generator.messages.constants import Constant
from epg.generator.messages.library import Library, full_name
from epg.generator.source import YamlNode


def with_messages(
    kind: Kind, parameters: Mapping[str, object], node: YamlNode, roots: Sequence[Path], diagnostics: Diagnostics
) -> Mapping[str, object] | None:
    """``parameters`` with a :class:`MessageType` in the place of the name of a message.

    Parameters of the type ``fields`` must be called ``constants`` and ``lengths``.

    ``roots`` are the folders of targets; each can have a folder ``messages``.  Returns None after reporting mistakes.
    """
    named = [parameter.name for parameter in kind.parameters if parameter.type == "message"]
    if not named:
        return parameters
    (name,) = named
    written = node[name]
    constants, lengths = _constants(node.get("constants")), _constants(node.get("lengths"))
    received = kind.communication == "subscribe"
    found = _message(written, constants, lengths, received, roots, diagnostics)
    return None if found is None else MappingProxyType({**parameters, name: found})


def message_files(parameters: Mapping[str, object]) -> tuple[Path, ...]:
    """The files of the messages among the values of parameters."""
    return tuple(file for value in parameters.values() if isinstance(value, MessageType) for file in value.files)


def _message(
    written: YamlNode,
    constants: Mapping[str, Constant],
    lengths: Mapping[str, Constant],
    received: bool,
    roots: Sequence[Path],
    diagnostics: Diagnostics,
) -> MessageType | None:
    text, beside = str(written.value), Path(written.span.file).parent
    folders = [root / "messages" for root in roots]
    if text.endswith(".msg"):
        path = beside / text
        name = full_name(f"{path.parent.parent.name}/{path.stem}") if path.parent.name == "msg" else None
        if name is None:
            hint = "put it into <package>/msg/<Name>.msg: ROS 2 makes the name of a message of these folders"
            message = f"the folder of '{text}' does not give the package of the message"
            diagnostics.error("message-name", written.span, message, hint=hint, notes=extended_from(written))
            return None
        folders = [path.parent.parent.parent, *folders]
        if not path.is_file():
            diagnostics.error(
                "file-not-found", written.span, f"there is no file '{text}'", notes=extended_from(written)
            )
            return None
    else:
        name = full_name(text)
        folders = [beside, *folders]
        if name is None:
            hint = did_you_mean(text, Library(folders).names()) if "/" in text else ""
            hint = hint or "write <package>/<Name>, such as sensor_msgs/Imu, or the path of a .msg file"
            message = f"'{text}' is not the name of a message"
            diagnostics.error("message-name", written.span, message, hint=hint, notes=extended_from(written))
            return None
    library = Library(folders)
    if library.load(name, written.span, diagnostics) is None:
        return None
    return message_type(library, name, constants, lengths, received, written.span, diagnostics)


def _constants(node: YamlNode | None) -> dict[str, Constant]:
    if node is None:
        return {}
    return {key: _constant(value, node, key) for key, value in node.items()}


def _constant(node: YamlNode, parent: YamlNode, key: str) -> Constant:
    at = parent.key_span(key)
    if node.is_sequence:
        elements = tuple(_constant(element, parent, key) for element in node.elements())
        return Constant(elements, node.span, at)
    assert isinstance(node.value, (bool, int, float, str))
    return Constant(node.value, node.span, at)
