# SPDX-License-Identifier: Apache-2.0
"""Updates an output folder, and keeps a list of the files that EPG wrote into it."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from pathlib import Path
from typing import TextIO

from epg.cli.report import format_diagnostics, to_json
from epg.generator.diagnostics import Diagnostics
from epg.generator.emit.writer import remove_stale, write_outputs

MANIFEST = ".epg-outputs.json"


def add_output_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments of commands that write into a build folder.  CMake gives the hidden ones."""
    parser.add_argument("--output", required=True, type=Path, metavar="FOLDER", help="folder to write")
    parser.add_argument("--source-dir", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--warnings", type=Path, help=argparse.SUPPRESS)


def write_warnings(file: Path | None, diagnostics: Diagnostics) -> None:
    """Writes the warnings into ``file``, or deletes it if there are none.

    CMake prints them again in later runs that do not need to run EPG.
    """
    if file is not None and diagnostics.items:
        write_outputs(file.parent, {file.name: format_diagnostics(diagnostics)})
    elif file is not None:
        file.unlink(missing_ok=True)


def update_folder(folder: Path, files: Mapping[str, str], report: TextIO | None) -> None:
    """Writes the files that changed, and deletes files that an earlier run wrote but this one did not.

    The list of files is written last.  ``report`` gets a summary as JSON.
    """
    try:
        owned = [str(name) for name in json.loads((folder / MANIFEST).read_text(encoding="utf-8"))]
    except (OSError, ValueError, TypeError, RecursionError):
        owned = []
    written = write_outputs(folder, files)
    removed = remove_stale(folder, files, owned)
    write_outputs(folder, {MANIFEST: json.dumps(sorted(files), indent=0) + "\n"})
    if report is not None:
        report.write(to_json({"files": sorted(files), "written": written, "removed": removed}))
