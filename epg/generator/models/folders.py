# SPDX-License-Identifier: Apache-2.0
"""The folders in which EPG searches the files of a model."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

#: the file in every FMU, which 20-sim also writes beside its sources
FMU_DESCRIPTION = "modelDescription.xml"
#: levels of folders below a model's folder that are searched
DEPTH = 2
_SKIPPED = frozenset(("project", "build", "cmakefiles", "binaries"))
_BUILD_MARKS = ("CMakeCache.txt", ".epg-outputs.json")


def entries(folder: Path) -> list[Path]:
    """The entries of ``folder``, sorted; empty if it cannot be read."""
    try:
        return sorted(folder.iterdir())
    except OSError:
        return []


def searched_folders(directory: Path, depth: int = DEPTH) -> list[Path]:
    """``directory`` and the folders up to ``depth`` levels below it that can hold sources of a model.

    Links, hidden folders, folders of IDEs and build folders are not searched.
    """
    folders = [directory]
    for entry in entries(directory) if depth else ():
        if may_hold_sources(entry):
            folders.extend(searched_folders(entry, depth - 1))
    return folders


def source_files(directory: Path, suffixes: Iterable[str], depth: int = DEPTH) -> list[Path]:
    """The files with one of ``suffixes`` in the :func:`searched_folders`."""
    wanted = {suffix.lower() for suffix in suffixes}
    files: list[Path] = []
    for folder in searched_folders(directory, depth):
        files.extend(entry for entry in entries(folder) if entry.suffix.lower() in wanted and entry.is_file())
    return files


def may_hold_sources(entry: Path) -> bool:
    """True if ``entry`` is a folder that is searched: not a link, not hidden, and not a folder of an IDE or a build."""
    if entry.name.startswith(".") or entry.name.lower() in _SKIPPED or entry.is_symlink() or not entry.is_dir():
        return False
    return not any((entry / mark).exists() for mark in _BUILD_MARKS)
