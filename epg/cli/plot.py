# SPDX-License-Identifier: Apache-2.0
"""``epg plot``: plots a recording, or compares it with another one, for example a real run with its simulation."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from epg.cli.arguments import add_time_range
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.source import Span

if TYPE_CHECKING:
    from epg.runs.compare import Comparison
    from epg.runs.recording import Recording


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("run", type=Path, metavar="RUN", help="a CSV file, or a folder that record or simulate wrote")
    parser.add_argument("--against", type=Path, metavar="RUN", help="run to compare with RUN")
    parser.add_argument(
        "--signal",
        action="append",
        default=[],
        metavar="NAME[=NAME]",
        help="a signal, and its name in the other run; repeat the option for more; default: all with equal names",
    )
    parser.add_argument(
        "--align",
        choices=("correlation", "motion", "none"),
        default="correlation",
        help="how to shift the runs in time: to the best match, to the first motion, or not at all",
    )
    parser.add_argument(
        "--by",
        action="append",
        default=[],
        metavar="NAME",
        help="signal that aligns the runs; repeat the option for more; default: the setpoints of both runs, else all",
    )
    add_time_range(parser, "compare from this time of the other run", "compare until this time")
    parser.add_argument(
        "--description",
        type=Path,
        metavar="JSON",
        help="the description of the target, <build>/epg/<name>/<name>.json: gives the units",
    )
    parser.add_argument(
        "--output",
        type=Path,
        metavar="FILE",
        help="file to write, *.png or *.svg; default: <name of RUN>.png in the current folder",
    )


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.generator import bootstrap

    bootstrap.ensure("plot")
    from epg.runs.recording import read_recording

    output = options.output or Path(f"{options.run.resolve().stem}.png")
    check_picture(output, diagnostics)
    units = _units(options, diagnostics)
    recording = read_recording(options.run, diagnostics, None if options.against else _MOST)
    other = read_recording(options.against, diagnostics) if options.against else None
    diagnostics.stop_if_errors()
    assert recording is not None
    if other is None:
        return _plot_one(recording, units, options, output, diagnostics)
    return _compare(recording, other, units, options, output, diagnostics)


def check_picture(path: Path, diagnostics: Diagnostics) -> None:
    """Reports the name of a picture that EPG cannot write."""
    from epg.runs.plot_style import PICTURES

    if path.suffix not in PICTURES:
        hint = f"the name must end in {' or '.join(PICTURES)}"
        message = f"'{path.name}' is not the name of a picture that EPG can write"
        diagnostics.error("picture-format", Span.of_argument(path.name, "--output"), message, hint=hint)


def _units(options: argparse.Namespace, diagnostics: Diagnostics) -> dict[str, str]:
    """The units of the signals, if the user has named a description."""
    from epg.runs.panels import read_units

    if options.description is None:
        return {}
    units = read_units(options.description)
    if units is None:
        hint = "the description is in the build folder: epg/<name>/<name>.json"
        message = "this is not the description of a generated target"
        diagnostics.error("not-a-description", Span(str(options.description)), message, hint=hint)
    return units or {}


def _plot_one(
    recording: Recording, units: dict[str, str], options: argparse.Namespace, output: Path, diagnostics: Diagnostics
) -> int:
    from epg.runs.compare_plot import plot_recording
    from epg.runs.panels import panels_of
    from epg.simulate.marks import state_marks

    # The state and the times of a trace are marks, and no curves unless the user asks for them.
    names = options.signal or [name for name in recording.signals if name not in _STATE] or list(recording.signals)
    for name in names:
        recording.check(name, "--signal", diagnostics)
    diagnostics.stop_if_errors()
    panels = panels_of(names, recording.setpoints, units)
    shown = plot_recording(recording, panels, output, _title(options.run), state_marks(recording.signals))
    _warn(shown, len(panels), "panels", output, diagnostics)
    print(f"wrote {output}")
    return 0


_STATE = ("enabled", "fault", "lateness", "computation", "cycle")
_MOST = 100_000
"""The greatest number of points of a signal in a plot: some 80 for each dot of the picture's width."""


def _warn(shown: int, count: int, what: str, output: Path, diagnostics: Diagnostics) -> None:
    if shown < count:
        hint = "--signal chooses signals"
        message = f"the plot shows the first {shown} of {count} {what}"
        diagnostics.warning("too-much-to-plot", Span(str(output)), message, hint=hint)


