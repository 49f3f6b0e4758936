"""Brings an output folder up to date and remembers what EPG put there."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TextIO

from epg.cli.report import to_json
from epg.emit.writer import remove_stale, write_outputs

MANIFEST = ".epg-outputs.json"


def update_folder(folder: Path, files: Mapping[str, str], report: TextIO | None) -> None:
    """Writes what changed, deletes what an earlier run wrote and this one did not; the list of files comes last."""
    try:
        owned = [str(name) for name in json.loads((folder / MANIFEST).read_text(encoding="utf-8"))]
    except (OSError, ValueError, TypeError):
        owned = []
    written = write_outputs(folder, files)
    removed = remove_stale(folder, files, owned)
    write_outputs(folder, {MANIFEST: json.dumps(sorted(files), indent=0) + "\n"})
    if report is not None:
        report.write(to_json({"files": sorted(files), "written": written, "removed": removed}))
