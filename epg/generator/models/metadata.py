# SPDX-License-Identifier: Apache-2.0
"""Reads metadata beside the sources of a model, and compares it with the sources.

EPG uses the sources if both differ: users rename prefixes in the sources, or export again without the metadata.  A
difference is reported as a warning that names both values.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TypeVar

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.models.assignments import PortLine, assignments, exact_number, number, port_lines
from epg.generator.models.export_configuration import (
    ExportConfiguration,
    find_configuration,
    load_configuration,
    load_model_description,
)
from epg.generator.models.folders import FMU_DESCRIPTION, entries
from epg.generator.models.model import Model, Port
from epg.generator.models.neighbours import SOURCE_FOLDERS
from epg.generator.models.ports import make_parameters
from epg.generator.models.tokens import Tokens, is_tokens_file, load_tokens
from epg.generator.source import Span

_Found = TypeVar("_Found")
_MOST_NOTES = 10  # parameters with another value that a warning names; there can be hundreds


@dataclass(frozen=True)
class Metadata:
    """The metadata that was found beside a model's sources."""

    tokens: Tokens | None
    configuration: ExportConfiguration | None
    description: ExportConfiguration | None
    considered: tuple[Path, ...] = ()
    """All files beside the sources that have such names: those that were read, and those that were chosen."""

    @property
    def files(self) -> tuple[Path, ...]:
        return tuple(item.path for item in (self.tokens, self.configuration, self.description) if item is not None)

    @property
    def version(self) -> str:
        return self.tokens.trimmed("GENERATION_BUILD") if self.tokens else ""

    def port_elements(self, memory: str) -> tuple[list[PortLine], list[PortLine]] | None:
        """The array elements of the inputs and of the outputs, for sources of an FMU.  None if no file states them.

        ``memory`` is the name of the array in which a value reference is an index.
        """
        if self.tokens and {"INPUT_TO_VARIABLE_EQUATIONS", "VARIABLE_TO_OUTPUT_EQUATIONS"} <= self.tokens.values.keys():
            return (
                port_lines(self.tokens.code("INPUT_TO_VARIABLE_EQUATIONS"), "input", "u"),
                port_lines(self.tokens.code("VARIABLE_TO_OUTPUT_EQUATIONS"), "output", "y"),
            )
        source = self.configuration or self.description
        if source is None:
            return None
        result: tuple[list[PortLine], list[PortLine]] = ([], [])
        for direction, lines in zip(("input", "output"), result, strict=True):
            ports = sorted((port for port in source.ports if port.direction == direction), key=lambda port: port.name)
            for position, port in enumerate(ports):
                array = port.array or memory
                lines.append(PortLine(port.name, port.unit, position, array, port.index, port.span))
        return result


def find_metadata(main: Path, name: str, diagnostics: Diagnostics) -> Metadata:
    """The metadata beside the source file ``main`` of the model ``name``.  Warns of files that cannot be read."""
    directory = main.parent
    folders = [directory, directory.parent] if directory.name.lower() in SOURCE_FOLDERS else [directory]
    tokens = _first(_find_tokens(folder, main, name, diagnostics) for folder in folders)
    path = _first(find_configuration(folder) for folder in folders)
    described = _first(folder / FMU_DESCRIPTION for folder in folders if (folder / FMU_DESCRIPTION).is_file())
    return Metadata(
        tokens,
        load_configuration(path, diagnostics) if path else None,
        load_model_description(described, diagnostics) if described else None,
        (
            *(file for folder in folders for file in entries(folder) if is_tokens_file(file)),
            *filter(None, (path, described)),
        ),
    )


def _first(found: Iterable[_Found | None]) -> _Found | None:
    return next((item for item in found if item is not None), None)


def _find_tokens(folder: Path, main: Path, name: str, diagnostics: Diagnostics) -> Tokens | None:
    """The tokens in a folder: those with the name of the source file, else those of the model ``name``, else any."""
    files = [entry for entry in entries(folder) if is_tokens_file(entry) and entry.is_file()]
    candidates = _named(files, f"{main.stem}_tokens") or _named(files, "tokens") or files
    loaded = [load_tokens(file, diagnostics, required=False) for file in candidates]
    good = [item for item in loaded if item is not None]
    return _first([*(item for item in good if item.trimmed("SUBMODEL_NAME") == name), *good])


def _named(files: Iterable[Path], stem: str) -> list[Path]:
    return [file for file in files if file.stem.casefold() == stem.casefold()]


def cross_check(model: Model, prefix: str, metadata: Metadata, diagnostics: Diagnostics) -> bool:
    """Warns of each difference between ``model`` and its metadata.

    Returns True if the tokens belong to this export of the model: names of ports and parameters, method and step agree.
    """
    tokens, configuration = metadata.tokens, metadata.configuration
    same = tokens is None or _check_tokens(model, prefix, tokens, diagnostics)
    if configuration:
        if exact_number(configuration.step) not in (None, model.step):
            text = f"step size {configuration.step} s, but the sources have {float(model.step)!r} s"
            _differs(configuration.path, configuration.step_span, text, model.span, diagnostics)
        for direction, ports in (("input", model.inputs), ("output", model.outputs)):
            _check_configured(configuration, direction, ports, model.span, diagnostics)
    return same


