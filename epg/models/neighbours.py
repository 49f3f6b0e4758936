# SPDX-License-Identifier: Apache-2.0
"""The folders beside a model's folder, where people put files that several models share.

::

    controllers/
        common/  xxtypes.h  xxfuncs.c      <- found for both
        pan/     xxsubmod.c ...
        tilt/    xxsubmod.c ...

Only one level is searched, and nothing in a home directory, in a folder that everybody may write, or in one with very
many entries.  Files of another model's folder never count: its ``xxmodel.c`` would link, with arrays of other sizes.
"""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterable, Sequence
from functools import cached_property
from pathlib import Path

from epg.diagnostics import Diagnostics, Note
from epg.documents.source_file import SourceFile, decode
from epg.documents.text_file import is_file
from epg.models.folders import may_hold_sources
from epg.source import Span

MAX_ENTRIES = 1000  # of a folder that is searched
MAX_FOLDERS = 100  # beside a model's
MAX_SOURCES = 200  # of a folder
MAX_BYTES = 1 << 20  # of a source in it
SOURCE_FOLDERS = ("src", "source", "sources")
"""Names of folders that hold a model's sources only: its folder is the one above."""

_SHARED = "common"  # what 20-sim calls the folder of a C++ export that does not depend on the model
_SOURCES = (".c", ".cpp", ".cc", ".cxx")
_ENTRY_POINT = re.compile(
    r"CalculateSubmodel\w{0,80}\s{0,80}\([^();{]{0,500}\)\s{0,80}\{|::\s{0,80}CopyInputsToVariables\s{0,80}\("
)
_BLANK = re.compile(r"\s+")
_NOT_IN_LISTS = re.compile(r"[\[\]$;\"\\|]")  # of CMake


class Neighbours:
    """Folders beside ``directory``; nothing is read before somebody asks.

    ``cpp`` models of 20-sim share a ``common/`` that does not depend on the model: that of another one will do.
    """

    def __init__(self, directory: Path, cpp: bool) -> None:
        self.directory = directory
        self._cpp = cpp
        home = [above(directory)] if directory.name.lower() in SOURCE_FOLDERS else []
        self._homes = [directory, *home]
        self.looked = False

    @cached_property
    def _found(self) -> tuple[tuple[Path, ...], tuple[Path, ...], str]:
        """The folders that are searched, the folders of other models, and why there are none."""
        self.looked = True
        searched: dict[Path, None] = {}
        models: dict[Path, None] = {}
        own = {os.path.realpath(home) for home in self._homes}
        reason = ""
        for home in self._homes:
            parent = above(home)
            entries, reason = _siblings(parent)
            if not reason:
                for folder in (parent, *entries):
                    if os.path.realpath(folder) in own:
                        continue
                    is_model = holds_model(folder)
                    (models if is_model else searched)[folder] = None
                    if is_model and self._cpp and may_hold_sources(folder / _SHARED):
                        searched[folder / _SHARED] = None
        return tuple(searched), tuple(models), "" if searched else reason

    @property
    def folders(self) -> tuple[Path, ...]:
        return self._found[0]

    @property
    def models(self) -> tuple[Path, ...]:
        """Folders of other models, of which nothing is used."""
        return self._found[1]

    @property
    def watched(self) -> tuple[Path, ...]:
        """Folders of which the list of files matters; none if nobody asked."""
        if not self.looked:
            return ()
        return tuple(dict.fromkeys([*map(above, self._homes), *self.folders, *self.models]))

    def files(self, name: str) -> list[Path]:
        """The files that ``#include "name"`` may mean."""
        found: dict[str, Path] = {}
        for folder in self.folders:
            path = folder / name
            if is_file(path):
                found.setdefault(os.path.realpath(path), path)
        return list(found.values())

    def sources(self, folder: Path, suffixes: Iterable[str], names: Iterable[str]) -> list[SourceFile]:
        """The sources in ``folder`` in whose text one of ``names`` stands."""
        wanted = tuple(suffixes)
        word = re.compile(rf"\b(?:{'|'.join(re.escape(name) for name in sorted(names))})\b")
        paths = [path for path in entries_of(folder) or () if path.suffix.lower() in wanted]
        files = (_read(path) for path in paths[:MAX_SOURCES])
        return [file for file in files if file is not None and word.search(file.text)]

    def elsewhere(self, name: str) -> list[Path]:
        """Where else a file of that name lies, for the message that it was not found: two levels, and no further."""
        base = name.replace("\\", "/").rsplit("/", 1)[-1]
        found: dict[str, Path] = {}
        for folder in (*self._homes, *self.models, *self.folders):
            below = [entry for entry in entries_of(folder) or () if may_hold_sources(entry)]
            for place in (folder, *below[:MAX_FOLDERS]):
                if is_file(place / base):
                    found.setdefault(os.path.realpath(place / base), place / base)
        return list(found.values())[:6]

    def notes(self, name: str) -> list[Note]:
        """For the same message: each of those files."""
        other = {os.path.realpath(folder) for folder in self.models}
        return [
            Note(
                "a file of that name" + (", of another model" if os.path.realpath(path.parent) in other else ""),
                Span(str(path)),
            )
            for path in self.elsewhere(name)
        ]

    def description(self) -> str:
        """Where was looked, for people: ``'pan' and below it, and beside it in 'common'``."""
        names = [os.path.relpath(folder, above(self.directory)) for folder in self.folders]
        names = [f"'{Path(name).as_posix()}'" for name in names if name not in (".", "..")]
        text = f"looked in '{os.path.basename(os.path.abspath(self.directory))}' and below it"
        if self._found[2]:
            return f"{text}, but not beside it: {self._found[2]}"
        return text + (
            f", and beside it in {', '.join([*names[:6], *(['...'] if len(names) > 6 else [])])}" if names else ""
        )


