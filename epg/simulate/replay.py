# SPDX-License-Identifier: Apache-2.0
"""Replays a recording with a host program, and compares the outputs of the model in every control cycle."""

from __future__ import annotations

import math
import struct
import tempfile
from array import array
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.source import Span
from epg.runs.csv_file import CsvFile
from epg.runs.executable import Progress, run_program
from epg.runs.interface import Interface, read_interface
from epg.runs.recording import CHANGES, UNKNOWN, Recording, Row, Signal, WrongRecording, read_table

TOLERANCE = 1e-9
"""The tolerance of a model whose functions depend on the C library, as a part of an output's largest value.

The last bit of a result of ``sin`` or ``exp`` can differ between two C libraries, which is 2e-16 of its size.  A
million steps that add such differences to a state stay below 1e-9; a fault of a controller is far above.
"""
_PORTS = ("inputs.", "outputs.")
_HINT = "record one with 'epg live PORT --record FILE --send enable'"
_CHANGED = "the recording was changed after it was made: record the run again"
_OTHER = "this file is neither a recording of 'epg live --record' nor a trace of a host program"


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

    cycles: int
    enablings: int
    changes: int
    functions: tuple[str, ...]
    tolerance: float
    stopped: tuple[int, float] | None
    outputs: tuple[OutputResult, ...]

    @property
    def passed(self) -> bool:
        return self.stopped is None and all(output.passed for output in self.outputs)

    def data(self) -> dict[str, Any]:
        outputs = [
            {
                **asdict(output),
                "largest": output.largest if math.isfinite(output.largest) else None,
                "first": _place(output.first),
                "passed": output.passed,
            }
            for output in self.outputs
        ]
        return {"passed": self.passed, **asdict(self), "stopped": _place(self.stopped), "outputs": outputs}


def _place(cycle: tuple[int, float] | None) -> dict[str, float] | None:
    return cycle and {"cycle": cycle[0], "time": cycle[1]}


def read_cycles(path: Path, diagnostics: Diagnostics) -> Recording | None:
    """Reads a recording of ``epg live --record``, or a trace of a host program.  None after an error.

    Its signal ``cycle`` is the number of each control cycle since the enabling, or 0 while the target is disabled.  A
    trace has no model, and no changes of parameters.
    """
    try:
        recording = read_table(path, lambda name: name in ("cycle", "enabled") or name.startswith(_PORTS))
    except WrongRecording as problem:
        hint = _CHANGED if problem.id == "wrong-recording" and problem.line > 1 else _HINT
        message = _OTHER if problem.id == "not-a-recording" else str(problem)
        diagnostics.error("replay-recording", Span(str(path), problem.line), message, hint=hint)
        return None
    state = recording.signals.get("cycle" if recording.model else "enabled")
    if state is None:
        diagnostics.error("replay-recording", recording.span(-1), _OTHER, hint=_HINT)
        return None
    for row, value in enumerate(state.value):
        if not abs(value) < 1e15:
            message = f"'{value}' is not the number of a control cycle"
            diagnostics.error("replay-recording", recording.span(row), message, hint=_CHANGED)
            return None
    numbers = array("q", map(int, state.value)) if recording.model else _numbers_of_trace(state)
    recording.signals["cycle"] = Signal(state.time, numbers)
    return recording


def _numbers_of_trace(enabled: Signal) -> Sequence[int]:
    numbers = array("q")
    for time, value in zip(enabled.time, enabled.value):
        # The first control cycle initialises the model, too.
        number = numbers[-1] + 1 if numbers else 2 if time > 0.0 else 1
        numbers.append(number if value > 0.5 else 0)
    return numbers


def check_recording(recording: Recording, executable: Path, diagnostics: Diagnostics) -> tuple[Interface, list[int]]:
    """The program's interface, and the rows of ``recording`` that can be replayed.

    Raises UserError if the recording cannot be replayed by this program.
    """
    interface = read_interface(executable)
    _check_program(recording, executable, interface, diagnostics)
    rows = _enabled_rows(recording, diagnostics)
    for row in rows:
        for name, signal in recording.signals.items():
            if name.startswith("inputs.") and not math.isfinite(signal.value[row]):
                message = f"'{name}' is {signal.value[row]} in an enabled cycle, which disables every target"
                diagnostics.error("replay-recording", recording.span(row), message, hint=_CHANGED)
                diagnostics.stop_if_errors()
    for row, change in recording.changes.items():
        if UNKNOWN in change.split(" "):
            time = recording.signals["cycle"].time[row]
            message = f"the recording does not know a change of a parameter at {time:.6g} s"
            hint = "the target's program changed parameters faster than a stream tells them, or rows were dropped"
            diagnostics.error("replay-parameters", recording.span(row), message, hint=hint)
            break
    diagnostics.stop_if_errors()
    return interface, rows


