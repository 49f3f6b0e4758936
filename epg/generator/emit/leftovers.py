# SPDX-License-Identifier: Apache-2.0
"""Temporary files and folders, each beside the path that it is going to become.

A run that is killed leaves its temporary files behind; the next run removes them.  A run locks its temporary files, so
that no other run removes them while they are in use.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from epg.generator.system import here


def temporary_beside(path: Path) -> Path:
    """A unique path in the same folder, for contents that are renamed to ``path`` when they are complete."""
    return path.with_name(f".{path.name}.{os.urandom(6).hex()}")


def replace_file(path: Path, data: bytes, mode: int | None = None, *, durable: bool = False) -> None:
    """Replaces or creates a file, at once: another program sees the old or the new contents, never a part of them.

    ``mode`` are its permissions; with None they are those of any new file.  ``durable`` holds even if the computer
    loses its power.  Raises OSError; the file is then unchanged.
    """
    temporary = temporary_beside(path)
    try:
        with temporary.open("xb") as file:
            here.lock(file.fileno())
            file.write(data)
            if durable:
                file.flush()
                os.fsync(file.fileno())
        if mode is not None:
            os.chmod(temporary, mode)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)  # it exists only after an error


@contextmanager
def held_folder(path: Path) -> Iterator[None]:
    """Creates the folder ``path`` and locks it, so that no other run removes it as the rest of a killed run."""
    path.mkdir()
    with here.held(path):
        yield


def remove_leftovers(path: Path) -> None:
    """Removes the temporary files and folders of ``path`` that killed runs left.  Keeps those that are in use."""
    beginning = f".{path.name}."
    with suppress(OSError, ValueError):
        for entry in os.scandir(path.parent):
            unique = entry.name.removeprefix(beginning) if entry.name.startswith(beginning) else ""
            if re.fullmatch("[0-9a-f]{12}", unique) and not entry.is_symlink():
                _remove_unless_held(entry)


def _remove_unless_held(entry: os.DirEntry[str]) -> None:
    """Removes a temporary file or folder, unless a running process has locked it."""
    with suppress(OSError):  # it is in use: Windows refuses to remove it, other systems refuse the lock
        with here.held(Path(entry.path)):
            pass
        if entry.is_dir(follow_symlinks=False):
            shutil.rmtree(entry.path, ignore_errors=True)
        elif entry.is_file(follow_symlinks=False):
            os.unlink(entry.path)
