# SPDX-License-Identifier: Apache-2.0
"""Builds of copies of examples, for tests."""

from __future__ import annotations

import os
from pathlib import Path

from epg.connect.build.build_run import Build
from epg.connect.projects import Job, find_jobs
from epg.generator.diagnostics import Diagnostics


def job_of(folder: Path) -> Job:
    (job,) = find_jobs(folder, Diagnostics())
    return job


def run(job: Job, *, anyway: bool = False) -> Build:
    """Runs a build to its end."""
    build = Build(lambda: None)
    build.start(job, anyway=anyway)
    assert build.wait(600), build.lines(0)
    return build


def processes(folder: Path) -> list[str]:
    """The command lines of all processes that run in a folder or name it."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            command = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
            place = os.readlink(entry / "cwd")
        except OSError:
            continue
        if command and int(entry.name) != os.getpid() and (str(folder) in command or place.startswith(str(folder))):
            found.append(command)
    return found
