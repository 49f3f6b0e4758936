# SPDX-License-Identifier: Apache-2.0
"""Writes generated files: only what changed, each at once and whole, and nothing outside the output folder."""

from __future__ import annotations

import errno
import os
from collections.abc import Mapping
from pathlib import Path

from epg.emit.leftovers import lock, remove_leftovers, temporary_beside


def write_outputs(folder: Path, files: Mapping[str, str]) -> list[str]:
    """Makes ``folder`` hold ``files`` (name -> text); returns the names that were written.

    A file whose text is the same is not touched, so nothing that depends on it is rebuilt.  Files are complete before
    they get their name: an interrupted run leaves old files or new ones, never halves.
    """
    written = []
    for name, text in sorted(files.items()):
        path = folder / name
        if os.path.normpath(name).startswith(("..", "/")):
            raise ValueError(f"{name!r} is outside the output folder")
        if folder.resolve() not in path.resolve().parents:
            raise PermissionError(errno.EPERM, "a link leads out of the output folder: remove it", str(path))
        data = text.encode("utf-8")
        try:
            if path.read_bytes() == data:
                continue
        except OSError:
            pass
        path.parent.mkdir(parents=True, exist_ok=True)
        remove_leftovers(path)
        temporary = temporary_beside(path)
        try:
            with temporary.open("xb") as file:
                lock(file.fileno())
                file.write(data)
            os.chmod(temporary, 0o644)
            os.replace(temporary, path)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise
        written.append(name)
    return written


def remove_stale(folder: Path, keep: Mapping[str, str], owned: list[str]) -> list[str]:
    """Deletes those of ``owned`` (outputs of the run before) that are not in ``keep``; returns their names."""
    removed = []
    for name in owned:
        path = folder / name
        if name in keep or "\0" in name:
            continue
        if folder.resolve() in path.resolve().parents and path.is_file():
            path.unlink()
            removed.append(name)
    return removed
