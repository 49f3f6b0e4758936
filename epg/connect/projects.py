# SPDX-License-Identifier: Apache-2.0
"""Finds the targets of a project: the epg_add_target() calls in its CMakeLists.txt files.

>>> # find_jobs(Path("examples/jiwy"), diagnostics)[0].request.name  ->  "jiwy"
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from epg.connect.build_folders import build_folders
from epg.connect.literal_calls import FILE, Call, LiteralCalls, Unknown, Word, not_literal
from epg.connect.recorded_calls import recorded_calls
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import Request
from epg.generator.source import Span
from epg.system import SYSTEM_FILES
from epg.system.load_system import parse_system

_ONE = ("TCF", "MODEL", "BINDINGS", "PLANT", "PLANT_BINDINGS", "IOC", "NODE", "NAMESPACE", "SYSTEM")
_NEEDED = ("TCF", "MODEL", "BINDINGS")
_LEVELS = 8
"""The number of folders, from one upwards, that are searched for the project around it."""


@dataclass(frozen=True)
class Job:
    """One target that can be connected, and the way its project is built.

    ``source_dir`` is the folder of the top CMakeLists.txt.  ``build_dir`` exists, or is the one that ``preset`` or the
    user would create.  ``executables`` are the names that epg_add_executable() got; ``board`` is the argument that
    ``west build -b`` got.  ``simulated`` is True if the project builds the simulation of the target's system, not a
    firmware.
    """

    request: Request
    source_dir: Path | None = None
    build_dir: Path | None = None
    built_by: str = "cmake"
    preset: str = ""
    executables: tuple[str, ...] = ()
    board: str = ""
    simulated: bool = False


def find_jobs(
    folder: Path, diagnostics: Diagnostics, drafts: Mapping[Path, bytes | None] = MappingProxyType({})
) -> list[Job]:
    """The targets of the project in ``folder``, or of the part ``folder`` of a larger project.

    ``drafts`` are contents of CMakeLists.txt files that are not saved yet.
    The list is empty, without a message, if there is no epg_add_target().  A call that only CMake can evaluate is an
    error if there is no other target, else a warning.
    """
    folder = Path(os.path.abspath(folder))
    if not (folder / FILE).is_file():
        return []
    top = _top(folder)
    read = LiteralCalls(top, drafts)
    builds = build_folders(top)
    records = {build.path: recorded_calls(build) for build in reversed(builds)}
    requests, unknown = _requests(read, folder)
    build = next((build for build in builds if requests.keys() & records[build.path].requests.keys()), builds[0])
    executables = _executables(read)
    if unknown or not requests:  # only CMake knows all targets; a configured build folder has a record of them
        build = next((build for build in builds if records[build.path].below(folder)), build)
        known = records[build.path].below(folder)
        requests, unknown = ({**requests, **known}, []) if known else (requests, unknown)
    executables = {**executables, **records[build.path].executables}
    by_west = read.uses_zephyr
    _report(unknown, diagnostics.warning if requests else diagnostics.error, by_west)
    return [
        Job(
            request,
            source_dir=top,
            build_dir=build.path,
            built_by="west" if by_west else "cmake",
            preset=build.preset,
            executables=tuple(executables.get(name, ())),
            board=build.board if by_west else "",
        )
        for name, request in requests.items()
    ]


def _report(unknown: Iterable[Unknown], report: Callable[..., None], by_west: bool) -> None:
    configure = "west build --cmake-only" if by_west else "cmake -S . -B build"
    hint = f"configure with '{configure}', which runs the project's CMake files, then start 'epg connect' again"
    for place in unknown:
        report("cmake-not-understood", place.span, place.message, hint=place.hint or hint)


def jobs_of_model(model: Path) -> list[Job]:
    """The targets that are made of ``model``, a folder or file, in the project around it."""
    wanted = os.path.realpath(model)
    for above in list(Path(wanted).parents)[:_LEVELS]:
        jobs = [job for job in find_jobs(above, Diagnostics()) if os.path.realpath(job.request.model) == wanted]
        if jobs:
            return jobs
    return []


def find_systems(folder: Path) -> list[Path]:
    """The systems of the project in ``folder``: those of epg_add_system(), else the files of systems in the folder."""
    folder = Path(os.path.abspath(folder))
    calls = _system_calls(folder) if (folder / FILE).is_file() else {}
    return list(calls) or sorted(folder.glob(f"*{SYSTEM_FILES}"))


def system_jobs(path: Path, folder: Path, user_roots: Sequence[Path] = ()) -> list[Job]:
    """The targets of the system in ``path``; none if it is not a system.

    The project in ``folder`` builds its simulation.  Without a CMakeLists.txt there, nothing can be built.
    """
    path, folder = Path(os.path.abspath(path)), Path(os.path.abspath(folder))
    system = parse_system(path, Diagnostics())
    if system is None:
        return []
    call = _system_calls(folder).get(path) if (folder / FILE).is_file() else None
    top = _top(folder) if call is not None else None
    roots = (_user_roots(call) if call is not None else ()) or tuple(user_roots)
    return [
        Job(
            system.request(target, roots),
            source_dir=top,
            build_dir=build_folders(top)[0].path if top is not None else None,
            executables=(call.words[0].text or "",) if call is not None else (),
            simulated=True,
        )
        for target in system.targets.values()
    ]


def _system_calls(folder: Path) -> dict[Path, Call]:
    """The calls of epg_add_system() in ``folder`` and below that make a simulation, by the file of the system."""
    calls: dict[Path, Call] = {}
    for call in LiteralCalls(_top(folder)).calls:
        if call.name == "epg_add_system" and call.folder.is_relative_to(folder):
            values, _ = _keywords(call.words[1:])
            if "SYSTEM" in values and "TARGETS" not in [word.text for word in call.words]:
                calls.setdefault(_path(call.folder, values["SYSTEM"]), call)
    return calls


def report_no_target(folder: Path, diagnostics: Diagnostics) -> None:
    """Reports that ``folder`` has no target.  Reports nothing if there is no project in or directly below it."""
    here = folder / FILE
    below = [path.parent for path in sorted(folder.glob(f"*/{FILE}")) if find_jobs(path.parent, Diagnostics())]
    if not here.is_file() and not below:
        return
    message = f"there is no epg_add_target() here, and '{folder.name}' is not a model"
    hint = f"run 'epg connect' with one of these folders: {', '.join(path.name for path in below)}"
    if not below:
        hint = "add the call that docs/cmake.md shows, or run 'epg connect' with the folder of a model"
    diagnostics.error("no-target", Span(str(here if here.is_file() else folder)), message, hint=hint)


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


def _requests(read: LiteralCalls, folder: Path) -> tuple[dict[str, Request], list[Unknown]]:
    """The targets of literal calls in ``folder`` and below, and the calls that only CMake can evaluate."""
    requests: dict[str, Request] = {}
    unknown = [unknown for unknown in read.unknown if Path(unknown.span.file).is_relative_to(folder)]
    for call in read.calls:
        if call.name == "epg_add_target" and call.folder.is_relative_to(folder):
            request = _request(call, unknown)
            if request is not None and request.name in requests:
                message = f"'{request.name}' is added twice: only CMake can decide which call applies"
                unknown.append(Unknown(call.span, message))
            elif request is not None:
                requests[request.name] = request
    return requests, unknown


def _executables(read: LiteralCalls) -> dict[str, list[str]]:
    """The names of the executables that literal calls make, by target."""
    executables: dict[str, list[str]] = {}
    for call in read.calls:
        texts = [word.text for word in call.words]
        if call.name == "epg_add_executable" and len(texts) == 2 and texts[0] and texts[1]:
            executables.setdefault(texts[1].removeprefix("EPG::"), []).append(texts[0])
    return executables


def _request(call: Call, unknown: list[Unknown]) -> Request | None:
    """The request of one epg_add_target() call.  If that is not known, None, and the reason is added to ``unknown``."""
    for word in call.words:
        if word.text is None:
            unknown.append(not_literal(word))
            return None
    values, settings = _keywords(call.words[1:])
    if call.words and "SYSTEM" in values:
        return _of_system(call, _path(call.folder, values["SYSTEM"]), values.get("IOC"), unknown)
    missing = [keyword for keyword in _NEEDED if keyword not in values]
    if not call.words or missing:
        lacking = f"{missing[0]} is missing" if call.words else "its name is missing"
        unknown.append(Unknown(call.span, f"this epg_add_target() is not complete: {lacking}"))
        return None
    paths = {keyword: _path(call.folder, word) for keyword, word in values.items()}
    return Request(
        name=call.words[0].text or "",
        tcf=values["TCF"].text or "",
        model=paths["MODEL"],
        bindings=paths["BINDINGS"],
        plant=paths.get("PLANT"),
        plant_bindings=paths.get("PLANT_BINDINGS"),
        ioc=paths.get("IOC"),
        settings=_settings(values, settings),
        user_roots=_user_roots(call),
        caller=call.words[0].span,
        beside=call.folder,
    )


def _settings(values: Mapping[str, Word], settings: Iterable[Word]) -> list[tuple[str, Span]]:
    """The settings of a call, as ``--set`` takes them: those of SET, and the names of node and namespace."""
    named = [(key, values[key]) for key in ("NODE", "NAMESPACE") if key in values]
    return [
        *((word.text or "", word.span) for word in settings),
        *((f"{key.lower()}={word.text}", word.span) for key, word in named),
    ]


def _of_system(call: Call, path: Path, ioc: Word | None, unknown: list[Unknown]) -> Request | None:
    """The request of a target that is part of the system in ``path``."""
    system, name = parse_system(path, Diagnostics()), call.words[0].text or ""
    if system is not None and name in system.targets:
        project_file = _path(call.folder, ioc) if ioc is not None else None
        return system.request(system.targets[name], _user_roots(call), project_file)
    what = "cannot be read" if system is None else f"has no target '{name}'"
    message = f"the system '{path.name}' of this target {what}"
    unknown.append(Unknown(call.span, message, f"'epg check {path.name}' shows the mistakes in it"))
    return None


def _keywords(words: Sequence[Word]) -> tuple[Mapping[str, Word], Iterable[Word]]:
    """Sorts arguments as cmake_parse_arguments() does: the value of each keyword, and all values of SET."""
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
    """The user's folders of targets, as CMake takes them: from its variable, else from the environment."""
    roots = call.roots or os.environ.get("EPG_TARGETS_PATH", "").split(os.pathsep)
    return tuple(call.folder / root for root in roots if root)
