# SPDX-License-Identifier: Apache-2.0
"""The common part of the importers of exports of 20-sim in C and in C++."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from epg.generator.diagnostics import Diagnostics
from epg.generator.models.assignments import ArrayAssignment, PortLine, exact_number, is_step, port_lines
from epg.generator.models.c_code import CFile, Function
from epg.generator.models.code_parts import SourceRange
from epg.generator.models.features import check_tokens
from epg.generator.models.link import Linked
from epg.generator.models.metadata import Metadata, cross_check
from epg.generator.models.model import Model, Port
from epg.generator.source import Span

_MOST_PARAMETERS = 16  # parameters of a function that are parsed; functions of exports have four


def parameters_of(function: Function) -> list[str]:
    """The declarations of the parameters of ``function``."""
    return function.parameters.split(",")[:_MOST_PARAMETERS]


class ExportReader:
    """Reads the model from the linked files of one export.  ``whole`` is the place of the whole model."""

    whole: Span
    metadata: Metadata

    def __init__(self, linked: Linked, diagnostics: Diagnostics) -> None:
        self.linked = linked
        self.diagnostics = diagnostics
        self.main = linked.main
        self.file = linked.main.file

    def heading(self, word: str, form: str) -> str:
        """The text after ``word:`` in the comment at the top of a file, in the first file that has it; else empty."""
        for code in self.linked.all:
            match = re.search(rf"^[ \t]*\*[ \t]*{word}:[ \t]*({form})", code.file.text[:4000], re.MULTILINE)
            if match and match[1].strip():
                return match[1].strip()
        return ""

    def version(self) -> str:
        return self.heading("build", r"[\d.]+") or self.metadata.version

    def checked_step(self, place: tuple[Span, str] | None, hint: str) -> Fraction | None:
        """The step in seconds whose text is at ``place``.  None, after an error, if it is not the step of a model."""
        value = exact_number(place[1]) if place else None
        if is_step(value):
            return value
        span, message = self.whole, "the model has no step size"
        if place:
            span, message = place[0], f"the step size '{place[1][:80]}' is not a positive number"
        self.diagnostics.error("model-step", span, message, hint=hint)
        return None

    def port_lines(self, functions: Iterable[tuple[CFile, Function]], direction: str) -> list[PortLine]:
        """The lines of ``functions`` that connect their vectors of inputs or of outputs with the model."""
        return [
            line
            for code, function in functions
            for vector in _vectors(function)
            for line in port_lines(code.file, direction, vector, function.body_start, function.body_end)
        ]

    def places(self, groups: Iterable[Iterable[ArrayAssignment]]) -> tuple[tuple[SourceRange, ...], ...]:
        """The places of the values of parameters.  Each group has the lines that set one parameter."""
        return tuple(
            tuple(SourceRange(Path(line.span.file), line.value_start, line.value_end) for line in group)
            for group in groups
        )

    def common(self, ports: Sequence[tuple[Port, ...]]) -> dict[str, Any]:
        """The attributes of :class:`Model` that are found in the same way in C and in C++."""
        return {
            "version": self.version(),
            "inputs": ports[0],
            "outputs": ports[1],
            "directory": self.file.path.parent,
            "files": tuple(sorted({code.file.path for code in self.linked.all} | set(self.metadata.files))),
            "span": self.whole,
            "searched": self.linked.searched,
            "considered": tuple(sorted({*self.linked.considered, *self.metadata.considered})),
        }

    def agrees(self, model: Model, prefix: str) -> bool:
        """Compares ``model`` with its metadata.  False, after an error, if a target cannot run it."""
        before = self.diagnostics.error_count
        tokens = self.metadata.tokens
        if tokens and cross_check(model, prefix, self.metadata, self.diagnostics):
            check_tokens(tokens, self.diagnostics)
        return self.diagnostics.error_count == before


def _vectors(function: Function) -> Iterator[str]:
    """The names of the parameters of ``function`` that are pointers or arrays."""
    for parameter in parameters_of(function):
        match = re.search(r"[* ](\w+) ?(?:\[ ?\])?$", " ".join(parameter.split()))
        if match and ("*" in parameter or "[" in parameter):
            yield match[1]
