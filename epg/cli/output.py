"""Brings an output folder up to date and remembers what EPG put there."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TextIO

from epg.cli.report import format_diagnostics, to_json
from epg.diagnostics import Diagnostics
from epg.emit.writer import remove_stale, write_outputs

MANIFEST = ".epg-outputs.json"
WARNINGS = ".epg-warnings.txt"


def update_folder(folder: Path, files: Mapping[str, str], warnings: Diagnostics, report: TextIO | None) -> None:
    """Writes what changed, deletes what an earlier run wrote and this one did not; the list of files comes last.

    The text of the warnings stays beside the files, for CMake to say again when it need not run EPG.
    """
    try:
        owned = [str(name) for name in json.loads((folder / MANIFEST).read_text(encoding="utf-8"))]
    except (OSError, ValueError, TypeError):
        owned = []
    written = write_outputs(folder, files)
    removed = remove_stale(folder, files, owned)
    if warnings.items:
        write_outputs(folder, {WARNINGS: format_diagnostics(warnings)})
    else:
        (folder / WARNINGS).unlink(missing_ok=True)
    write_outputs(folder, {MANIFEST: json.dumps(sorted(files), indent=0) + "\n"})
    if report is not None:
        report.write(to_json({"files": sorted(files), "written": written, "removed": removed}))
