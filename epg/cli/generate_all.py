# SPDX-License-Identifier: Apache-2.0
"""``epg generate-all``: the runs of several targets or models in one process.  CMake calls it while it configures.

CMake needs the first run now.  The others are those of the last configure run of which a file has changed; CMake will
probably need them, but their targets may also have been removed.  A run that fails therefore prints nothing, and CMake
repeats it when it needs it.  The file of the runs has an empty line between two runs.  The first line of a run names a
file that EPG writes if the run was successful.  The other lines begin with a tab; each is an argument.
"""

from __future__ import annotations

import argparse
import io
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from epg.generator.diagnostics import Diagnostics


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", type=Path, help="the runs")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.cli.main import main

    (_, first), *others = _runs(options.file)
    status = main(first)
    for done, words in others:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            if main(words) == 0:
                done.touch()
    return status


def _runs(file: Path) -> Iterator[tuple[Path, list[str]]]:
    """The runs in ``file``: the file that tells their success, and the arguments of EPG."""
    for text in file.read_text(encoding="utf-8").split("\n\n"):
        done, *words = text.strip("\n").split("\n")
        yield Path(done), [word.removeprefix("\t") for word in words]
