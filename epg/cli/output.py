# SPDX-License-Identifier: Apache-2.0
"""Brings an output folder up to date and remembers what EPG put there."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from pathlib import Path
from typing import TextIO

from epg.cli.report import format_diagnostics, to_json
from epg.diagnostics import Diagnostics
from epg.emit.writer import remove_stale, write_outputs

MANIFEST = ".epg-outputs.json"


def add_output_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--output", required=True, type=Path, metavar="FOLDER", help="where the files go")
    parser.add_argument("--source-dir", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--warnings", type=Path, help=argparse.SUPPRESS)


def write_warnings(file: Path | None, diagnostics: Diagnostics) -> None:
    """Leaves the text of the warnings, for CMake to say again when it need not run EPG; no file if there are none."""
    if file is not None and diagnostics.items:
        write_outputs(file.parent, {file.name: format_diagnostics(diagnostics)})
    elif file is not None:
        file.unlink(missing_ok=True)


def update_folder(folder: Path, files: Mapping[str, str], report: TextIO | None) -> None:
    """Writes what changed, deletes what an earlier run wrote and this one did not; the list of files comes last."""
    try:
        owned = [str(name) for name in json.loads((folder / MANIFEST).read_text(encoding="utf-8"))]
    except (OSError, ValueError, TypeError, RecursionError):
        owned = []
    written = write_outputs(folder, files)
    removed = remove_stale(folder, files, owned)
    write_outputs(folder, {MANIFEST: json.dumps(sorted(files), indent=0) + "\n"})
    if report is not None:
        report.write(to_json({"files": sorted(files), "written": written, "removed": removed}))