def _check_tokens(model: Model, prefix: str, tokens: Tokens, diagnostics: Diagnostics) -> bool:
    """Warns of each difference between ``model`` and its tokens.  Returns True if the tokens belong to this export."""
    different = [*_different_ports(model, tokens), *_different_settings(model, tokens)]
    for token, text in different:
        _differs(tokens.path, tokens.span(token), text, model.span, diagnostics)
    if not different:
        _check_values(model, tokens, diagnostics)
    for token, text in _different_names(model, prefix, tokens):
        _differs(tokens.path, tokens.span(token), text, model.span, diagnostics)
    return not different


def _different_ports(model: Model, tokens: Tokens) -> Iterator[tuple[str, str]]:
    """The tokens with other ports than ``model``, each with its difference as text."""
    for kind, ports in (("INPUT", model.inputs), ("OUTPUT", model.outputs)):
        names = [port.name for port in ports]
        token = f"{kind}_NAMES3" if f"{kind}_NAMES3" in tokens.values else f"{kind}_NAMES"
        told = [name for name in tokens.names(kind) if name]
        if token in tokens.values and told != names:
            order = ("in the order ", "the order ") if sorted(told) == sorted(names) else ("", "")
            text = f"{kind.lower()}s {order[0]}{_listed(told)}, but the sources have {order[1]}{_listed(names)}"
            yield token, text


def _different_settings(model: Model, tokens: Tokens) -> Iterator[tuple[str, str]]:
    """The same for tokens without a parameter of ``model``, with another method, or with another step."""
    listed = {name for name in tokens.names("PARAMETER") if name}
    missing = [parameter.name for parameter in model.parameters if parameter.name not in listed]
    if listed and missing:
        yield "PARAMETER_NAMES3", f"no parameter '{missing[0]}', which the sources have"
    method, step = tokens.trimmed("INTEGRATION_METHOD_NAME"), tokens.trimmed("TIME_STEP_SIZE")
    if method and method != model.method:
        yield "INTEGRATION_METHOD_NAME", f"integration method '{method}', but the sources have '{model.method}'"
    if step and exact_number(step) != model.step:
        yield "TIME_STEP_SIZE", f"step size {step} s, but the sources have {float(model.step)!r} s"


def _different_names(model: Model, prefix: str, tokens: Tokens) -> Iterator[tuple[str, str]]:
    """The same for names that users change in the sources of an export."""
    stated = tokens.trimmed("VARPREFIX")
    if "VARPREFIX" in tokens.values and stated != prefix:
        yield "VARPREFIX", f"prefix '{stated}', but the sources have '{prefix}'"
    name = tokens.trimmed("SUBMODEL_NAME")
    if name not in ("", model.name):
        yield "SUBMODEL_NAME", f"submodel '{name}', but the sources have '{model.name}'"


def _check_values(model: Model, tokens: Tokens, diagnostics: Diagnostics) -> None:
    """Warns, with one warning, of parameters that have other values in the tokens."""
    lines = list(assignments(tokens.code("INITIALIZE_PARAMETERS")))
    told = [(item.name, item.value, item.span) for item in make_parameters(lines, tokens.names("PARAMETER"), ())[0]]
    for name, (text, span) in zip(tokens.names("PARAMETER"), tokens.lines("PARAMETER_VALUES")):
        told += [(name, value, span)] if (value := number(text)) is not None else []
    known = {parameter.name: parameter for parameter in model.parameters}
    values = {
        name: (value, span) for name, value, span in reversed(told) if name in known and value != known[name].value
    }
    different = [(own, *values[own.name]) for own in model.parameters if own.name in values]
    warn_of_values(
        tokens.path.name, [(span, value, own.value, own.name, own.span) for own, value, span in different], diagnostics
    )


def warn_of_values(
    file: str, different: Sequence[tuple[Span, float, float, str, Span]], diagnostics: Diagnostics
) -> None:
    """Warns, with one warning, of parameters that have another value in ``file`` than in the sources.

    Each item of ``different`` is one parameter: its place and value in ``file``, then its value, name and place in the
    sources.
    """
    if not different:
        return
    span, there, here, name, place = different[0]
    notes = [Note("the sources", place)]
    for _, other, own, title, where in different[1:_MOST_NOTES]:
        notes.append(Note(f"'{title}' is {other!r} there, but {own!r} here", where))
    more = len(different) - 1
    rest = f", and {more} more {'differ' if more > 1 else 'differs'}" if more else ""
    text = f"parameter '{name}' = {there!r}, but the sources have {here!r}{rest}"
    _differs(Path(file), span, text, place, diagnostics, notes)


def _check_configured(
    configuration: ExportConfiguration, direction: str, ports: Sequence[Port], sources: Span, diagnostics: Diagnostics
) -> None:
    """Warns of ports that are only in the configuration or only in the sources."""
    told = {port.name: port for port in configuration.ports if port.direction == direction}
    names = {port.name for port in ports}
    for name in sorted(names - told.keys()):
        span = Span(str(configuration.path), 1, 1, 2)
        _differs(configuration.path, span, f"no {direction} '{name}', but the sources have one", sources, diagnostics)
    for name in sorted(told.keys() - names):
        text = f"the {direction} '{name}', but the sources do not have it"
        _differs(configuration.path, told[name].span, text, sources, diagnostics)


def _differs(
    file: Path, span: Span, text: str, sources: Span, diagnostics: Diagnostics, notes: Sequence[Note] = ()
) -> None:
    hint = "EPG uses the sources; export the model again so that both agree"
    notes = notes or [Note("the sources", sources)]
    diagnostics.warning("stale-metadata", span, f"'{file.name}' has {text}", hint=hint, notes=notes)


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) if names else "(none)"
