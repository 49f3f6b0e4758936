# SPDX-License-Identifier: Apache-2.0
"""The text of bindings files: a new file, or an existing file after the model was exported again.

An update changes only the lines of ports that the model gained or lost.  All other text stays as the user wrote it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from epg.edit.scalars import scalar_text
from epg.edit.section import add_open_port, add_port, comment_out_port, open_port, open_section
from epg.edit.yaml_edit import CannotEdit
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.schema import load_schema, validate
from epg.generator.documents.yaml_file import parse_yaml
from epg.generator.models.model import Model
from epg.generator.resolve.matching import Match
from epg.generator.source import YamlNode


@dataclass(frozen=True)
class BindingsUpdate:
    """An updated bindings file.

    ``added`` are the new ports that were bound by their names, ``removed`` the ports that the model lost, and
    ``open`` the new ports that the user must bind.
    """

    text: str
    added: tuple[str, ...]
    removed: tuple[str, ...]
    open: tuple[str, ...]


def new_bindings(model: Model, matches: Mapping[str, Match]) -> str:
    """The text of a bindings file for ``model``.  A port without a match is a comment that names the candidates."""
    lines = ["version: 1", f"model: {scalar_text(model.name)}"]
    for section, ports in (("inputs", model.inputs), ("outputs", model.outputs)):
        if ports:
            is_empty = all(matches[port.name].reference is None for port in ports)
            lines.append(open_section(section) if is_empty else f"{section}:")
            lines += [f"  {_line(matches[port.name])}" for port in ports]
    return "\n".join(lines) + "\n"


def updated_bindings(
    text: str, file: str, model: Model, matches: Mapping[str, Match], diagnostics: Diagnostics
) -> BindingsUpdate | None:
    """Returns ``text`` with a line for each new port, and with the lines of removed ports commented out.

    Returns None if ``text`` has a mistake, which is reported in ``diagnostics``.  Raises
    :class:`~epg.edit.yaml_edit.CannotEdit` if EPG cannot edit the way in which ``text`` is written.
    """
    root = parse_yaml(text, file, diagnostics)
    if root is None or not validate(root, load_schema("bindings"), diagnostics):
        return None
    added: list[str] = []
    removed: list[str] = []
    left: list[str] = []
    wanted = root.plain()
    before = text
    for section, names, name, is_new in _differences(root, model):
        if not is_new:
            text = comment_out_port(text, section, name, "no longer a port of the model")
            removed.append(name)
            del wanted[section][name]
            continue
        match = matches[name]
        if match.reference:
            text = add_port(text, section, names, name, _value(match))
            added.append(name)
            follows = {"from": match.reference, "follows": match.follows}
            wanted.setdefault(section, {})[name] = follows if match.follows else match.reference
        else:
            text = add_open_port(text, section, names, name, _possible(match))
            left.append(name)
    after = parse_yaml(text, file, Diagnostics())
    # Parse the edited text again, to be sure that only the wanted ports changed.  Maps are equal in any order.  Python
    # treats 1 and true as equal, too, but no edit above turns one into the other.
    if text != before and (after is None or after.plain() != wanted):
        raise CannotEdit(f"{file}: EPG cannot edit this form: write one 'port: component' on each line")
    return BindingsUpdate(text, tuple(added), tuple(removed), tuple(left))


def _differences(root: YamlNode, model: Model) -> Iterator[tuple[str, list[str], str, bool]]:
    """The ports that only the file or only the model has: section, the model's ports in it, name, True if it is new."""
    for section, ports in (("inputs", model.inputs), ("outputs", model.outputs)):
        names = [port.name for port in ports]
        written = [key for key, _ in root[section].items()] if section in root else []
        for name in written:
            if name not in names:
                yield section, names, name, False
        for name in names:
            if name not in written:
                yield section, names, name, True


def _line(match: Match) -> str:
    if match.reference:
        return f"{scalar_text(match.port.name)}: {_value(match)}"
    return open_port(match.port.name, _possible(match))


def _possible(match: Match) -> tuple[str, ...]:
    """The component ports that the user can choose: those that fit and are free, the best first, if there are any."""
    return match.fitting or match.candidates


def _value(match: Match) -> str:
    """The YAML text of a binding."""
    if not match.follows:
        return str(match.reference)
    return f"{{from: {match.reference}, follows: {scalar_text(match.follows)}}}"
