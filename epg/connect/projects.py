# SPDX-License-Identifier: Apache-2.0
"""The targets of a project that can be connected: the epg_add_target() calls of its CMakeLists.txt.

>>> # find_jobs(Path("examples/jiwy"), diagnostics)[0].request.name  ->  "jiwy"
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from epg.connect.build_folders import BuildFolder, build_folders
from epg.connect.cmake.calls import Call, Unknown, Walk
from epg.connect.cmake.values import Word
from epg.data import data_folder
from epg.diagnostics import Diagnostics
from epg.project import Request
from epg.source import Span

FILE = "CMakeLists.txt"
_ONE = ("TCF", "MODEL", "BINDINGS", "PLANT", "PLANT_BINDINGS", "NODE", "NAMESPACE")
_NEEDED = ("TCF", "MODEL", "BINDINGS")
_LEVELS = 8
"""So many folders above one are looked at for the project around it."""


@dataclass(frozen=True)
class Job:
    """One target that can be connected, and how its project is built.

    ``source_dir`` is the folder of the top CMakeLists.txt; ``build_dir`` one that is there or that ``preset`` or the
    user would make.  ``executables`` are those of epg_add_executable(); ``board`` is what `west build -b` was given.
    """

    request: Request
    source_dir: Path | None = None
    build_dir: Path | None = None
    built_by: str = "cmake"
    preset: str = ""
    executables: tuple[str, ...] = ()
    board: str = ""


def find_jobs(folder: Path, diagnostics: Diagnostics) -> list[Job]:
    """The targets that the project in ``folder`` makes, or those of the folder of a project around it.

    Empty without a message where no epg_add_target() is written.  A call that cannot be understood is an error, but a
    warning where others are.
    """
    folder = Path(os.path.abspath(folder))
    if not (folder / FILE).is_file():
        return []
    top = _top(folder)
    best: _Found | None = None
    for build in build_folders(top):
        found = _jobs(top, folder, build)
        if best is None or (not best.jobs and (found.jobs or (found.unknown and not best.unknown))):
            best = found
        if best.jobs:
            break
    assert best is not None, "the usual build folder is always there"
    hint = "CMake knows: configure, then start "
    hint += "'west build -t NAME_connect'" if best.zephyr else "'cmake --build BUILD_FOLDER --target NAME_connect'"
    for unknown in best.unknown:
        if best.jobs:
            diagnostics.warning("cmake-not-understood", unknown.span, unknown.message, hint=hint)
        else:
            diagnostics.error("cmake-not-understood", unknown.span, unknown.message, hint=hint)
    return best.jobs


def jobs_of_model(model: Path) -> list[Job]:
    """The targets of the project around the folder or file ``model`` that are made of it."""
    wanted = os.path.realpath(model)
    for above in list(Path(wanted).parents)[:_LEVELS]:
        jobs = [job for job in find_jobs(above, Diagnostics()) if os.path.realpath(job.request.model) == wanted]
        if jobs:
            return jobs
    return []


def report_no_target(folder: Path, diagnostics: Diagnostics) -> None:
    """Says so where there is a project in ``folder``, or below it, but no target in ``folder`` itself."""
    here = folder / FILE
    below = [path.parent for path in sorted(folder.glob(f"*/{FILE}")) if find_jobs(path.parent, Diagnostics())]
    if not here.is_file() and not below:
        return
    message = f"there is no epg_add_target() here, and '{folder.name}' is not a model"
    hint = f"start it for one of the folders below: {', '.join(path.name for path in below)}"
    if not below:
        hint = "add the call that docs/cmake.md shows, or start it for the folder of a model"
    diagnostics.error("no-target", Span(str(here if here.is_file() else folder)), message, hint=hint)


@dataclass
class _Found:
    jobs: list[Job] = field(default_factory=list)
    unknown: list[Unknown] = field(default_factory=list)
    zephyr: bool = False


def _top(folder: Path) -> Path:
    """The folder of the project that ``folder`` belongs to: the nearest one whose CMakeLists.txt has project()."""
    for above in [folder, *folder.parents][:_LEVELS]:
        try:
            text = (above / FILE).read_text(encoding="utf-8", errors="replace")
        except OSError:
            continue
        if re.search(r"^[ \t]*project[ \t\n]*\(", text, re.MULTILINE | re.IGNORECASE):
            return above
    return folder


def _jobs(top: Path, folder: Path, build: BuildFolder) -> _Found:
    """The targets below ``folder``, as they would be in this build folder."""
    # epg_import.cmake sets EPG_DIR: to this EPG, as far as anyone can tell before.
    walk = Walk(top, {"EPG_DIR": data_folder("cmake").as_posix(), **build.variables})
    found = _Found(zephyr=walk.uses_zephyr)
    found.unknown = [unknown for unknown in walk.unknown if Path(unknown.span.file).is_relative_to(folder)]
    calls = [call for call in walk.calls if call.folder.is_relative_to(folder)]
    executables: dict[str, list[str]] = {}
    for call in calls:
        texts = [word.text for word in call.words]
        if call.command.name == "epg_add_executable" and len(texts) == 2 and texts[0] and texts[1]:
            executables.setdefault(texts[1].removeprefix("EPG::"), []).append(texts[0])
    requests: dict[str, Request] = {}
    for call in sorted(calls, key=lambda call: not call.certain):
        if call.command.name == "epg_add_target":
            request = _request(call, found.unknown)
            if request is not None:
                requests.setdefault(request.name, request)
    for name, request in requests.items():
        found.jobs.append(
            Job(
                request,
                source_dir=top,
                build_dir=build.path,
                built_by="west" if walk.uses_zephyr else "cmake",
                preset=build.preset,
                executables=tuple(executables.get(name, ())),
                board=build.variables.get("BOARD", "") if walk.uses_zephyr else "",
            )
        )
    return found


def _request(call: Call, unknown: list[Unknown]) -> Request | None:
    """What one epg_add_target() asks for, or None after noting why that cannot be told."""
    for word in call.words:
        if word.text is None:
            unknown.append(Unknown(word.span, f"what '{word.written}' stands for is known to CMake only"))
            return None
    values, settings = _keywords(call.words[1:])
    missing = [keyword for keyword in _NEEDED if keyword not in values]
    if not call.words or missing:
        lacking = f"{missing[0]} is missing" if call.words else "its name is missing"
        unknown.append(Unknown(call.command.span, f"this epg_add_target() is not complete: {lacking}"))
        return None
    name = call.words[0]
    here = call.folder
    written = [(word.text or "", word.span) for word in settings]
    written += [
        (f"{key.lower()}={values[key].text}", values[key].span) for key in ("NODE", "NAMESPACE") if key in values
    ]
    return Request(
        name=name.text or "",
        tcf=values["TCF"].text or "",
        model=_path(here, values["MODEL"]),
        bindings=_path(here, values["BINDINGS"]),
        plant=_path(here, values["PLANT"]) if "PLANT" in values else None,
        plant_bindings=_path(here, values["PLANT_BINDINGS"]) if "PLANT_BINDINGS" in values else None,
        settings=written,
        user_roots=_user_roots(call),
        caller=name.span,
        beside=here,
    )


def _keywords(words: Sequence[Word]) -> tuple[Mapping[str, Word], Iterable[Word]]:
    """As cmake_parse_arguments() sorts them: the value of each keyword, and all those of SET."""
    values: dict[str, Word] = {}
    settings: list[Word] = []
    current = ""
    for word in words:
        if word.text in (*_ONE, "SET"):
            current = word.text or ""
        elif current == "SET":
            settings.append(word)
        elif current:
            values[current] = word
            current = ""
    return values, settings


def _path(folder: Path, word: Word) -> Path:
    return Path(os.path.normpath(folder / (word.text or "")))


def _user_roots(call: Call) -> tuple[Path, ...]:
    """The user's folders as CMake takes them: of its variable, else of the environment."""
    value = call.variables.get("EPG_TARGETS_PATH")
    roots = value.split(";") if value else os.environ.get("EPG_TARGETS_PATH", "").split(os.pathsep)
    return tuple(call.folder / root for root in roots if root)
