# SPDX-License-Identifier: Apache-2.0
"""Replays a recording with a host program, and compares the outputs of the model in every control cycle."""

from __future__ import annotations

import math
import struct
import tempfile
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from epg.diagnostics import Diagnostics, did_you_mean
from epg.live.recording import BEGIN, UNKNOWN, Recorded
from epg.simulate.executable import Progress, read_trace, run_program
from epg.simulate.interface import Interface, read_interface
from epg.source import Span

TOLERANCE = 1e-9
"""The tolerance of a model whose functions depend on the C library, as a part of an output's largest value.

The last bit of a result of ``sin`` or ``exp`` can differ between two C libraries, which is 2e-16 of its size.  A
million steps that add such differences to a state stay below 1e-9; a fault of a controller is far above.
"""


@dataclass(frozen=True)
class OutputResult:
    """The comparison of one output.  ``first`` is the first cycle that differs, with its time; None: all are equal."""

    name: str
    cycles: int
    differ: int
    largest: float  # the largest difference
    allowed: float  # the tolerance for this output; 0: every bit must be equal
    first: tuple[int, float] | None

    @property
    def passed(self) -> bool:
        return self.differ == 0 or self.largest <= self.allowed


@dataclass(frozen=True)
class Replayed:
    """The result of a replay.  ``functions`` are those of the model whose last bits depend on the C library.

    ``enablings`` is the number of times that the target was enabled.  ``stopped`` is the first cycle in which the
    replay had a fault that the recording does not have.
    """

    outputs: tuple[OutputResult, ...]
    cycles: int
    enablings: int
    changes: int
    functions: tuple[str, ...]
    tolerance: float
    stopped: tuple[int, float] | None

    @property
    def passed(self) -> bool:
        return self.stopped is None and all(output.passed for output in self.outputs)

    def data(self) -> dict[str, Any]:
        return {
            "passed": self.passed,
            "cycles": self.cycles,
            "enablings": self.enablings,
            "changes": self.changes,
            "functions": list(self.functions),
            "tolerance": self.tolerance,
            "stopped": self.stopped and {"cycle": self.stopped[0], "time": self.stopped[1]},
            "outputs": [
                {
                    "name": output.name,
                    "cycles": output.cycles,
                    "differ": output.differ,
                    "largest": output.largest if math.isfinite(output.largest) else None,
                    "allowed": output.allowed,
                    "first": output.first and {"cycle": output.first[0], "time": output.first[1]},
                    "passed": output.passed,
                }
                for output in self.outputs
            ],
        }


def check_recording(found: Recorded, executable: Path, diagnostics: Diagnostics) -> tuple[Interface, list[int]]:
    """The program's interface, and the rows of ``found`` that can be replayed.

    Raises UserError if the recording cannot be replayed by this program.
    """
    interface = read_interface(executable)
    _check_program(found, executable, interface, diagnostics)
    rows = _enabled_rows(found, diagnostics)
    for row in rows:
        for name, column in found.columns.items():
            if name.startswith("inputs.") and not math.isfinite(column[row]):
                message = f"'{name}' is {column[row]} in an enabled cycle, which disables every target"
                hint = "the recording was changed after it was made: record the run again"
                diagnostics.error("replay-recording", found.span(row), message, hint=hint)
                diagnostics.stop_if_errors()
    for row, change in found.changes.items():
        if UNKNOWN in change.split(" "):
            message = f"the recording does not know a change of a parameter at {found.times[row]:.6g} s"
            hint = "the target's program changed parameters faster than a stream tells them, or rows were dropped"
            diagnostics.error("replay-parameters", found.span(row), message, hint=hint)
            break
    diagnostics.stop_if_errors()
    return interface, rows


