# SPDX-License-Identifier: Apache-2.0
"""Writes all files of a folder, or none of them if one cannot be written."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path

from epg.generator.emit.leftovers import held_folder, remove_leftovers, temporary_beside


def present_files(folder: Path, names: Iterable[str]) -> list[Path]:
    """The existing paths that prevent :func:`write_folder` from writing the files ``names`` into ``folder``.

    A path prevents it if it is one of the files, or if it is a file where a folder is needed.
    """
    paths = []
    for name in names:
        path = folder / name
        above = [parent for parent in path.parents if parent != folder and folder in parent.parents]
        paths += [place for place in (folder, *above) if os.path.lexists(place) and not place.is_dir()]
        paths += [path] if os.path.lexists(path) else []
    return sorted(set(paths), key=Path.as_posix)  # Windows' own order has no capitals


def write_folder(folder: Path, files: Mapping[str, bytes]) -> None:
    """Writes ``files`` (relative name -> contents) into ``folder``.  Files that it already holds stay.

    All files are first written into a temporary folder.  If ``folder`` is new, the temporary folder is renamed.  If it
    exists, each file is moved to its place; if one cannot be moved, those that were moved are removed again.

    Never replaces a file: raises FileExistsError instead.  Raises OSError for other failures.  After an error,
    ``folder`` is as it was before.
    """
    folder = folder.absolute()
    is_new = not folder.is_dir()  # an existing folder is never replaced, even if empty: another program may be using it
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
    """Moves the files ``names`` into ``folder``, or none of them if one cannot be moved."""
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
    """Creates a folder and its parents.  Returns the folders that are new, the outermost first."""
    missing = [place for place in (*reversed(path.parents), path) if not place.exists()]
    path.mkdir(parents=True, exist_ok=True)
    return missing


def _remove_folders(folders: list[Path]) -> None:
    for folder in reversed(folders):
        try:
            folder.rmdir()
        except OSError:
            return
