# SPDX-License-Identifier: Apache-2.0
"""Chooses the version of a tool that a project names with ``epg_use_versions()``.

>>> # choose_version(tools["pico_sdk"], "2.2.0", where, tools).folder  ->  "/home/me/.pico-sdk/sdk/2.2.0"
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.tools.find_tool import Surroundings, places, tool_in, version_numbers, version_of
from epg.generator.tools.remedy import get_it
from epg.generator.tools.tools import Tool


@dataclass(frozen=True)
class VersionVariable:
    """The CMake variable that must be set to ``folder``, so that CMake uses this version of a tool.

    Both are empty if a variable names the tool already, or if no version is installed.  In the second case, the search
    for the tool reports it.  ``problem`` is a message if the project cannot have the version that it needs.
    """

    variable: str = ""
    folder: str = ""
    problem: str = ""


def choose_version(tool: Tool, wanted: str, where: Surroundings, tools: Mapping[str, Tool]) -> VersionVariable:
    """Searches version ``wanted`` of a tool among the installed ones."""
    where = _without_empty_places(tool, where)
    others: list[tuple[Path, str]] = []
    for place in places(tool, where):
        if place.source == "PATH":
            continue  # A program on PATH needs no variable.
        for folder in place.folders:
            if not place.stated and tool_in(folder, tool, where) is None:
                continue
            version = version_of(tool, folder) if tool.holds else ""
            if wanted in folder.parts or (version and _same(version, wanted)):
                return VersionVariable() if place.stated else VersionVariable(tool.variables[0], folder.as_posix())
            if version:
                others.append((folder, version))
            if place.stated:
                return _other_version(tool, wanted, others, where, tools)
    return _other_version(tool, wanted, others, where, tools)


def _without_empty_places(tool: Tool, where: Surroundings) -> Surroundings:
    """The surroundings without variables that name a folder in which an installer has not put the tool yet."""
    usual = [place.replace("~", where.home.as_posix(), 1) for place in tool.places]
    cmake = {
        name: value
        for name, value in where.cmake.items()
        if name not in tool.variables or Path(value).exists() or not any(Path(value).match(place) for place in usual)
    }
    return replace(where, cmake=cmake)


def _same(version: str, wanted: str) -> bool:
    """True if the numbers at the beginning of ``wanted`` are ``version``.

    2.2.0-a4 is a release of the tools around picotool, and contains picotool 2.2.0.
    """
    numbers = re.match(r"[0-9.]*", wanted)
    return numbers is not None and version_numbers(numbers[0]) == version_numbers(version)


def _other_version(
    tool: Tool, wanted: str, others: list[tuple[Path, str]], where: Surroundings, tools: Mapping[str, Tool]
) -> VersionVariable:
    """The choice if ``wanted`` is not among the installed versions ``others``."""
    if not others or tool.project_version != "required":
        return VersionVariable()
    folder, version = others[0]
    remedy = get_it(tool, where, tools)
    return VersionVariable(
        problem=f"This project is written for version {wanted} of the {tool.title}, but the one in {folder} is "
        f"{version}. {remedy.replace(tool.tested, wanted) if tool.tested else remedy}\n"
        f"Or write {version} in place of {wanted} in CMakeLists.txt."
    )
