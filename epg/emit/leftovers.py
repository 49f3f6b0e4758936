# SPDX-License-Identifier: Apache-2.0
"""Temporary files and folders beside what is being written: the next run removes those of a run that was killed."""

from __future__ import annotations

import os
import re
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


def temporary_beside(path: Path) -> Path:
    """A name of its own, in the same folder, for what will be ``path`` when it is complete."""
    return path.with_name(f".{path.name}.{secrets.token_hex(6)}")


def lock(file: int) -> None:
    """Holds a file until it is closed or the process ends; raises OSError where somebody else holds it."""
    if os.name != "nt":
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


@contextmanager
def held_folder(path: Path) -> Iterator[None]:
    """Makes the folder ``path`` and holds it: no other run takes it for what a killed one has left."""
    path.mkdir()
    if os.name == "nt":
        yield
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        lock(handle)
        yield
    finally:
        os.close(handle)


def remove_leftovers(path: Path) -> None:
    """Removes what killed runs have left beside ``path`` on their way to it; never what is being written."""
    pattern = re.compile(rf"\.{re.escape(path.name)}\.[0-9a-f]{{12}}")
    with suppress(OSError, ValueError):
        for entry in os.scandir(path.parent):
            if pattern.fullmatch(entry.name) and not entry.is_symlink():
                _remove_unless_held(entry)


def _remove_unless_held(entry: os.DirEntry[str]) -> None:
    with suppress(OSError):  # Windows refuses to remove a file that is open, the lock says it elsewhere
        if os.name != "nt":
            handle = os.open(entry.path, os.O_RDONLY)
            try:
                lock(handle)
            finally:
                os.close(handle)
        if entry.is_dir(follow_symlinks=False):
            shutil.rmtree(entry.path, ignore_errors=True)
        elif entry.is_file(follow_symlinks=False):
            os.unlink(entry.path)