def _check_program(recording: Recording, executable: Path, interface: Interface, diagnostics: Diagnostics) -> None:
    whole = Span(str(recording.path), 1 if recording.model else 0)
    models = interface.names.get("model", ())
    if interface.system or not models:
        message = f"'{executable.name}' cannot replay a recording"
        hint = "name the host program of one target, built by this EPG"
        diagnostics.error("replay-program", Span(executable.name), message, hint=hint)
        diagnostics.stop_if_errors()
    if recording.model and recording.model != models[0]:
        message = (
            f"the recording is of another model or of other generated parameters: {recording.model}, "
            f"'{executable.name}' has {models[0]}"
        )
        hint = "build the program from the model and the bindings of the recorded target"
        diagnostics.error("replay-model", whole, message, hint=hint)
    period = int(interface.names["period"][0]) / 1e9
    if recording.period and abs(recording.period - period) > 1e-9 * period:
        message = f"the recorded control period is {recording.period:g} s, that of '{executable.name}' is {period:g} s"
        hint = "set 'period' in 'control' of the host's .tcf"
        diagnostics.error("replay-model", whole, message, hint=hint)
    _check_ports(recording, interface, models[0], diagnostics)
    diagnostics.stop_if_errors()


def _check_ports(recording: Recording, interface: Interface, model: str, diagnostics: Diagnostics) -> None:
    """Reports inputs and outputs of ``model`` that a trace does not have, and numbers of them that differ."""
    names = recording.span(-1)
    ports = [signal for signal in interface.names["signal"] if signal.startswith(_PORTS)]
    for signal in () if recording.model else ports:
        if signal not in recording.signals:
            message = f"the recording has no '{signal}'"
            hint = "a trace for a replay has all inputs and outputs of the model, and is of the same model"
            diagnostics.error("replay-recording", names, message, hint=hint)
    for kind in ("inputs", "outputs") if recording.model == model else ():
        count, recorded = (sum(name.startswith(f"{kind}.") for name in each) for each in (ports, recording.signals))
        if recorded != count:
            message = f"the recording has {recorded} of the model's {count} {kind}"
            diagnostics.error("replay-recording", names, message, hint=_CHANGED)


def _enabled_rows(recording: Recording, diagnostics: Diagnostics) -> list[int]:
    """The rows of all enabled parts that the recording has from their enabling on."""
    rows: list[int] = []
    before = 0
    left_out = 0  # rows at the beginning, of a target that was enabled before the recording
    for row, cycle in enumerate(map(int, recording.signals["cycle"].value)):
        if cycle > 1 and left_out == row:
            left_out = row + 1
            continue
        if cycle > 0 and cycle not in (1, before + 1):
            missing = cycle - before - 1 if cycle > before else cycle - 1
            time = recording.signals["cycle"].time[row - 1]
            message = f"{missing} control cycle{'s are' if missing > 1 else ' is'} missing after {time:.6g} s"
            hint = "rows were dropped: a larger 'capture' in 'communication' of the .tcf keeps more rows in memory"
            diagnostics.error("replay-gap", recording.span(row), message, hint=hint)
            break
        if cycle > 0:
            rows.append(row)
        before = cycle
    if left_out > 0 and rows:
        message = f"the recording begins while the target is enabled: its first {left_out} cycles are not replayed"
        diagnostics.note("replay-begin", recording.span(0), message)
    elif left_out > 0 and not diagnostics.has_errors:
        message = "the recording begins while the target is enabled: the state of the model is not known"
        hint = "disable the target, then record: epg live PORT --record FILE --send enable"
        diagnostics.error("replay-begin", recording.span(0), message, hint=hint)
    elif not rows and not diagnostics.has_errors:
        message = "the target is not enabled in this recording"
        hint = "record the enabling: epg live PORT --record FILE --send enable"
        diagnostics.error("replay-begin", Span(str(recording.path)), message, hint=hint)
    return rows


