# SPDX-License-Identifier: Apache-2.0
"""``epg replay``: feeds a recording of a target to its host program, and compares the outputs of every cycle."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from epg.generator.diagnostics import Diagnostics

if TYPE_CHECKING:
    from epg.simulate.replay import Replayed

EXIT_DIFFERENT = 5
"""The exit status if an output differs by more than the tolerance."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "recording",
        type=Path,
        metavar="RECORDING",
        help="a recording of 'epg live --record', or a trace of a host program",
    )
    parser.add_argument(
        "executable", type=Path, metavar="EXECUTABLE", help="a host executable made by epg_add_executable()"
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        type=_change,
        metavar="NAME=VALUE",
        dest="changed",
        help="another value of a parameter, during the whole replay; can be repeated",
    )
    parser.add_argument(
        "--tolerance",
        type=_part,
        metavar="PART",
        help="largest difference as a part of an output's largest value; default: 0 for a model with + - * / only, "
        "else 1e-9",
    )
    parser.add_argument(
        "--trace", type=Path, metavar="FILE", help="also writes the signals of the replay to a CSV file"
    )
    parser.add_argument("--force", action="store_true", help="overwrite this file")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.cli.arguments import refuse_existing
    from epg.cli.progress import ProgressLine
    from epg.cli.report import to_json
    from epg.simulate.replay import read_cycles, replay

    refuse_existing([options.trace], options.force, diagnostics)
    recording = diagnostics.checked(read_cycles(options.recording, diagnostics))
    progress = ProgressLine(quiet=options.json)
    try:
        result = replay(
            recording,
            options.executable,
            diagnostics,
            changed=options.changed,
            tolerance=options.tolerance,
            trace=options.trace,
            progress=progress,
        )
    finally:
        progress.done()
    if options.json:
        sys.stdout.write(to_json(result.data()))
    else:
        print(_text(result))
        if not result.passed and not recording.model:
            print("A trace has no changes of parameters: the replay has the generated values.")
    return 0 if result.passed else EXIT_DIFFERENT


def _text(result: Replayed) -> str:
    from epg.cli.table import table

    rows = [
        (
            output.name,
            output.cycles,
            output.differ,
            f"{output.largest:.3g}" if output.differ else "-",
            f"cycle {output.first[0]}, {output.first[1]:.6g} s" if output.first else "-",
        )
        for output in result.outputs
    ]
    lines = [table(("output", "cycles", "differ", "largest difference", "first difference"), rows), ""]
    counts = [(result.cycles, "control cycle"), (result.enablings, "enabling"), (result.changes, "change")]
    told = ", ".join(f"{number} {word}{'' if number == 1 else 's'}" for number, word in counts)
    lines += [f"{told} of parameters", f"tolerance: {_tolerance(result)}"]
    if result.stopped is not None:
        lines.append(
            f"in cycle {result.stopped[0]} ({result.stopped[1]:.6g} s), the replay had a fault that the recording "
            "does not have: its model stopped, or a value was not finite"
        )
    differ = sum(output.differ > 0 for output in result.outputs)
    if result.passed:
        lines.append("equal to the bit" if differ == 0 else "equal within the tolerance")
    else:
        lines.append("DIFFERENT")
    return "\n".join(lines)


def _tolerance(result: Replayed) -> str:
    """The tolerance, and the reason for it."""
    if result.tolerance > 0:
        reason = f", because the model calls {', '.join(result.functions)}" if result.functions else ""
        return f"{result.tolerance:g} of each output's largest value{reason}"
    return "none, as --tolerance says" if result.functions else "none, because the model has only + - * /"


def _change(text: str) -> tuple[str, str]:
    name, sign, value = text.rpartition("=")
    try:
        if not sign or not name or not math.isfinite(float(value)):
            raise ValueError
    except ValueError as error:
        raise argparse.ArgumentTypeError("must be NAME=VALUE with a number") from error
    return name, repr(float(value))


def _part(text: str) -> float:
    try:
        part = float(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError("must be a number") from error
    if not 0.0 <= part <= 1.0:
        raise argparse.ArgumentTypeError("must be from 0 to 1")
    return part
