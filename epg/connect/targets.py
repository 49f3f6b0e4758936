# SPDX-License-Identifier: Apache-2.0
"""The targets of a project or of a system.  They are searched again when the files that name them change."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from epg.connect.files import Watch
from epg.connect.literal_calls import FILE
from epg.connect.projects import Job

Search = Callable[[], Sequence[Job]]


class Targets:
    """The ``jobs`` that ``search`` has found.  Without a search they never change."""

    def __init__(self, jobs: Sequence[Job], search: Search | None = None) -> None:
        self._search = search
        self._take(jobs)

    @property
    def names(self) -> list[str]:
        return [job.request.name for job in self.jobs]

    def find(self, name: str) -> Job | None:
        return next((job for job in self.jobs if job.request.name == name), None)

    def look(self) -> str:
        """Searches the targets again if a file that names them has changed.

        Returns the name of this file; empty if none has changed, or if there are no targets now.
        """
        changed = self._watch.changed() if self._search is not None else []
        jobs = self._search() if self._search is not None and changed else ()
        if jobs:
            self._take(jobs)
        return changed[0].name if jobs else ""

    def _take(self, jobs: Sequence[Job]) -> None:
        self.jobs = list(jobs)
        files = {Path(job.request.caller.file) for job in jobs if job.request.caller is not None}
        files |= {job.source_dir / FILE for job in jobs if job.source_dir is not None}
        self._watch = Watch(files if self._search is not None else ())
