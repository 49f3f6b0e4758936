# SPDX-License-Identifier: Apache-2.0
"""The targets of a project.  They are searched again when a CMakeLists.txt changes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from epg.connect.files import Watch
from epg.connect.literal_calls import FILE
from epg.connect.projects import Job, find_jobs
from epg.diagnostics import Diagnostics


class Targets:
    """The ``jobs`` of the project in ``folder``.  Without a folder they never change."""

    def __init__(self, jobs: Sequence[Job], folder: Path | None = None) -> None:
        self._folder = folder
        self._take(jobs)

    @property
    def names(self) -> list[str]:
        return [job.request.name for job in self.jobs]

    def find(self, name: str) -> Job | None:
        return next((job for job in self.jobs if job.request.name == name), None)

    def look(self) -> bool:
        """Searches the targets again if a CMakeLists.txt has changed.  Returns True if it has and still has targets."""
        if self._folder is None or not self._watch.changed():
            return False
        jobs = find_jobs(self._folder, Diagnostics())
        if jobs:
            self._take(jobs)
        return bool(jobs)

    def _take(self, jobs: Sequence[Job]) -> None:
        self.jobs = list(jobs)
        files = {Path(job.request.caller.file) for job in jobs if job.request.caller is not None}
        files |= {job.source_dir / FILE for job in jobs if job.source_dir is not None}
        self._watch = Watch(files if self._folder is not None else ())