def replay(
    recording: Recording,
    executable: Path,
    diagnostics: Diagnostics,
    *,
    changed: Sequence[tuple[str, str]] = (),
    tolerance: float | None = None,
    trace: Path | None = None,
    progress: Progress = lambda text: None,
) -> Replayed:
    """Replays ``recording``, which :func:`read_cycles` has read, with the host program ``executable``.

    ``changed`` are parameters that have other values during the whole replay.  ``tolerance`` replaces that of the
    model.  The replay's own trace becomes the file ``trace``.

    Raises UserError if the recording cannot be replayed by this program.
    """
    interface, rows = check_recording(recording, executable, diagnostics)
    for name, _ in changed:
        known = interface.names.get("parameter", ())
        if name not in known:
            message = f"'{executable.name}' has no parameter '{name}' that can be changed"
            diagnostics.error("unknown-parameter", Span.of_argument("--set"), message, hint=did_you_mean(name, known))
    diagnostics.stop_if_errors()
    with tempfile.TemporaryDirectory(prefix="epg_replay") as name:
        folder = Path(name)
        _write(recording, rows, changed, folder / "recording.csv")
        options = ["--quiet", f"--replay={folder / 'recording.csv'}", f"--trace={folder / 'trace.csv'}"]
        progress(f"replaying {len(rows)} control cycles")
        run_program(executable, options, folder, len(rows) / 1000, realtime=False, progress=progress)
        outputs = [name for name in recording.signals if name.startswith("outputs.")]
        replayed, states = _read(folder / "trace.csv", outputs)
        if trace is not None:
            trace.write_bytes((folder / "trace.csv").read_bytes())
    replayable, cycle = set(rows), recording.signals["cycle"]
    functions = tuple(sorted(interface.names.get("function", ())))
    part = tolerance if tolerance is not None else TOLERANCE if functions else 0.0
    results = [_compare(recording, rows, name, values, part) for name, values in zip(outputs, replayed, strict=True)]
    stopped = next((row for row, enabled in zip(rows, states) if enabled < 0.5), None)
    return Replayed(
        outputs=tuple(results),
        cycles=len(rows),
        enablings=sum(cycle.value[row] == 1 for row in rows),
        changes=sum(len(changes.split(" ")) for row, changes in recording.changes.items() if row in replayable),
        functions=functions,
        tolerance=part,
        stopped=None if stopped is None else (int(cycle.value[stopped]), cycle.time[stopped]),
    )


def _read(path: Path, outputs: Sequence[str]) -> tuple[list[Sequence[float]], Sequence[float]]:
    """The columns of the model's outputs in the replay's trace, in the order of ``outputs``, and ``enabled``.

    The console replaces blanks in names, so that those of a recording can differ from those of the trace.
    """
    signals = read_table(path, lambda name: name == "enabled" or name.startswith("outputs.")).signals
    enabled = signals.pop("enabled").value
    names = outputs if signals.keys() == set(outputs) else signals
    return [signals[name].value for name in names], enabled


def _write(recording: Recording, rows: Sequence[int], changed: Sequence[tuple[str, str]], path: Path) -> None:
    """Writes the rows as a recording for the program, with the values of ``changed``."""
    names = [name for name in recording.signals if name.startswith("inputs.")]
    cycle, *columns = (recording.signals[name] for name in ("cycle", *names))
    fixed = dict(changed)
    begin = " ".join(f"{name}={value}" for name, value in fixed.items())
    with CsvFile(path, ("cycle", *names, CHANGES), "%s", "%s", facts={}) as file:
        for row in rows:
            words = recording.changes.get(row, "").split()
            changes = [word for word in words if word.rpartition("=")[0] not in fixed]
            changes += [begin] if begin and cycle.value[row] == 1 else []
            values = (cycle.value[row], *(column.value[row] for column in columns), " ".join(changes))
            file.write([Row(cycle.time[row], values)])


def _compare(
    recording: Recording, rows: Sequence[int], name: str, values: Sequence[float], part: float
) -> OutputResult:
    recorded, cycle = recording.signals[name].value, recording.signals["cycle"]
    differ, largest = 0, 0.0
    first: tuple[int, float] | None = None
    for row, value in zip(rows, values, strict=True):
        if struct.pack("<d", recorded[row]) == struct.pack("<d", value):
            continue
        difference = abs(recorded[row] - value)
        differ += 1
        largest = max(largest, difference if math.isfinite(difference) else math.inf)
        first = first or (int(cycle.value[row]), cycle.time[row])
    allowed = part * max((abs(recorded[row]) for row in rows if math.isfinite(recorded[row])), default=0.0)
    return OutputResult(name, len(rows), differ, largest, allowed, first)
