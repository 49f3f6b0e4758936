# SPDX-License-Identifier: Apache-2.0
"""``epg identify``: finds a motor's gain, time constant and friction in a recording, and writes them into the plant."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from epg.cli.arguments import add_time_range
from epg.cli.plot import check_picture
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.source import Span

if TYPE_CHECKING:
    from epg.generator.check.motors import Motor
    from epg.identify.bound_plant import BoundPlant
    from epg.identify.fit import Fit, FittedValue
    from epg.identify.samples import Samples
    from epg.runs.recording import Recording


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("run", type=Path, metavar="RUN", help="a CSV file, or a folder that record or simulate wrote")
    parser.add_argument("--duty", required=True, metavar="NAME", help="the signal that drives the motor")
    parser.add_argument("--position", required=True, metavar="NAME", help="the signal of its position")
    add_time_range(parser, "use the recording from this time", "use it until this time")
    parser.add_argument(
        "--dead-zone",
        action="store_true",
        help="the motor has a dead zone in place of friction; default: as the plant's bindings say",
    )
    parser.add_argument("--plant", type=Path, metavar="FOLDER", help="the model of the plant")
    parser.add_argument("--plant-bindings", type=Path, metavar="FILE", help="its bindings, with a section 'motors'")
    parser.add_argument("--motor", metavar="PORT", help="the plant's input; default: the one of the duty's actuator")
    parser.add_argument("--write", action="store_true", help="write the changed parameters into the plant's bindings")
    parser.add_argument(
        "--output",
        type=Path,
        metavar="FILE",
        help="picture to write, *.png or *.svg; default: <name of RUN>-<duty>.png in the current folder",
    )


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.generator import bootstrap

    if bool(options.plant) != bool(options.plant_bindings) or (options.write and not options.plant):
        sys.stderr.write("epg identify: --plant and --plant-bindings belong together, and --write needs both\n")
        return 2
    bootstrap.ensure("plot")
    from epg.identify.bound_plant import load_plant
    from epg.identify.fit import fit
    from epg.identify.judge import judge_fit, judge_samples
    from epg.identify.picture import plot_fit
    from epg.identify.samples import samples_of
    from epg.runs.recording import read_recording

    output = options.output or Path(f"{options.run.resolve().stem}-{options.duty.rpartition('.')[2]}.png")
    check_picture(output, diagnostics)
    recording = read_recording(options.run, diagnostics)
    plant = load_plant(options.plant, options.plant_bindings, diagnostics) if options.plant else None
    motor = _motor(plant, options, diagnostics) if plant is not None else None
    diagnostics.stop_if_errors()
    assert recording is not None
    if motor is not None:
        options.dead_zone = "dead_zone" in motor.formulas
    rows = _rows(recording, options, diagnostics)
    diagnostics.stop_if_errors()
    samples = samples_of(*rows)
    file = str(options.run)
    judge_samples(samples, options.position, options.duty, file, diagnostics)
    diagnostics.stop_if_errors()
    fitted = fit(samples, dead_zone=options.dead_zone)
    unit = plant.unit(motor) if plant is not None and motor is not None else ""
    values = _values(fitted, unit, options.dead_zone)
    title = f"{options.run.name}: " + ", ".join(f"{name} {value} {of}" for name, value, _, of in values[:3])
    plot_fit(samples, fitted, (options.position, options.duty), unit, title, output)
    judge_fit(fitted, samples, file, diagnostics)
    if diagnostics.has_errors:
        sys.stderr.write(f"epg identify: {output} shows the measured and the simulated curve\n")
        return 1
    result = _Result(fitted, samples, values, output)
    if plant is None or motor is None:
        result.print(options, {}, {}, "")
        return 0
    return _change(result, plant, motor, options, diagnostics)


def _rows(recording: Recording, options: argparse.Namespace, diagnostics: Diagnostics) -> tuple[Any, Any, Any]:
    """Times, positions and duties.  A duty holds until the next one; while a target is disabled, it is 0."""
    import numpy as np

    for name, option in ((options.duty, "--duty"), (options.position, "--position")):
        recording.check(name, option, diagnostics)
    diagnostics.stop_if_errors()
    driven, moved = recording.signals[options.duty], recording.signals[options.position]
    time, position = np.array(moved.time), np.array(moved.value)
    duty = np.array(driven.at(moved.time))
    enabled = recording.signals.get("enabled")
    if options.duty.startswith("outputs."):
        message = f"'{options.duty}' is the duty that the model wants: jog and dead times give the actuator another one"
        hint = "use 'actuators.<name>' of epg live, or 'plant.inputs.<port>' of a trace"
        diagnostics.warning("identify-wanted-duty", Span.of_argument(options.duty, "--duty"), message, hint=hint)
    if enabled is not None and options.duty.startswith("outputs."):
        # The model of a disabled target still computes a duty, but its actuators are safe.
        duty = duty * (np.array(enabled.at(moved.time)) > 0.5)
    chosen = (time >= max(options.begin, driven.time[0])) & (time <= options.until)
    time, position, duty = time[chosen], position[chosen], duty[chosen]
    fresh = np.concatenate(([True], np.diff(time) > 0.0)) if len(time) else np.array([], dtype=bool)
    time, position, duty = time[fresh], position[fresh], duty[fresh]
    if len(time) < 3:
        message = f"there are {len(time)} rows with both signals between --from and --until"
        diagnostics.error("identify-few-rows", Span(str(recording.path)), message, hint="choose another part")
    return time, position, duty


def _motor(plant: BoundPlant, options: argparse.Namespace, diagnostics: Diagnostics) -> Motor | None:
    """The motor of the plant that the recorded duty drives."""
    from epg.identify.bound_plant import motor_for

    motors = plant.bindings.motors
    if options.motor is not None:
        if options.motor not in motors:
            message = f"the plant's bindings have no motor '{options.motor}'"
            hint = did_you_mean(options.motor, motors, "motors")
            diagnostics.error("unknown-motor", Span.of_argument(options.motor, "--motor"), message, hint=hint)
        return motors.get(options.motor)
    found = motor_for(plant.bindings, options.duty)
    if found is None:
        message = f"no motor of the plant's bindings is driven by '{options.duty}'"
        hint = f"add --motor and one of: {', '.join(motors)}"
        diagnostics.error("unknown-motor", Span.of_argument(options.duty, "--duty"), message, hint=hint)
    return found


def _values(fit: Fit, unit: str, dead_zone: bool) -> list[tuple[str, str, str, str]]:
    """Each quantity with its value, its error for a confidence of 95 %, and its unit."""
    friction = "dead zone" if dead_zone else "friction"
    speed = f"{unit or 'position'}/s per unit of duty"
    return [
        ("gain", *_rounded(fit.gain, 1.0), speed),
        ("time constant", *_rounded(fit.time_constant, 1e3), "ms"),
        (friction, *_rounded(fit.friction, 1.0), "of duty"),
        ("delay", *_rounded(fit.delay, 1e3), "ms"),
    ]


def _rounded(fitted: FittedValue, factor: float) -> tuple[str, str]:
    """A value and its error, both to the second significant digit of the error.

    >>> from epg.identify.fit import FittedValue
    >>> _rounded(FittedValue(32.36571, 0.06792), 1.0), _rounded(FittedValue(0.0, 0.0), 1.0)
    (('32.37', '0.14'), ('0', 'at its limit'))
    """
    value, error = fitted.value * factor, 2.0 * fitted.error * factor
    if not error:
        return f"{value:.4g}", "at its limit"
    digits = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{digits}f}", f"{error:.{digits}f}"


class _Result:
    """The identified values, ready to be printed."""

    def __init__(self, fit: Fit, samples: Samples, rows: list[tuple[str, str, str, str]], picture: Path) -> None:
        self.fit, self.samples, self.rows, self.picture = fit, samples, rows, picture

    def print(
        self,
        options: argparse.Namespace,
        before: Mapping[str, float],
        changes: Mapping[str, tuple[float, float]],
        diff: str,
    ) -> None:
        """Prints all.  ``before`` are the values that the plant has so far, by their names in the bindings."""
        begin, end = float(self.samples.time[0]), float(self.samples.time[-1])
        if options.json:
            self._print_json(options, before, changes)
            return
        from epg.cli.table import table

        start = "from rest" if self.samples.at_rest else "already moving, or without rest before"
        counted = self.samples.counted
        size = f"{len(self.samples.time)} rows, {f'{self.samples.counts:.0f} counts, ' if counted else ''}{start}"
        print(f"{begin:.3f} s to {end:.3f} s: {size}\n")
        present = [f"{before[name] * (1e3 if 'time' in name else 1):.4g}" for name in before]
        heads = ("", "identified", "+-", "", *(("plant so far",) if before else ()))
        cells = present + [""] * (len(self.rows) - len(present))
        print(table(heads, [(*row, cell) if before else row for row, cell in zip(self.rows, cells)]))
        counts = f", which is {self.fit.rms / self.samples.resolution:.2f} counts" if counted else ""
        print(f"\nRMS of measured - simulated: {self.fit.rms:.3g}{counts}")
        print(f"wrote {self.picture}")
        if diff:
            print(f"\n{diff}", end="")

    def _print_json(
        self, options: argparse.Namespace, before: Mapping[str, float], changes: Mapping[str, tuple[float, float]]
    ) -> None:
        from epg.cli.report import to_json

        names = ("gain", "time_constant", "friction", "delay")
        values = {name: getattr(self.fit, name) for name in names}
        data = {
            "from": float(self.samples.time[0]),
            "until": float(self.samples.time[-1]),
            "rows": len(self.samples.time),
            "counts": self.samples.counts if self.samples.counted else None,
            "values": {name: {"value": each.value, "standard_error": each.error} for name, each in values.items()},
            "rms": self.fit.rms,
            "plant": dict(before),
            "changes": {name: {"from": old, "to": new} for name, (old, new) in changes.items()},
            "written": bool(options.write),
            "file": str(self.picture),
        }
        sys.stdout.write(to_json(data))


def _change(
    result: _Result, plant: BoundPlant, motor: Motor, options: argparse.Namespace, diagnostics: Diagnostics
) -> int:
    """Prints the changes of the plant's parameters, and writes them if the user wants it and they are correct."""
    from epg.edit.yaml_edit import CannotEdit
    from epg.generator.check.formulas import FormulaError
    from epg.generator.emit.leftovers import replace_file
    from epg.identify.bound_plant import NoSolution, changed_text, load_plant, solved, wanted_values

    file = options.plant_bindings
    try:
        before = dict(zip(motor.formulas, motor.values(plant.known()), strict=True))
        wanted = wanted_values(motor, plant.bindings, result.fit, options.duty, options.position)
        new = solved(plant, motor, wanted)
        old_text = file.read_bytes().decode("utf-8")
        text = changed_text(old_text, plant, new)
    except (FormulaError, NoSolution) as problem:
        result.print(options, {}, {}, "")
        hint = "name another parameter in 'change', or correct a parameter that is known"
        diagnostics.error("identify-no-solution", motor.span, str(problem), hint=hint)
        return 1
    except CannotEdit as problem:
        result.print(options, {}, {}, "")
        sys.stderr.write(f"epg identify: {file} was not changed: {problem}\n")
        return 1
    # The new text must be as correct as a file that `epg check` accepts: a parameter can have limits.
    checked = load_plant(options.plant, file, diagnostics, {file: text})
    changes = {name: (plant.values[name], value) for name, value in new.items()}
    result.print(options, before, changes, _difference(old_text, text, str(file)))
    if checked is None:
        return 1
    if options.write:
        replace_file(file.resolve(), text.encode("utf-8"), file.stat().st_mode & 0o777)
    if not options.json:
        print(f"\nwrote {file}" if options.write else f"\n{file} was not changed: --write writes this")
    return 0


def _difference(old: str, new: str, file: str) -> str:
    from difflib import unified_diff

    lines = unified_diff(old.splitlines(keepends=True), new.splitlines(keepends=True), file, file, n=1)
    return "".join(line if line.endswith("\n") else line + "\n" for line in lines)