def _compare(
    recording: Recording,
    other: Recording,
    units: dict[str, str],
    options: argparse.Namespace,
    output: Path,
    diagnostics: Diagnostics,
) -> int:
    from epg.cli.report import to_json
    from epg.runs.compare import compare
    from epg.runs.compare_plot import plot_comparison
    from epg.simulate.marks import state_marks

    pairs = _pairs(recording, other, options.signal, diagnostics)
    by = _aligning(recording, other, pairs, options.by, diagnostics)
    diagnostics.stop_if_errors()
    comparison = compare(recording.signals, other.signals, pairs, options.align, by, (options.begin, options.until))
    for pair in comparison.pairs:
        if math.isnan(pair.rms):
            message = f"'{pair.name}' was not recorded at the same time in both runs after they were aligned"
            diagnostics.warning("no-overlap", Span(str(options.run)), message)
    if all(math.isnan(pair.rms) for pair in comparison.pairs):
        return 0
    titles = (_title(options.run), _title(options.against))
    shown = plot_comparison(comparison, units, titles, output, state_marks(other.signals))
    _warn(shown, sum(not math.isnan(pair.rms) for pair in comparison.pairs), "signals", output, diagnostics)
    if options.json:
        data = [
            {
                "signal": pair.name,
                "against": pair.against,
                "rms": pair.rms,
                "largest": pair.largest,
                "lag": pair.lag,
                "rms_without_lag": pair.rms_without_lag,
            }
            for pair in comparison.pairs
            if not math.isnan(pair.rms)
        ]
        sys.stdout.write(to_json({"shift": comparison.shift, "signals": data, "file": str(output)}))
    else:
        print(_table(comparison))
        print(f"\nwrote {output}")
    return 0


def _pairs(recording: Recording, other: Recording, wanted: list[str], diagnostics: Diagnostics) -> dict[str, str]:
    """The signals to compare, each with its name in the other run.

    They are those that the user named, or else all signals that have the same name in both runs.
    """
    if not wanted:
        common = {name: name for name in recording.signals if name in other.signals}
        if not common:
            hint = f"--signal a=b compares {', '.join(recording.signals)} with {', '.join(other.signals)}"
            diagnostics.error(
                "nothing-in-common", Span(str(other.path)), "no signal has the same name in both runs", hint=hint
            )
        return common
    pairs = {}
    for text in wanted:
        name, _, against = text.partition("=")
        pairs[name] = against or name
        recording.check(name, "--signal", diagnostics)
        other.check(pairs[name], "--signal", diagnostics)
    return pairs


def _aligning(
    recording: Recording, other: Recording, pairs: dict[str, str], wanted: list[str], diagnostics: Diagnostics
) -> dict[str, str]:
    """The signals that align the runs: those that the user named, else setpoints in both runs, else all ``pairs``."""
    for name in wanted:
        if name not in pairs:
            hint = did_you_mean(name, pairs, "compared")
            diagnostics.error(
                "unknown-recorded-signal", Span.of_argument(name, "--by"), f"'{name}' is not compared", hint=hint
            )
    if wanted:
        return {name: pairs[name] for name in wanted if name in pairs}
    return {name: name for name in sorted(recording.setpoints & other.setpoints)} or pairs


def _title(path: Path) -> str:
    """The name of a run in the legend: the name of its folder or file.

    A file with a name that every run has, such as topics.csv, is shown with its folder.
    """
    resolved = path.resolve()
    plain = resolved.stem in ("topics", "setpoints", "trace", "tracking")
    return f"{resolved.parent.name}/{resolved.name}" if plain else resolved.name


def _table(comparison: Comparison) -> str:
    from epg.cli.table import table

    rows = [
        (
            pair.name,
            f"{pair.rms:.4g}",
            f"{pair.largest:.4g}",
            f"{100.0 * pair.rms / pair.range:.2f} %" if pair.range else "",
            f"{_milli(pair.lag)} ms",
            f"{pair.rms_without_lag:.4g}",
        )
        for pair in comparison.pairs
        if not math.isnan(pair.rms)
    ]
    head = ("signal", "RMS difference", "largest", "RMS of range", "lag", "RMS without lag")
    return f"the run is shifted by {comparison.shift:+.4f} s\n\n" + table(head, rows)


def _milli(seconds: float) -> str:
    """A time in ms as text with its sign.  Small negative values become "+0.0", not "-0.0"."""
    return f"{round(1000.0 * seconds, 1) + 0.0:+.1f}"
