# SPDX-License-Identifier: Apache-2.0
"""Shows the lines around the position of a message.  Files that no message names cannot be read this way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from epg.connect.body import Refused
from epg.connect.files import read_snapshot
from epg.generator.documents.text_file import Drafts

AROUND = 10
"""The number of lines that are shown before and after the line of the message."""


def excerpt(state: Mapping[str, Any], folder: Path, drafts: Drafts, file: str, line: int) -> dict[str, Any]:
    """21 lines of ``file`` around ``line``, from its draft if it has one.

    Compilers print names that are not absolute: these are relative to ``folder``.  Raises Refused for a file that
    nothing in ``state`` names.
    """
    if file not in set(_named(state)):
        raise Refused("no message is about this file", status=404)
    path = Path(file) if Path(file).is_absolute() else folder / file
    data = read_snapshot(path).data
    if path in drafts:
        text = drafts[path]
    elif data is not None:
        text = data.decode("utf-8-sig", "replace")
    else:
        raise Refused(f"'{path.name}' cannot be read", status=404)
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    if lines[-1] == "" and len(lines) > 1:
        lines.pop()
    line = min(max(line, 1), len(lines))
    first = max(1, line - AROUND)
    return {"file": file, "first": first, "lines": lines[first - 1 : line + AROUND], "line": line}


def _named(state: Mapping[str, Any]) -> Iterator[str]:
    for message in (*state["diagnostics"], *state["build"]["messages"]):
        yield message["file"]
        yield from (note["file"] for note in message.get("notes", ()))
    project = state["project"]
    for name in project["files"].values() if project is not None else ():
        yield name
        yield str(Path(project["folder"]) / name)
