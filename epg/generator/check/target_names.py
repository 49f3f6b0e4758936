# SPDX-License-Identifier: Apache-2.0
"""Checks the names that are made of a target's name: C symbols, types, headers and CMake targets.

None of them may hide a symbol, type, header or library of others.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from epg.generator.catalog.catalog import Catalog
from epg.generator.catalog.hardware import Computer
from epg.generator.check.configuration import Configuration
from epg.generator.check.names import (
    STANDARD_HEADERS,
    STANDARD_TYPES,
    SYSTEM_LIBRARIES,
    cmake_path_problem,
    identifier_problem,
    name_hint,
    near_name,
)
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span


def check_name(name: str, span: Span, diagnostics: Diagnostics) -> None:
    """Checks a target's name, which becomes the prefix of C symbols, and the name of a header and of a CMake target."""
    problem = identifier_problem(name)
    if problem is None and name in STANDARD_HEADERS:
        problem = f"would generate a header '{name}.h', which hides the one of the C library: choose another name"
    elif problem is None and name in SYSTEM_LIBRARIES:
        problem = (
            "has the name of a system library: CMake would link the target instead of the library; choose another name"
        )
    if problem:
        hint = name_hint(near_name(name, identifier_problem), name)
        diagnostics.error("invalid-name", span, f"target '{name}' {problem}", hint=hint)


def check_library_name(name: str, span: Span, diagnostics: Diagnostics) -> None:
    """Checks the name of a model's library, which also becomes the name of a type ``<name>_t``."""
    check_name(name, span, diagnostics)
    if f"{name}_t" in STANDARD_TYPES:
        message = f"target '{name}' would generate a type '{name}_t', which the C library already has"
        diagnostics.error("invalid-name", span, message, hint=f"choose another name, such as {name}_model")


def check_sdk_headers(name: str, target: Computer, span: Span, diagnostics: Diagnostics) -> None:
    """Reports a generated header that would hide a header of the SDK."""
    for header in sorted(_generated_headers(name).intersection(target.platform.headers)):
        message = f"target '{name}' would generate a header '{header}', which hides one that {target.name} needs"
        diagnostics.error("invalid-name", span, message, hint=f"choose another name, such as {name}_robot")


def proposed_name(name: str, catalog: Catalog) -> str:
    """``name``, or ``<name>_robot`` if EPG refuses ``name`` for some targets because of a header or a library."""
    targets = (catalog.find_target(target) for target in catalog.target_names())
    hidden = frozenset(header for target in targets if target is not None for header in target.platform.headers)
    problems = Diagnostics()
    check_name(name, Span.of_argument(name), problems)
    return f"{name}_robot" if problems.error_count or not hidden.isdisjoint(_generated_headers(name)) else name


def _generated_headers(name: str) -> set[str]:
    ends = ("", "_version", "_model", "_model_export", "_model_names", "_plant", "_plant_export")
    return {f"{name}{end}.h" for end in ends}


def check_driver_headers(name: str, configuration: Configuration, diagnostics: Diagnostics) -> None:
    """Reports a generated header that has the name of a driver's header in the same target."""
    generated = _generated_headers(name)
    communication = configuration.communication
    parts = [(f"component '{c.name}'", c.kind.headers, c.span) for c in configuration.components.values()]
    parts += [(f"middleware '{m.name}'", m.headers, communication.span) for m in communication.middlewares]
    for part, headers, span in parts:
        for header in sorted(generated.intersection(headers)):
            message = f"{part} needs a header '{header}', which target '{name}' also generates"
            diagnostics.error("invalid-name", span, message, hint="choose another name for the target")


def check_paths(paths: Iterable[Path], diagnostics: Diagnostics) -> None:
    """Reports the first path that cannot be used in CMake's files, or in those that it writes for Ninja and Make."""
    for path in sorted(paths):
        text = str(path.absolute())
        problem = cmake_path_problem(text)
        if problem:
            message = f"'{text}' cannot be used in CMake: {problem}"
            diagnostics.error("invalid-name", Span(str(path)), message, hint="rename the file or its folder")
            return
