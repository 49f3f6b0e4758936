"""Runs a host executable and reads what it wrote."""

from __future__ import annotations

import csv
import json
import subprocess
import time
from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from epg.diagnostics import Diagnostics, UserError, did_you_mean
from epg.source import Span

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Statistics:
    """What the run counted (``docs/host.md``); times in s."""

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
    scheduler: str


def run_executable(
    executable: Path, folder: Path, duration: float, setpoints: Path, *, realtime: bool, progress: Progress
) -> None:
    """Runs ``executable`` in ``folder``, where it writes ``trace.csv``, ``topics.csv`` and ``statistics.json``.

    Raises UserError when it cannot be started, takes far too long, or fails.
    """
    folder = folder.resolve()
    # The form -option=value is the only one that native_sim understands; its simulated flash is a file where it runs.
    command = [str(executable.resolve()), "--quiet", f"--duration={duration!r}", f"--setpoints={setpoints.resolve()}"]
    command += [f"--{option}={folder / f'{option}.csv'}" for option in ("topics", "trace")]
    command.append(f"--statistics={folder / 'statistics.json'}")
    if realtime:
        command.append("--realtime")
    unit = "s in real time" if realtime else "s of simulated time"
    progress(f"running {executable.name}: {duration:g} {unit}")
    log = folder / "messages.txt"
    try:
        with (
            log.open("wb") as messages,
            subprocess.Popen(command, stdout=messages, stderr=messages, cwd=folder) as process,
        ):
            if not _wait(process, duration, realtime, progress):
                process.kill()
                _fail(executable, f"'{executable.name}' did not end", f"killed after {_patience(duration):.0f} s")
            status = process.returncode
    except OSError as error:
        _fail(executable, f"cannot run '{executable.name}': {error.strerror}", "build it first")
    if status != 0:
        said = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()[-10:]
        _fail(executable, f"'{executable.name}' ended with status {status}", "\n".join(said))
    log.unlink()


def _wait(process: subprocess.Popen[bytes], duration: float, realtime: bool, progress: Progress) -> bool:
    begin = time.monotonic()
    while (elapsed := time.monotonic() - begin) < _patience(duration):
        try:
            process.wait(1.0)
            return True
        except subprocess.TimeoutExpired:
            progress(f"{elapsed + 1:.0f} of {duration:.0f} s" if realtime else f"running for {elapsed + 1:.0f} s")
    return False


def _patience(duration: float) -> float:
    """Time after which a run counts as hanging: three times real time, and a minute for slow starts."""
    return 60.0 + 3.0 * duration


def _fail(executable: Path, message: str, hint: str) -> NoReturn:
    diagnostics = Diagnostics()
    diagnostics.error("simulation-failed", Span(executable.name), message, hint=hint)
    raise UserError(diagnostics)


def read_statistics(path: Path) -> Statistics:
    """Members that this version does not know are ignored."""
    found = json.loads(path.read_text(encoding="utf-8"))
    return Statistics(**{name: found[name] for name in Statistics.__dataclass_fields__})


def read_trace(path: Path, wanted: Sequence[tuple[str, Span]]) -> dict[str, array[float]]:
    """The columns ``time`` and ``wanted`` (signal and where it is asked for) of a trace.

    Raises UserError for a signal the target does not have.
    """
    with path.open(encoding="utf-8", newline="") as file:
        rows = csv.reader(file)
        header = next(rows)
        diagnostics = Diagnostics()
        for name, span in wanted:
            if name not in header:
                signals = [column for column in header if "." in column]
                message = f"the target has no signal '{name}'"
                diagnostics.error("unknown-signal", span, message, hint=did_you_mean(name, signals, "signals"))
        diagnostics.stop_if_errors()
        columns = {name: header.index(name) for name in sorted({"time", *(name for name, _ in wanted)})}
        values: dict[str, array[float]] = {name: array("d") for name in columns}
        for row in rows:
            for name, index in columns.items():
                values[name].append(float(row[index]))
    return values
