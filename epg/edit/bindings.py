# SPDX-License-Identifier: Apache-2.0
"""Changes the binding of one port in a bindings file.  All other text of the file stays as it was written.

>>> text = "version: 1\\nmodel: servo\\ninputs:\\n  angle: encoder   # at the load\\n"
>>> print(set_ends(text, "servo.bindings.yaml", model, "angle", [WireEnd("encoder", scale="1/4")]), end="")
version: 1
model: servo
inputs:
  angle: {from: encoder, scale: 1/4}   # at the load

An edit followed by its reverse gives the old text, with these exceptions:

- These texts are lost: comments on lines that were removed, comments of ``epg bind`` that a new line has replaced, line
  breaks and comments within a value that was replaced as a whole, and quotes around ``unconnected``.
- A section that was missing, commented out or empty becomes ``inputs: {}``.
- A port that is added again is placed directly below the port before it in the model's order.  A key of a map is placed
  in the order scale, offset, limits, unit.  Blank lines and comments that were between are below it then.
- ``{from: x}`` and ``[x]`` on one line become ``x`` when a key or an element is removed from them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from epg.edit.ends import REFERENCE, WireEnd, data_of, ends_of, said_ends
from epg.edit.section import add_port, remove_port
from epg.edit.value import change_value, value_text
from epg.edit.yaml_edit import CannotEdit, parse_map
from epg.generator.check.bindings import UNCONNECTED
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.yaml_file import parse_yaml
from epg.generator.models.model import Model
from epg.generator.source import YamlNode

__all__ = ["CannotEdit", "WireEnd", "ends_of", "set_ends"]


def set_ends(text: str, file: str, model: Model, port: str, ends: Sequence[WireEnd] | None) -> str:
    """``text`` with ``port`` of ``model`` bound to ``ends``: None removes the port, an empty list is ``unconnected``.

    ``file`` is the name of the text in messages.  Wrong numbers and impossible references are written as they are:
    reading the file reports them.  A port that the model does not have can only be removed.  Raises
    :class:`CannotEdit`.
    """
    body = text.removeprefix("\ufeff")
    root = parse_map(body, file)
    section = _section_of(root, file, model, port, ends)
    wanted = None if ends is None else tuple(_trimmed(end) for end in ends)
    if wanted is not None:
        _refuse(wanted, file, section, port)
        wanted = _with_follows(wanted, ends_of(root, section, port) or ())
    before = said_ends(root.get(section, port), section)
    said = None if wanted is None else [data_of(end, section) for end in wanted]
    if repr(before) == repr(said):
        return text
    try:
        if wanted is None:
            changed = remove_port(body, section, port)
        elif before is None:
            order = [p.name for p in (model.inputs if section == "inputs" else model.outputs)]
            changed = add_port(body, section, order, port, value_text(body, wanted, section))
        else:
            changed = change_value(body, (section, port), ends_of(root, section, port) or (), wanted)
    except CannotEdit as problem:
        raise CannotEdit(_where(root, file, section, port) + str(problem)) from None
    _verify(root, changed, file, section, port, said)
    return text[: len(text) - len(body)] + changed


def _section_of(root: YamlNode, file: str, model: Model, port: str, ends: Sequence[WireEnd] | None) -> str:
    """The section of ``port``.  A port that is to be removed can also be in the wrong section."""
    own = [
        section
        for section, ports in (("inputs", model.inputs), ("outputs", model.outputs))
        if any(port == p.name for p in ports)
    ]
    for section in ("inputs", "outputs"):
        node = root.get(section)
        if node is not None and not node.is_mapping and node.value is not None:
            span = root.key_span(section)
            raise CannotEdit(f"{file}:{span.line}: '{section}' is not a map of ports: correct this in an editor first")
    written = [section for section in (*own, *REFERENCE) if root.get(section, port) is not None]
    if ends is None and written:
        return written[0]
    if not own:
        raise CannotEdit(f"{file}: {model.name} has no port '{port}'")
    return own[0]


def _refuse(ends: Sequence[WireEnd], file: str, section: str, port: str) -> None:
    texts = [
        text
        for end in ends
        for text in (end.reference, end.scale, end.offset, *(end.limits or ()), end.unit, end.follows)
    ]
    if any("\ud800" <= character <= "\udfff" for character in "".join((port, *texts))):
        # A surrogate is half of a character beyond U+FFFF.  PyYAML's own parser accepts it, libyaml does not.
        raise CannotEdit(f"{file}: a name or value for '{section}' is not valid text")
    if section == "inputs" and len(ends) != 1:
        raise CannotEdit(f"{file}: input '{port}' must be bound to one component, not to {len(ends) or 'none'}")
    if section == "outputs" and any(end.reference == UNCONNECTED for end in ends):
        raise CannotEdit(f"{file}: '{UNCONNECTED}' is not a component to which output '{port}' can be bound")


def _where(root: YamlNode, file: str, section: str, port: str) -> str:
    section_node = root.get(section)
    if section_node is None:
        return f"{file}: '{port}' cannot be changed here: "
    span = section_node.key_span(port) if port in section_node else root.key_span(section)
    return f"{file}:{span.line}: '{port}' cannot be changed here: "


def _verify(root: YamlNode, changed: str, file: str, section: str, port: str, said: object) -> None:
    """Raises :class:`CannotEdit` unless ``changed`` has the wanted binding and otherwise the same data as before."""
    problems = Diagnostics()
    after = parse_yaml(changed, file, problems)
    if (
        after is None
        or repr(_others(after, section, port)) != repr(_others(root, section, port))
        or repr(said_ends(after.get(section, port), section)) != repr(said)
    ):
        raise CannotEdit(_where(root, file, section, port) + "EPG cannot edit this form: change it in an editor")


def _others(root: YamlNode, section: str, port: str) -> list[Any]:
    ports = [(key, node.plain()) for key, node in (root[section].items() if section in root else ()) if key != port]
    return [ports, *((key, node.plain()) for key, node in root.items() if key != section)]


def _trimmed(end: WireEnd) -> WireEnd:
    limits = None if end.limits is None else (end.limits[0].strip(), end.limits[1].strip())
    return WireEnd(
        end.reference.strip(), end.scale.strip(), end.offset.strip(), limits, end.unit.strip(), end.follows.strip()
    )


def _with_follows(wanted: tuple[WireEnd, ...], old: Sequence[WireEnd]) -> tuple[WireEnd, ...]:
    """``wanted`` with the ``follows`` of the same setpoint in the file, which forms for conversions do not have."""
    if len(wanted) != 1 or len(old) != 1 or wanted[0].follows or wanted[0].reference != old[0].reference:
        return wanted
    return (replace(wanted[0], follows=old[0].follows),)
