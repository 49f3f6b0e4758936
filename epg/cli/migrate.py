# SPDX-License-Identifier: Apache-2.0
"""``epg migrate``: rewrites files of an older format in the newest one."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
from pathlib import Path

from epg.cli.report import to_json
from epg.diagnostics import Diagnostics

BOM = b"\xef\xbb\xbf"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help=".tcf, bindings, scenario or other file")
    parser.add_argument(
        "--check", action="store_true", help="write nothing; exit with 1 if a file is of an older format"
    )


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.load.migrate import migrate
    from epg.load.text_file import read_text

    entries = []
    for path in options.files:
        text = read_text(path, diagnostics)
        migrated = migrate(text, path, diagnostics) if text is not None else None
        if migrated is None:
            continue
        if migrated.text != text and not options.check:
            _replace(path, migrated.text)
        newest = migrated.format.newest
        entry = {"file": str(path), "format": migrated.format.name, "from": migrated.first, "to": newest}
        entries.append(entry)
        if not options.json:
            done = "would become" if options.check else "is now"
            changed = migrated.first != newest
            print(f"{path}: version {migrated.first}" + (f" {done} {newest}" if changed else ", the newest"))
    if options.json and not diagnostics.has_errors:
        sys.stdout.write(to_json({"files": entries}))
    return 1 if options.check and any(entry["from"] != entry["to"] for entry in entries) else 0


def _replace(path: Path, text: str) -> None:
    """Writes ``path`` at once and whole, through symbolic links, with its permissions and byte order mark."""
    path = path.resolve()
    mark = BOM if path.read_bytes().startswith(BOM) else b""
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(mark + text.encode("utf-8"))
        shutil.copymode(path, temporary)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise
