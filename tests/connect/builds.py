"""Builds of copies of examples, for tests."""

from __future__ import annotations

from pathlib import Path

from epg.connect.build import Build
from epg.connect.projects import Job, find_jobs
from epg.diagnostics import Diagnostics


def job_of(folder: Path) -> Job:
    (job,) = find_jobs(folder, Diagnostics())
    return job


def run(job: Job) -> Build:
    """A build, after its end."""
    build = Build(job, lambda: None)
    build.start()
    assert build.wait(600), build.lines(0)
    return build
