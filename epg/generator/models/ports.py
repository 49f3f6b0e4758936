# SPDX-License-Identifier: Apache-2.0
"""Makes the ports and parameters of a :class:`~epg.generator.models.model.Model` from its sources and metadata."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.text_file import one_line
from epg.generator.models.assignments import ArrayAssignment, PortLine, number
from epg.generator.models.export_configuration import ExportConfiguration
from epg.generator.models.identifiers import to_identifier, unique_identifiers, unique_titles
from epg.generator.models.model import Parameter, Port
from epg.generator.source import Span

_VECTORS = {"input": "u", "output": "y"}
"""The name that 20-sim gives to the vector of all ports of a direction."""


def make_ports(
    lines: Iterable[PortLine],
    direction: str,
    names: Sequence[tuple[str, Span]],
    configuration: ExportConfiguration | None,
    diagnostics: Diagnostics,
    whole: Span,
    expected: int | None = None,
) -> tuple[Port, ...]:
    """The ports in the order of their indices.  Empty, after an error, if a port is missing or there are too many.

    ``names`` are the names, by index, for lines without a comment.  ``expected`` is the number of ports that the
    sources state, or None.  ``whole`` is the place of the model.
    """
    by_index: dict[int, PortLine] = {}
    for line in lines:
        by_index.setdefault(line.index, line)
    count = max(by_index, default=-1) + 1 if expected is None else expected
    if not _are_complete(by_index, count, direction, whole, diagnostics):
        return ()
    given = [name for name, _ in names] if len(names) == count else [""] * count
    return tuple(_port(by_index[i], i, direction, given[i], configuration, diagnostics) for i in range(count))


def _are_complete(
    lines: Mapping[int, PortLine], count: int, direction: str, whole: Span, diagnostics: Diagnostics
) -> bool:
    """True if the lines connect the first ``count`` elements of the vector and no others.  Reports an error if not."""
    vector = _VECTORS[direction]
    most = min(count, len(lines) + 8)  # a wrong count can be very large: the message names at most eight elements
    missing = [index for index in range(most) if index not in lines]
    surplus = sorted(index for index in lines if index >= count)
    if not missing and not surplus:
        return True
    listed = ", ".join(f"{vector}[{index}]" for index in (missing or surplus)[:8])
    what = f"no line connects {listed} to the model" if missing else f"there are also lines for {listed}"
    message = f"the model has {count} {direction}{'' if count == 1 else 's'}, but {what}"
    hint = "export the model again, or undo the changes in its generated code"
    diagnostics.error("model-ports", whole, message, hint=hint)
    return False


def _port(
    line: PortLine,
    index: int,
    direction: str,
    given: str,
    configuration: ExportConfiguration | None,
    diagnostics: Diagnostics,
) -> Port:
    """The port of one line.  ``given`` is the name of a line without a comment."""
    name = line.name or given
    if not name:
        vector = _VECTORS[direction]
        name = f"{vector}{index}"
        message = f"the comment with the name of {vector}[{index}] is missing: the port is called '{name}'"
        hint = "keep the comments that 20-sim writes after these lines, or keep tokens.xml"
        diagnostics.warning("model-port-unnamed", line.span, message, hint=hint)
    configured = configuration.port(direction, name) if configuration else None
    title = one_line(name)
    return Port(
        title,
        to_identifier(title),
        direction,
        one_line(line.unit or (configured.unit if configured else "")),
        configured.type if configured else "real",
        index,
        line.span,
        one_line(configured.description if configured else ""),
    )


def check_identifiers(ports: Sequence[Port], diagnostics: Diagnostics) -> None:
    """Reports two ports of one direction that have the same name, or whose names become the same C identifier."""
    first: dict[str, Port] = {}
    for port in ports:
        other = first.setdefault(port.identifier, port)
        if other is port:
            continue
        message = f"{port.direction} '{port.name}' exists twice"
        if other.name != port.name:
            both = f"{port.direction}s '{other.name}' and '{port.name}'"
            message = f"{both} have the same C identifier '{port.identifier}'"
        notes = [Note(f"'{other.name}' is here", other.span)]
        diagnostics.error("model-port-collision", port.span, message, hint="rename one of them in 20-sim", notes=notes)


def make_parameters(
    lines: Sequence[ArrayAssignment], names: Sequence[str], units: Sequence[str]
) -> tuple[tuple[Parameter, ...], tuple[tuple[ArrayAssignment, ...], ...]]:
    """The parameters in the order of their indices, and for each parameter all lines that set it.

    Parameters that hold a string, such as the name of a file or of a dynamic library, are left out.
    """
    by_index: dict[int, list[ArrayAssignment]] = {}
    for line in lines:
        if number(line.value) is not None:
            by_index.setdefault(line.index, []).append(line)
    chosen = [by_index[index][-1] for index in sorted(by_index)]
    titles = unique_titles(one_line(_title(line, names)) for line in chosen)
    identifiers = unique_identifiers(titles)
    parameters = []
    for line, title, identifier in zip(chosen, titles, identifiers, strict=True):
        value = number(line.value)
        assert value is not None
        unit = line.unit or (units[line.index] if line.index < len(units) else "")
        parameters.append(Parameter(title, identifier, value, one_line(unit), line.index, line.span))
    return tuple(parameters), tuple(tuple(by_index[line.index]) for line in chosen)


def _title(line: ArrayAssignment, names: Sequence[str]) -> str:
    if line.name:
        return line.name
    return names[line.index] if line.index < len(names) and names[line.index] else f"P{line.index}"
