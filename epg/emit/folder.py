# SPDX-License-Identifier: Apache-2.0
"""Writes a whole folder at once: all of its files, or none of them."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path

from epg.emit.leftovers import held_folder, remove_leftovers, temporary_beside


def present_files(folder: Path, names: Iterable[str]) -> list[Path]:
    """Those of the files ``names`` below ``folder`` that could not be written without replacing something."""
    found = []
    for name in names:
        path = folder / name
        above = [parent for parent in path.parents if parent != folder and folder in parent.parents]
        found += [place for place in (folder, *above) if os.path.lexists(place) and not place.is_dir()]
        found += [path] if os.path.lexists(path) else []
    return sorted(set(found))


def write_folder(folder: Path, files: Mapping[str, bytes]) -> None:
    """Makes ``folder`` hold ``files`` (relative name -> contents) besides what it holds already.

    Everything is written under a temporary name first.  A folder that is new then gets its name at once; in one that
    is there, files are moved to their places, and taken away again if one of them cannot be.  Replaces
    nothing: raises FileExistsError.  Raises OSError, with ``folder`` as it was.
    """
    folder = folder.absolute()
    is_new = not folder.is_dir()  # one that is there stays, empty or not: somebody may work in it
    around = folder.parent if is_new else folder
    made = _make_folders(around)
    remove_leftovers(around / folder.name)
    staging = temporary_beside(around / folder.name)
    try:
        with held_folder(staging):
            for name, data in files.items():
                path = staging / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)
            if is_new:
                os.rename(staging, folder)
            else:
                _move(staging, folder, list(files))
    except BaseException:
        shutil.rmtree(staging, ignore_errors=True)
        _remove_folders(made)
        raise
    shutil.rmtree(staging, ignore_errors=True)


def _move(staging: Path, folder: Path, names: list[str]) -> None:
    moved: list[Path] = []
    made: list[Path] = []
    try:
        for name in names:
            path = folder / name
            made += _make_folders(path.parent)
            if os.path.lexists(path):
                raise FileExistsError(17, "this file exists", str(path))
            os.rename(staging / name, path)
            moved.append(path)
    except BaseException:
        for path in moved:
            path.unlink()
        _remove_folders(made)
        raise


def _make_folders(path: Path) -> list[Path]:
    """Makes a folder and those above it; returns the new ones, outermost first."""
    missing = [place for place in (*reversed(path.parents), path) if not place.exists()]
    path.mkdir(parents=True, exist_ok=True)
    return missing


def _remove_folders(folders: list[Path]) -> None:
    for folder in reversed(folders):
        try:
            folder.rmdir()
        except OSError:
            return