def _check_program(found: Recorded, executable: Path, interface: Interface, diagnostics: Diagnostics) -> None:
    whole = Span(str(found.path), 1 if not found.is_trace else 0)
    models = interface.names.get("model", ())
    if interface.system or not models:
        message = f"'{executable.name}' cannot replay a recording"
        hint = "name the host program of one target, built by this EPG"
        diagnostics.error("replay-program", Span(executable.name), message, hint=hint)
        diagnostics.stop_if_errors()
    if found.model and found.model != models[0]:
        message = (
            f"the recording is of another model or of other generated parameters: {found.model}, "
            f"'{executable.name}' has {models[0]}"
        )
        hint = "build the program from the model and the bindings of the recorded target"
        diagnostics.error("replay-model", whole, message, hint=hint)
    period = int(interface.names["period"][0]) / 1e9
    if found.period and abs(found.period - period) > 1e-9 * period:
        message = f"the recorded control period is {found.period:g} s, that of '{executable.name}' is {period:g} s"
        hint = "set 'period' in 'control' of the host's .tcf"
        diagnostics.error("replay-model", whole, message, hint=hint)
    for signal in interface.names["signal"]:
        if signal.startswith(("inputs.", "outputs.")) and signal not in found.columns and not found.model:
            message = f"the recording has no '{signal}'"
            hint = "a trace for a replay has all inputs and outputs of the model, and is of the same model"
            diagnostics.error("replay-recording", Span(str(found.path), found.first - 1), message, hint=hint)
    counts = [
        (kind, sum(name.startswith(kind) for name in interface.names["signal"]), [*found.columns])
        for kind in ("inputs.", "outputs.")
    ]
    for kind, count, names in counts:
        recorded = sum(name.startswith(kind) for name in names)
        if found.model == models[0] and recorded != count:
            message = f"the recording has {recorded} of the model's {count} {kind[:-1]}"
            hint = "the recording was changed after it was made: record the run again"
            diagnostics.error("replay-recording", Span(str(found.path), found.first - 1), message, hint=hint)
    diagnostics.stop_if_errors()


def _enabled_rows(found: Recorded, diagnostics: Diagnostics) -> list[int]:
    """The rows of all enabled parts that the recording has from their enabling on."""
    rows: list[int] = []
    before = 0
    left_out = 0  # rows at the beginning, of a target that was enabled before the recording
    for row, cycle in enumerate(found.cycles):
        if cycle > 1 and left_out == row:
            left_out = row + 1
            continue
        if cycle > 0 and cycle not in (1, before + 1):
            missing = cycle - before - 1 if cycle > before else cycle - 1
            time = found.times[row - 1]
            message = f"{missing} control cycle{'s are' if missing > 1 else ' is'} missing after {time:.6g} s"
            hint = "rows were dropped: a larger 'capture' in 'communication' of the .tcf keeps more rows in memory"
            diagnostics.error("replay-gap", found.span(row), message, hint=hint)
            break
        if cycle > 0:
            rows.append(row)
        before = cycle
    if left_out > 0 and rows:
        message = f"the recording begins while the target is enabled: its first {left_out} cycles are not replayed"
        diagnostics.note("replay-begin", found.span(0), message)
    elif left_out > 0 and not diagnostics.has_errors:
        message = "the recording begins while the target is enabled: the state of the model is not known"
        hint = "disable the target, then record: epg live PORT --record FILE --send enable"
        diagnostics.error("replay-begin", found.span(0), message, hint=hint)
    elif not rows and not diagnostics.has_errors:
        message = "the target is not enabled in this recording"
        hint = "record the enabling: epg live PORT --record FILE --send enable"
        diagnostics.error("replay-begin", Span(str(found.path)), message, hint=hint)
    return rows


