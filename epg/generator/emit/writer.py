# SPDX-License-Identifier: Apache-2.0
"""Writes generated files: only those that changed, each atomically, and never outside the output folder.

A file whose text is the same keeps its time, so that the build compiles nothing again.  Contents are compared and not
times, because EPG runs again after every change of a file that it has read.  A name or a link that leads out of the
folder is an error and is not followed: wrong input must never overwrite another file.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Mapping
from pathlib import Path

from epg.generator.emit.leftovers import remove_leftovers, replace_file


def write_outputs(folder: Path, files: Mapping[str, str]) -> list[str]:
    """Writes ``files`` (name -> text) into ``folder``.  Returns the names of the files that were written.

    A file whose text did not change is not touched, so that nothing that depends on it is built again.  Each file is
    complete before it gets its name: an interrupted run leaves old or new files, but never a part of one.

    Raises PermissionError if a symbolic link leads out of ``folder``, and OSError for other failures.
    """
    written = []
    inside = folder.resolve()
    for name, text in sorted(files.items()):
        path = folder / name
        if os.path.normpath(name).startswith("..") or Path(name).anchor:
            raise ValueError(f"{name!r} is outside the output folder")
        if inside not in path.resolve().parents:
            raise PermissionError(errno.EPERM, "a link leads out of the output folder: remove it", str(path))
        data = text.encode("utf-8")
        try:
            if path.read_bytes() == data:
                continue
        except OSError:
            pass
        path.parent.mkdir(parents=True, exist_ok=True)
        remove_leftovers(path)
        replace_file(path, data, 0o644)
        written.append(name)
    return written


def remove_stale(folder: Path, keep: Mapping[str, str], owned: list[str]) -> list[str]:
    """Deletes the files in ``owned``, the outputs of the previous run, that are not in ``keep``.

    Returns the names of the deleted files.  Files outside ``folder`` are never deleted.
    """
    removed = []
    for name in owned:
        path = folder / name
        if name in keep or "\0" in name:
            continue
        if folder.resolve() in path.resolve().parents and path.is_file():
            path.unlink()
            removed.append(name)
    return removed
