# SPDX-License-Identifier: Apache-2.0
"""Reads the targets that CMake has made in a build folder, from the record that cmake/EPGConnect.cmake has written.

A line of the record is the name of a function, or a tab and one of its arguments.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from pathlib import Path

from epg.connect.build_folders import BuildFolder
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.text_file import is_file, read_text
from epg.generator.project import Request, request_of_options

RECORD = "CMakeFiles/epg/calls.txt"


@dataclass(frozen=True)
class RecordedCalls:
    """The targets by name, and the names of the executables of each target."""

    requests: Mapping[str, Request] = field(default_factory=dict)
    executables: Mapping[str, list[str]] = field(default_factory=dict)

    def below(self, folder: Path) -> dict[str, Request]:
        """The targets of the CMakeLists.txt files in ``folder`` and below."""
        return {name: request for name, request in self.requests.items() if request.beside.is_relative_to(folder)}


def recorded_calls(build: BuildFolder) -> RecordedCalls:
    """The calls of the last configuration of a build folder; none if CMake has not run there."""
    path = (build.image or build.path) / RECORD
    text = (read_text(path, Diagnostics()) if is_file(path) else None) or ""
    requests: dict[str, Request] = {}
    executables: dict[str, list[str]] = {}
    for call in text.split("\nepg_"):
        function, *words = call.strip("\n").split("\n\t")
        if function.endswith("add_executable") and len(words) == 2:
            executables.setdefault(words[1].removeprefix("EPG::"), []).append(words[0])
        elif function.endswith("add_target") and len(words) % 2:
            request = _request(words[0], list(zip(words[1::2], words[2::2])))
            if request is not None:
                requests[request.name] = request
    return RecordedCalls(requests, executables)


def _request(name: str, options: list[tuple[str, str]]) -> Request | None:
    """The target of one call; None if an option is missing.

    ``options`` are those of ``epg generate``, and ``--targets-path``.
    """
    values = {option.removeprefix("--").replace("-", "_"): value for option, value in options}
    if not {"tcf", "model", "bindings", "beside", "caller"} <= values.keys():
        return None
    settings = [value for option, value in options if option == "--set"]
    roots = tuple(Path(value) for option, value in options if option == "--targets-path")
    return request_of_options(name, values, settings, roots)
