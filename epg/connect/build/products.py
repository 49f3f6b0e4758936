# SPDX-License-Identifier: Apache-2.0
"""Finds the files that a build has made for the user, with CMake's file API (cmake-file-api(7)).

>>> # ask(build)                                 before CMake configures
>>> # products(build, "jiwy", platform, ())      afterwards
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from epg.generator.catalog.platform import Platform
from epg.generator.dataclass import dataclass

CLIENT = "client-epg"
_QUERY = "codemodel-v2"


@dataclass(frozen=True)
class Made:
    """A product: its file, and the way to use it."""

    path: Path
    what: str


def ask(build: Path) -> None:
    """Requests a description of the targets and their files, which CMake writes when it configures ``build``."""
    folder = build / ".cmake/api/v1/query" / CLIENT
    folder.mkdir(parents=True, exist_ok=True)
    (folder / _QUERY).touch()


def products(build: Path, target: str, platform: Platform | None, executables: Sequence[str]) -> list[Made]:
    """The files of the ``executables``, and of all other executables with the EPG target ``target``.

    They are in the platform's order of ``products``: the most useful ones first.  Files that do not exist are left out.
    """
    ranked: dict[Path, tuple[int, Made]] = {}
    for program in _programs(build, target, executables, platform.program if platform is not None else ""):
        for rank, made in _of_program(program, platform):
            if made.path.is_file():
                ranked.setdefault(made.path, (rank, made))
    return [made for _, made in sorted(ranked.values(), key=lambda entry: (entry[0], entry[1].path.as_posix()))]


def _of_program(program: Path, platform: Platform | None) -> Iterator[tuple[int, Made]]:
    """The products of an executable that ``platform`` lists, with their ranks; without a list, the executable."""
    known = platform.products if platform is not None else ()
    for rank, product in enumerate(known):
        name = program.name if product.file == "*" else product.file.replace("*", program.stem)
        yield rank, Made(program.with_name(name), product.what)
    if not known:
        yield 0, Made(program, "the program")


def _programs(build: Path, target: str, executables: Sequence[str], of_sdk: str) -> list[Path]:
    """The executables that CMake makes with ``target``.  ``of_sdk`` is the name of the SDK's own executable, or "".

    If that is found, only its file is returned.
    """
    wanted: list[Path] = []
    sdk: list[Path] = []
    for description in _targets(build):
        paths = [build / artifact["path"] for artifact in description.get("artifacts", [])]
        if description.get("type") != "EXECUTABLE" or not paths:
            continue
        needed = [str(dependency["id"]) for dependency in description.get("dependencies", [])]
        if description["name"] == of_sdk:
            sdk.append(paths[0])
        elif description["name"] in executables or any(id.startswith(f"{target}::@") for id in needed):
            wanted.append(paths[0])
    return sdk or wanted


def _targets(build: Path) -> Iterator[Mapping[str, Any]]:
    """The CMake targets as CMake's newest answer describes them; none if there is no answer."""
    folder = build / ".cmake/api/v1/reply"
    try:
        index = json.loads(max(folder.glob("index-*.json")).read_text(encoding="utf-8"))
        model = json.loads((folder / index["reply"][CLIENT][_QUERY]["jsonFile"]).read_text(encoding="utf-8"))
        for configuration in model["configurations"]:
            for target in configuration["targets"]:
                yield json.loads((folder / target["jsonFile"]).read_text(encoding="utf-8"))
    except (OSError, ValueError, KeyError, TypeError):
        return
