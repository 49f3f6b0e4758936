# SPDX-License-Identifier: Apache-2.0
"""Runs a host executable, or the simulation of a system, and reads the files that it wrote."""

from __future__ import annotations

import json
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, UserError
from epg.generator.source import Span

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Statistics:
    """The statistics of a run (``docs/host.md``).  Times are in seconds."""

    name: str
    mode: str  # "simulated" or "realtime"
    period: float
    duration: float
    wall_time: float
    cycles: int
    overruns: int
    missed: int
    lateness_mean: float
    lateness_p99: float
    lateness_max: float
    computation_min: float
    computation_mean: float
    computation_max: float
    clamped: int
    setpoints_dropped: int
    setpoint_timeouts: int
    faults: int
    enabled: bool
    fault: str
    fault_component: str
    scheduler: str


def run_executable(
    executable: Path, folder: Path, duration: float, setpoints: Path, *, realtime: bool, progress: Progress
) -> None:
    """Runs ``executable`` in ``folder``, where it writes ``trace.csv``, ``topics.csv`` and ``statistics.json``.

    ``duration`` is the duration of the run in seconds.  Raises UserError if the executable cannot be started, runs
    longer than :func:`patience`, or ends with an error.
    """
    folder = folder.resolve()
    # native_sim only accepts options in the form --option=value.  Its simulated flash is a file in the current folder.
    options = ["--quiet", f"--duration={duration!r}", f"--setpoints={setpoints.resolve()}"]
    options += [f"--{option}={folder / f'{option}.csv'}" for option in ("topics", "trace")]
    options.append(f"--statistics={folder / 'statistics.json'}")
    if realtime:
        options.append("--realtime")
    unit = "s in real time" if realtime else "s of simulated time"
    progress(f"running {executable.name}: {duration:g} {unit}")
    run_program(executable, options, folder, duration, realtime=realtime, progress=progress)


def run_program(
    executable: Path, options: list[str], folder: Path, duration: float, *, realtime: bool, progress: Progress
) -> None:
    """Runs ``executable`` in ``folder``.  Raises UserError as :func:`run_executable` does."""
    log = folder / "messages.txt"
    try:
        with (
            log.open("wb") as messages,
            subprocess.Popen(
                [str(executable.resolve()), *options], stdout=messages, stderr=messages, cwd=folder
            ) as process,
        ):
            if not _wait(process, duration, realtime, progress):
                process.kill()
                fail(executable, f"'{executable.name}' did not end", f"killed after {patience(duration):.0f} s")
            status = process.returncode
    except OSError as error:
        fail(executable, f"cannot run '{executable.name}': {error.strerror}", "build it first")
    if status != 0:
        message, hint = _said(log.read_text(encoding="utf-8", errors="replace"))
        fail(executable, f"'{executable.name}' ended with status {status}{message and ': '}{message}", hint)
    log.unlink()


def _said(text: str) -> tuple[str, str]:
    """The first error that a program printed, with the hint after it.  If there is no error, its last line."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    for number, line in enumerate(lines):
        _, found, message = line.rpartition("error: ")
        if found:
            following = lines[number + 1] if number + 1 < len(lines) else ""
            return message, following.removeprefix("hint: ") if following.startswith("hint: ") else ""
    return lines[-1] if lines else "", ""


def _wait(process: subprocess.Popen[bytes], duration: float, realtime: bool, progress: Progress) -> bool:
    """Waits for the end of a process.  Returns False if it takes longer than :func:`patience`."""
    begin = time.monotonic()
    while (elapsed := time.monotonic() - begin) < patience(duration):
        try:
            process.wait(1.0)
            return True
        except subprocess.TimeoutExpired:
            progress(f"{elapsed + 1:.0f} of {duration:.0f} s" if realtime else f"running for {elapsed + 1:.0f} s")
    return False


def patience(duration: float) -> float:
    """The time in seconds after which a run is ended as hanging: three times its duration, and a minute to start."""
    return 60.0 + 3.0 * duration


def fail(executable: Path, message: str, hint: str) -> NoReturn:
    """Raises UserError with an error about the program."""
    diagnostics = Diagnostics()
    diagnostics.error("simulation-failed", Span(executable.name), message, hint=hint)
    raise UserError(diagnostics)


def read_statistics(path: Path) -> Statistics:
    """Reads ``statistics.json``.  Members that this version of EPG does not know are ignored."""
    found = json.loads(path.read_text(encoding="utf-8"))
    return Statistics(**{name: found[name] for name in Statistics.__dataclass_fields__})
