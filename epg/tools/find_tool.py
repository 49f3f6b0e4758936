# SPDX-License-Identifier: Apache-2.0
"""Where an SDK or program is: the same order of places for all.

1. The first CMake variable with a value.  2. The first environment variable with a value.  A tool that a variable
names must be there: it is not looked for elsewhere.  3. ``PATH``, for programs.  4. The places that its own installers
use, in the order of the table.  5. CMake's user package registry.  6. EPG's cache.  Of several folders in one place the
last one wins, with numbers compared as numbers.

cmake/EPGSdk.cmake takes the same steps for SDKs, because builds find them without starting Python;
tests/tools/test_same_answer.py compares the answers.

>>> # find_tool(tools["pico_sdk"], Surroundings.here(cache_folder())).path
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from epg.diagnostics import Diagnostics
from epg.documents.text_file import read_text
from epg.tools.tools import Tool

TIMEOUT = 5.0
"""Seconds that a program may take to say its version."""


@dataclass(frozen=True)
class Surroundings:
    """What decides where tools are looked for; ``cmake`` are the variables of a CMake cache.

    Without ``run``, programs that these variables name are not started to ask for their version: a folder that somebody
    has handed on may name any program.
    """

    environment: Mapping[str, str]
    cmake: Mapping[str, str]
    home: Path
    cache: Path
    run: bool = True

    @staticmethod
    def here(cache: Path, cmake: Mapping[str, str] | None = None, *, run: bool = True) -> Surroundings:
        """Those of this process."""
        return Surroundings(os.environ, cmake or {}, Path.home(), cache, run)

    @property
    def path(self) -> str:
        return self.environment.get("PATH", "")


@dataclass(frozen=True)
class Finding:
    """What was found of a tool.

    ``status``: "found"; "missing"; "old" when it is older than needed; "wrong" when a variable leads to something
    else, which is not passed over, because builds would stop there too.  ``source`` says how it was found, ``looked``
    all places that were tried.  ``asked`` is False where its version is not known because it must not be started.
    """

    tool: Tool
    status: str
    path: Path | None = None
    source: str = ""
    version: str = ""
    looked: tuple[str, ...] = ()
    asked: bool = True


@dataclass(frozen=True)
class _Place:
    source: str
    folders: list[Path]
    stated: bool = False  # by a variable: then the tool must be there
    of_build: bool = False  # by a CMake variable


def find_tool(tool: Tool, where: Surroundings) -> Finding:
    """Looks for ``tool`` in all its places; the first hit wins."""
    looked: list[str] = []
    for place in _places(tool, where):
        looked.append(place.source)
        for folder in place.folders:
            path = _in_folder(tool, folder, where)
            if path is not None:
                asked = where.run or not (place.of_build and tool.programs)
                version = _version(tool, path) if asked else ""
                old = bool(tool.oldest and version) and _numbers(version) < _numbers(tool.oldest)
                return Finding(tool, "old" if old else "found", path, place.source, version, tuple(looked), asked)
        if place.stated:
            return Finding(tool, "wrong", place.folders[0], place.source, looked=tuple(looked))
    return Finding(tool, "missing", looked=tuple(looked))


def read_cmake_cache(path: Path, diagnostics: Diagnostics) -> dict[str, str]:
    """The variables of a ``CMakeCache.txt``, without those that say that nothing was found."""
    text = read_text(path, diagnostics) or ""
    found = re.findall(r"^([^#/\s][^:=\n]*):[A-Z]+=(.*)$", text, re.MULTILINE)
    return {name: value for name, value in found if value and not value.endswith("NOTFOUND")}


def _places(tool: Tool, where: Surroundings) -> Iterator[_Place]:
    for name in tool.variables:
        if where.cmake.get(name):
            yield _Place(f"CMake variable {name}", [Path(where.cmake[name])], stated=True, of_build=True)
    for name in tool.environment:
        if where.environment.get(name):
            yield _Place(f"environment variable {name}", [Path(where.environment[name])], stated=True)
    if tool.programs:
        found = (shutil.which(program, path=where.path) for program in tool.programs)
        yield _Place("PATH", [Path(program) for program in found if program])
    for pattern in tool.places:
        yield _Place(pattern, _matches(pattern, where.home))
    if tool.registry:
        yield _Place(f"CMake's package registry ({tool.registry})", _registered(tool, where))
    if tool.cached:
        yield _Place("EPG's cache", _newest_first(where.cache.glob(tool.cached)))


def _matches(pattern: str, home: Path) -> list[Path]:
    """The folders that an absolute pattern stands for; ``~`` is the home folder."""
    path = Path(pattern.replace("~", home.as_posix(), 1))
    if not path.is_absolute():  # a place of another system
        return []
    return _newest_first(Path(path.anchor).glob(path.relative_to(path.anchor).as_posix()))


def _registered(tool: Tool, where: Surroundings) -> list[Path]:
    """Folders that packages have entered into CMake's user package registry, or the one above that is the tool's."""
    folders = []
    for entry in (where.home / ".cmake/packages" / tool.registry).glob("*"):
        try:
            folder = Path(entry.read_text(encoding="utf-8").strip())
        except (OSError, ValueError):
            continue
        folders += [above for above in (folder, *folder.parents) if (above / tool.holds).is_file()][:1]
    return _newest_first(folders)


def _in_folder(tool: Tool, folder: Path, where: Surroundings) -> Path | None:
    """The tool at ``folder``: the folder itself, or a program in it or its ``bin``, or the program of that name."""
    if tool.holds:
        return folder if (folder / tool.holds).is_file() else None
    if folder.is_dir():
        places = [(program, str(place)) for program in tool.programs for place in (folder, folder / "bin")]
    else:  # CC="gcc -m32", or a name to be found in PATH
        places = [(str(folder), where.path), (str(folder).split(" ")[0], where.path)]
    found = (shutil.which(program, path=path) for program, path in places)
    return next((Path(path) for path in found if path), None)


def _version(tool: Tool, path: Path) -> str:
    """The version as the tool states it, or "" when it does not."""
    text = _said(path) if tool.programs else _read(path / tool.version_file)
    parts = [match[1] for pattern in tool.version_patterns if (match := re.search(pattern, text)) is not None]
    return ".".join(parts) if len(parts) == len(tool.version_patterns) else ""


def _said(program: Path) -> str:
    """What a program answers to ``--version``."""
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
    return done.stdout


def _read(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""


def _newest_first(folders: Iterable[Path]) -> list[Path]:
    return sorted(folders, key=lambda folder: _natural(folder.as_posix()), reverse=True)


def _natural(text: str) -> list[tuple[str, int]]:
    """The order of CMake's ``COMPARE NATURAL``: by characters, but by value where both texts have a number."""
    return [("0", int(part)) if part.isdecimal() else (part, 0) for part in re.findall(r"[0-9]+|[^0-9]", text)]


def _numbers(version: str) -> tuple[int, ...]:
    """The numbers of a version, without zeros at its end: 2.0 and 2.0.0 are the same version."""
    numbers = [int(digits) for digits in re.findall(r"\d+", version)]
    while numbers and not numbers[-1]:
        numbers.pop()
    return tuple(numbers)
