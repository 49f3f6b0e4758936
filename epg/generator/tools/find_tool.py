# SPDX-License-Identifier: Apache-2.0
"""Finds an SDK or program.  The order of the places is the same for all tools:

1. The first CMake variable with a value.
2. The first environment variable with a value.
3. ``PATH``, for programs.
4. The places that the tool's own installers use, in the order of its file.
5. CMake's user package registry.
6. EPG's cache.

If a variable names a tool, the tool must be there: EPG does not search other places.  If one place has several folders,
the last one in natural order is used, for which numbers in names are compared by value.

CMake asks with ``epg find-tools``, so that a build and ``epg doctor`` find the same.

>>> # find_tool(tools["pico_sdk"], Surroundings.here(cache_folder())).path
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.text_file import read_text
from epg.generator.tools.tools import Tool

TIMEOUT = 5.0
"""The longest time in seconds that a program may take to print its version."""


@dataclass(frozen=True)
class Surroundings:
    """The inputs of a search: the environment, and the variables ``cmake`` of a CMake cache.

    Without ``run``, programs that variables of CMake name are not started to read their version.  A build folder that
    comes from another person can name any program.
    """

    environment: Mapping[str, str]
    cmake: Mapping[str, str]
    home: Path
    cache: Path
    run: bool = True

    @staticmethod
    def here(cache: Path, cmake: Mapping[str, str] | None = None, *, run: bool = True) -> Surroundings:
        """The surroundings of this process."""
        return Surroundings(os.environ, cmake or {}, Path.home(), cache, run)

    @property
    def path(self) -> str:
        return self.environment.get("PATH", "")


@dataclass(frozen=True)
class Finding:
    """The result of the search for a tool.

    ``status`` is "found", "missing", "old" if the tool is older than needed, or "wrong" if a variable names a place
    without the tool.  In this case, EPG does not search further, because a build would stop there, too.  ``source``
    names the place where the tool was found, ``looked`` all places that were searched.  ``asked`` is False if the
    version is not known because the program must not be started.
    """

    tool: Tool
    status: str
    path: Path | None = None
    source: str = ""
    version: str = ""
    looked: tuple[str, ...] = ()
    asked: bool = True


@dataclass(frozen=True)
class SearchPlace:
    """A place in which EPG searches for a tool.  It is one folder or program, or several: the best one first."""

    source: str
    folders: list[Path]
    stated: bool = False  # a variable names the place: the tool must be there
    of_build: bool = False  # a CMake variable names the place


def find_tool(tool: Tool, where: Surroundings) -> Finding:
    """Searches for ``tool`` in all its places.  The first one found is the result."""
    looked: list[str] = []
    for place in places(tool, where):
        looked.append(place.source)
        for folder in place.folders:
            path = tool_in(folder, tool, where)
            if path is not None:
                asked = where.run or not (place.of_build and tool.programs)
                version = version_of(tool, path) if asked else ""
                old = bool(tool.oldest and version) and version_numbers(version) < version_numbers(tool.oldest)
                return Finding(tool, "old" if old else "found", path, place.source, version, tuple(looked), asked)
        if place.stated:
            return Finding(tool, "wrong", place.folders[0], place.source, looked=tuple(looked))
    return Finding(tool, "missing", looked=tuple(looked))


def read_cmake_cache(path: Path, diagnostics: Diagnostics) -> dict[str, str]:
    """The variables of a ``CMakeCache.txt``, without empty ones and those that end with ``NOTFOUND``."""
    text = read_text(path, diagnostics) or ""
    found = re.findall(r"^([^#/\s][^:=\n]*):[A-Z]+=(.*?)\r?$", text, re.MULTILINE)
    return {name: value for name, value in found if value and not value.endswith("NOTFOUND")}


def places(tool: Tool, where: Surroundings) -> Iterator[SearchPlace]:
    """The places in which EPG searches for a tool, in the order of the module's docstring."""
    for name in tool.variables:
        if where.cmake.get(name):
            yield SearchPlace(f"CMake variable {name}", [_named(tool, where.cmake[name])], stated=True, of_build=True)
    for name in tool.environment:
        if where.environment.get(name):
            yield SearchPlace(f"environment variable {name}", [_named(tool, where.environment[name])], stated=True)
    if tool.programs:
        found = (shutil.which(program, path=where.path) for program in tool.programs)
        yield SearchPlace("PATH", [Path(program) for program in found if program])
    for pattern in tool.places:
        yield SearchPlace(pattern, _matches(pattern, where.home))
    if tool.registry:
        yield SearchPlace(f"CMake's package registry ({tool.registry})", _registered(tool, where))
    if tool.cached:
        yield SearchPlace("EPG's cache", _newest_first(where.cache.glob(tool.cached)))