def replay(
    found: Recorded,
    executable: Path,
    diagnostics: Diagnostics,
    *,
    changed: Sequence[tuple[str, str]] = (),
    tolerance: float | None = None,
    trace: Path | None = None,
    progress: Progress = lambda text: None,
) -> Replayed:
    """Replays ``found`` with the host program ``executable``.

    ``changed`` are parameters that have other values during the whole replay.  ``tolerance`` replaces that of the
    model.  The replay's own trace becomes the file ``trace``.

    Raises UserError if the recording cannot be replayed by this program.
    """
    interface, rows = check_recording(found, executable, diagnostics)
    for name, _ in changed:
        known = interface.names.get("parameter", ())
        if name not in known:
            message = f"'{executable.name}' has no parameter '{name}' that can be changed"
            diagnostics.error("unknown-parameter", Span.of_argument("--set"), message, hint=did_you_mean(name, known))
    diagnostics.stop_if_errors()
    with tempfile.TemporaryDirectory(prefix="epg_replay") as name:
        folder = Path(name)
        _write(found, rows, changed, folder / "recording.csv")
        options = ["--quiet", f"--replay={folder / 'recording.csv'}", f"--trace={folder / 'trace.csv'}"]
        progress(f"replaying {len(rows)} control cycles")
        run_program(executable, options, folder, len(rows) / 1000, realtime=False, progress=progress)
        outputs = [name for name in found.columns if name.startswith("outputs.")]
        replayed, states = _read(folder / "trace.csv", outputs)
        if trace is not None:
            trace.write_bytes((folder / "trace.csv").read_bytes())
    functions = tuple(sorted(interface.names.get("function", ())))
    part = tolerance if tolerance is not None else TOLERANCE if functions else 0.0
    results = [_compare(found, rows, name, values, part) for name, values in zip(outputs, replayed, strict=True)]
    stopped = next((row for row, enabled in zip(rows, states) if enabled < 0.5), None)
    return Replayed(
        outputs=tuple(results),
        cycles=len(rows),
        enablings=sum(found.cycles[row] == 1 for row in rows),
        changes=sum(len(found.changes[row].split(" ")) for row in rows if row in found.changes),
        functions=functions,
        tolerance=part,
        stopped=None if stopped is None else (found.cycles[stopped], found.times[stopped]),
    )


def _read(path: Path, outputs: Sequence[str]) -> tuple[list[array[float]], array[float]]:
    """The columns of the model's outputs in the replay's trace, in the order of ``outputs``, and ``enabled``.

    The console replaces blanks in names, so that those of a recording can differ from those of the trace.
    """
    with path.open(encoding="utf-8") as file:
        names = [name for name in file.readline().rstrip("\n").split(",") if name.startswith("outputs.")]
    if set(names) == set(outputs):
        names = list(outputs)
    columns = read_trace(path, [*names, "enabled"])
    return [columns[name] for name in names], columns["enabled"]


def _write(found: Recorded, rows: Sequence[int], changed: Sequence[tuple[str, str]], path: Path) -> None:
    """Writes the rows as a recording for the program, with the values of ``changed``."""
    names = [name for name in found.columns if name.startswith("inputs.")]
    columns = [found.columns[name] for name in names]
    fixed = dict(changed)
    begin = " ".join(f"{name}={value}" for name, value in fixed.items())
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(f"{BEGIN}{{}}\n{','.join(('time', 'cycle', *names, 'changes'))}\n")
        for row in rows:
            words = found.changes.get(row, "").split()
            changes = [word for word in words if word.rpartition("=")[0] not in fixed]
            changes += [begin] if begin and found.cycles[row] == 1 else []
            values = [repr(column[row]) for column in columns]
            time, cycle = repr(found.times[row]), str(found.cycles[row])
            file.write(",".join((time, cycle, *values, " ".join(changes))) + "\n")


def _compare(found: Recorded, rows: Sequence[int], name: str, values: array[float], part: float) -> OutputResult:
    recorded = found.columns[name]
    differ, largest = 0, 0.0
    first: tuple[int, float] | None = None
    for row, value in zip(rows, values, strict=True):
        if struct.pack("<d", recorded[row]) == struct.pack("<d", value):
            continue
        difference = abs(recorded[row] - value)
        differ += 1
        largest = max(largest, difference if math.isfinite(difference) else math.inf)
        first = first or (found.cycles[row], found.times[row])
    allowed = part * max((abs(recorded[row]) for row in rows if math.isfinite(recorded[row])), default=0.0)
    return OutputResult(name, len(rows), differ, largest, allowed, first)
