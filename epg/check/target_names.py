# SPDX-License-Identifier: Apache-2.0
"""Names that a target gives to others: C symbols, types, headers and CMake targets must not hide any of theirs."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from epg.catalog.hardware import Target
from epg.check.configuration import Configuration
from epg.check.names import (
    STANDARD_HEADERS,
    STANDARD_TYPES,
    STATIC_NAMES,
    SYSTEM_LIBRARIES,
    cmake_path_problem,
    identifier_problem,
)
from epg.diagnostics import Diagnostics
from epg.source import Span


def check_name(name: str, span: Span, diagnostics: Diagnostics) -> None:
    """A target's name becomes the prefix of C symbols, the name of a header and a CMake target."""
    problem = identifier_problem(name)
    if problem is None and name in STANDARD_HEADERS:
        problem = f"would make a header '{name}.h', which hides the C library's: choose another name"
    elif problem is None and name in SYSTEM_LIBRARIES:
        problem = (
            "is the name of a system library: CMake would link this target wherever that is meant; choose another name"
        )
    elif problem is None and {f"{name}_inputs", f"{name}_outputs"} & STATIC_NAMES:
        problem = f"would make a symbol '{name}_outputs', which generated code has inside: choose another name"
    if problem:
        diagnostics.error("invalid-name", span, f"target '{name}' {problem}")


def check_library_name(name: str, span: Span, diagnostics: Diagnostics) -> None:
    """The name of a model's library also becomes a type ``<name>_t``."""
    check_name(name, span, diagnostics)
    if f"{name}_t" in STANDARD_TYPES:
        message = f"target '{name}' would make a type '{name}_t', which is one of the C library's"
        diagnostics.error("invalid-name", span, message, hint=f"choose another name, such as {name}_model")


def check_sdk_headers(name: str, target: Target, span: Span, diagnostics: Diagnostics) -> None:
    """No generated header hides one of the SDK's."""
    for header in sorted(_generated_headers(name).intersection(target.platform.headers)):
        message = f"target '{name}' makes a header '{header}', which would hide one that {target.name} needs"
        diagnostics.error("invalid-name", span, message, hint=f"choose another name, such as {name}_robot")


def _generated_headers(name: str) -> set[str]:
    ends = ("", "_version", "_model", "_model_export", "_model_names", "_plant", "_plant_export")
    return {f"{name}{end}.h" for end in ends}


def check_driver_headers(name: str, configuration: Configuration, diagnostics: Diagnostics) -> None:
    """No generated header is called like one of a driver that it is compiled with."""
    generated = _generated_headers(name)
    for component in configuration.components.values():
        for header in sorted(generated.intersection(component.kind.headers)):
            message = f"component '{component.name}' needs a header '{header}', and target '{name}' makes one"
            diagnostics.error("invalid-name", component.span, message, hint="choose another name for the target")
    communication = configuration.communication
    for middleware in communication.middlewares:
        for header in sorted(generated.intersection(middleware.headers)):
            message = f"middleware '{middleware.name}' needs a header '{header}', and target '{name}' makes one"
            diagnostics.error("invalid-name", communication.span, message, hint="choose another name for the target")


def check_paths(paths: Iterable[Path], diagnostics: Diagnostics) -> None:
    """Paths that CMake is told can be named there, and in the files that it writes for Ninja and Make."""
    for path in sorted(paths):
        text = str(path.absolute())
        problem = cmake_path_problem(text)
        if problem:
            message = f"'{text}' cannot be named in CMake: {problem}"
            diagnostics.error("invalid-name", Span(str(path)), message, hint="rename the file or its folder")
            return
