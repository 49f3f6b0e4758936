# SPDX-License-Identifier: Apache-2.0
"""The files of a project that must change when its target moves to another board or platform.

A file that the user has not changed is what ``epg new`` made for the old target: EPG makes it again and compares.  It
is replaced by the one for the new target, or removed.  EPG does not touch any other file, but tells the user the lines
to change.

>>> # changes = file_changes(job, "rpi_pico2_bare_metal", "nucleo_h743zi_freertos", ("xrce", "xrce"), {})
>>> # [(change.name, change.what) for change in changes]
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from epg.connect.files import read_snapshot
from epg.connect.projects import Job
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.new.new_project import ProjectRequest, new_project

_SIMULATION = "simulation/"


@dataclass(frozen=True)
class FileChange:
    """What happens to one file: ``what`` is "written", "removed" or "asked".

    ``after`` are the new contents of a file that is written.  ``lines`` are the differences that the user must make in
    another file, as a unified diff.
    """

    name: str
    what: str
    path: Path
    before: bytes | None
    after: bytes | None = None
    lines: str = ""

    def data(self) -> dict[str, Any]:
        return {"name": self.name, "what": self.what, "new": self.before is None, "lines": self.lines}


DraftBytes = Mapping[Path, bytes | None]


def file_changes(
    job: Job, before: str, after: str, middlewares: tuple[str | None, str | None], drafts: DraftBytes
) -> list[FileChange] | None:
    """The changes of the files of ``job`` from the target or configuration ``before`` to ``after``.

    ``middlewares`` are those of the ``.tcf`` before and after.  ``drafts`` are contents of files that are not saved
    yet.  None if EPG has no project for the new target.
    """
    folder, user_roots = job.source_dir, job.request.user_roots
    if folder is None or job.simulated:
        return []
    new = _files(job, folder, after, middlewares[1], user_roots) or _files(job, folder, after, None, user_roots)
    if new is None:
        return None
    olds = [
        _files(job, folder, before, middleware, user_roots) or {}
        for middleware in dict.fromkeys((None, middlewares[0]))
    ]
    own = {f"{job.request.name}.tcf", f"{job.request.name}.bindings.yaml"}
    names = {*new, *(name for old in olds for name in old)} - own
    changes = [_change(folder, name, new, olds, drafts) for name in sorted(names)]
    return [change for change in changes if change is not None]


def _files(
    job: Job, folder: Path, target: str, middleware: str | None, user_roots: Sequence[Path]
) -> Mapping[str, bytes] | None:
    """The files of ``epg new`` for a target; None if there is no such project."""
    request = ProjectRequest(job.request.name, folder, target, job.request.model, middleware, user_roots)
    project = new_project(request, Diagnostics())
    return project.files if project is not None else None


def _change(
    folder: Path, name: str, new: Mapping[str, bytes], olds: Sequence[Mapping[str, bytes]], drafts: DraftBytes
) -> FileChange | None:
    path = folder / name
    present = _present(path, drafts)
    wanted, made = new.get(name), [old.get(name) for old in olds]
    if present == wanted or wanted in made:
        return None
    if wanted is None:
        return FileChange(name, "removed", path, present) if present is not None and present in made else None
    if present is None:
        return FileChange(name, "written", path, None, _moved(folder, name, wanted, olds, drafts))
    if present in made:
        return FileChange(name, "written", path, present, wanted)
    return FileChange(name, "asked", path, present, lines=_lines(name, made[0] or present, wanted))


def _present(path: Path, drafts: DraftBytes) -> bytes | None:
    return drafts[path] if path in drafts else read_snapshot(path).data


def _moved(folder: Path, name: str, wanted: bytes, olds: Sequence[Mapping[str, bytes]], drafts: DraftBytes) -> bytes:
    """The contents of a new file: those of its equal in the project's simulation, which the user may have changed."""
    other = name.removeprefix(_SIMULATION) if name.startswith(_SIMULATION) else _SIMULATION + name
    if any(old.get(other) == wanted for old in olds):
        return _present(folder / other, drafts) or wanted
    return wanted


def _lines(name: str, before: bytes, after: bytes) -> str:
    old, new = (data.decode("utf-8", "replace").splitlines() for data in (before, after))
    return "\n".join(difflib.unified_diff(old, new, name, name, lineterm=""))