def report_taken(paths: Iterable[Path], main: Path, near: Neighbours, diagnostics: Diagnostics) -> None:
    """Says which files of the model lie beside its folder: once for each folder."""
    folders: dict[Path, list[str]] = {}
    for path in dict.fromkeys(paths):
        folders.setdefault(path.parent, []).append(path.name)
    for folder, names in sorted(folders.items()):
        names.sort()
        place = Path(os.path.relpath(folder, near.directory)).as_posix()
        shown = ", ".join(names[:12]) + (f" and {len(names) - 12} more" if len(names) > 12 else "")
        message = f"taken from '{place}', as the model's folder lacks them: {shown}"
        hint = "a file of the same name in the model's folder counts first"
        diagnostics.note("model-neighbour", Span(str(main)), message, hint=hint)


def above(folder: Path) -> Path:
    """The folder that holds ``folder``, by its name: what a link leads to lies somewhere else."""
    return folder.parent if folder.name not in ("", "..") else folder / os.pardir


def entries_of(folder: Path) -> list[Path] | None:
    """What lies in a folder, sorted; None if that cannot be read or is very much."""
    found: list[str] = []
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if len(found) >= MAX_ENTRIES:
                    return None
                found.append(entry.name)
    except (OSError, ValueError):
        return None
    return [folder / name for name in sorted(found)]


def holds_model(folder: Path) -> bool:
    """Whether a folder is that of a model by itself: it holds entry points, an FMU, a model.yaml, or tokens alone."""
    entries = entries_of(folder) or []
    names = {entry.name.lower() for entry in entries}
    if not names.isdisjoint(("model.yaml", "modeldescription.xml")):
        return True
    sources = [entry for entry in entries if entry.suffix.lower() in _SOURCES]
    if not sources and not any(name.endswith(".h") for name in names):
        return any(name.endswith("tokens.xml") for name in names)
    files = (_read(path) for path in sources[:MAX_SOURCES])
    return any(file is not None and _ENTRY_POINT.search(file.text) for file in files)


def all_alike(paths: Sequence[Path]) -> bool:
    """Whether files say the same: comments, blanks and line ends do not count."""
    files = [_read(path) for path in paths]
    return all(files) and len({_BLANK.sub(" ", file.without_comments).strip() for file in files if file}) == 1


def _read(path: Path) -> SourceFile | None:
    try:
        if not path.is_file() or path.stat().st_size > MAX_BYTES:
            return None
        data = path.read_bytes()
    except OSError:
        return None
    return (
        None
        if b"\0" in data[:1024] and not data.startswith((b"\xff\xfe", b"\xfe\xff"))
        else SourceFile(path, decode(data))
    )


def _siblings(parent: Path) -> tuple[list[Path], str]:
    """The folders in ``parent`` that may hold sources, or why they are not searched."""
    try:
        whole = Path(os.path.realpath(parent))
        mode = whole.stat().st_mode
        home = Path(os.path.realpath(Path.home()))
    except (OSError, RuntimeError, ValueError):
        return [], "the folder above cannot be read"
    if whole == home or whole in home.parents:
        return [], "the folder above is a home directory or a system's"
    if os.name == "posix" and mode & stat.S_IWOTH:
        return [], "everybody may write to the folder above"
    entries = entries_of(parent)
    if entries is None:
        return [], f"the folder above holds more than {MAX_ENTRIES} entries"
    folders = [entry for entry in entries if _is_nameable(entry.name) and may_hold_sources(entry)]
    return (folders, "") if len(folders) <= MAX_FOLDERS else ([], f"there are more than {MAX_FOLDERS} folders")


def _is_nameable(name: str) -> bool:
    """Whether CMake can have a folder of that name in a list."""
    return name.isprintable() and not _NOT_IN_LISTS.search(name)