def _named(tool: Tool, value: str) -> Path:
    """The folder or the program that the value of a variable names.  A program can be the name of one in PATH."""
    return Path(os.path.abspath(value)) if tool.holds else Path(value)


def _matches(pattern: str, home: Path) -> list[Path]:
    """The folders that match an absolute pattern, the newest first; ``~`` is the home folder."""
    path = Path(pattern.replace("~", home.as_posix(), 1))
    if not path.is_absolute():  # The place is for another operating system.
        return []
    return _newest_first(Path(path.anchor).glob(path.relative_to(path.anchor).as_posix()))


def _registered(tool: Tool, where: Surroundings) -> list[Path]:
    """The folders of a tool in CMake's user package registry.

    An entry can be a folder inside of the tool; then the result has the folder above it that is the tool's.
    """
    folders = []
    for entry in (where.home / ".cmake/packages" / tool.registry).glob("*"):
        try:
            folder = Path(entry.read_text(encoding="utf-8").strip())
        except (OSError, ValueError):
            continue
        folders += [above for above in (folder, *folder.parents) if (above / tool.holds).is_file()][:1]
    return _newest_first(folders)


def tool_in(folder: Path, tool: Tool, where: Surroundings) -> Path | None:
    """The tool at ``folder``, or None.

    For an SDK it is the folder itself.  For a program, it is a program in the folder or in its ``bin``, or the program
    that ``folder`` names.
    """
    if tool.holds:
        return folder if (folder / tool.holds).is_file() else None
    if folder.is_dir():
        places = [(program, str(place)) for program in tool.programs for place in (folder, folder / "bin")]
    else:  # A program with arguments (CC="gcc -m32"), or a name that must be searched in PATH.
        places = [(str(folder), where.path), (str(folder).split(" ")[0], where.path)]
    found = (shutil.which(program, path=path) for program, path in places)
    return next((Path(path) for path in found if path), None)


def version_of(tool: Tool, path: Path) -> str:
    """The version that the tool states, or ""."""
    text = _said(path) if tool.programs else _read(path / tool.version_file)
    parts = [match[1] for pattern in tool.version_patterns if (match := re.search(pattern, text)) is not None]
    return ".".join(parts) if len(parts) == len(tool.version_patterns) else ""


def _said(program: Path) -> str:
    """The output of a program with ``--version``; empty if it cannot be started or takes too long."""
    try:
        done = subprocess.run(
            [str(program), "--version"],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=TIMEOUT,
            stdin=subprocess.DEVNULL,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout or done.stderr


def _read(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""


def _newest_first(folders: Iterable[Path]) -> list[Path]:
    return sorted(folders, key=lambda folder: _natural(folder.as_posix()), reverse=True)


def _natural(text: str) -> list[tuple[str, int]]:
    """A key for the order of CMake's ``COMPARE NATURAL``: numbers are compared by value, other text by characters."""
    return [("0", int(part)) if part.isdecimal() else (part, 0) for part in re.findall(r"[0-9]+|[^0-9]", text)]


def version_numbers(version: str) -> tuple[int, ...]:
    """The numbers of a version without zeros at the end: 2.0 and 2.0.0 are the same version."""
    numbers = [int(digits) for digits in re.findall(r"\d+", version)]
    while numbers and not numbers[-1]:
        numbers.pop()
    return tuple(numbers)
