# SPDX-License-Identifier: Apache-2.0
"""Searches the folders beside a model's folder, where users put files that several models share.

::

    controllers/
        common/  xxtypes.h  xxfuncs.c      <- found for both
        pan/     xxsubmod.c ...
        tilt/    xxsubmod.c ...

Only one level is searched.  EPG does not search a home directory, a folder to which all users can write, or a folder
with very many entries.  It never uses files in the folder of another model: the ``xxmodel.c`` of that model would link,
but its arrays have other sizes.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from functools import cached_property
from pathlib import Path

from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.source_file import SourceFile, decode
from epg.generator.documents.text_file import is_file
from epg.generator.models.folders import may_hold_sources
from epg.generator.source import Span
from epg.generator.system import here

MAX_ENTRIES = 1000  # entries of a folder that is searched
MAX_FOLDERS = 100  # folders beside a model's
MAX_SOURCES = 200  # sources in a folder
MAX_BYTES = 1 << 20  # bytes of a source
SOURCE_FOLDERS = ("src", "source", "sources")
"""Names of folders that hold only the sources of a model.  The model's folder is then the one above."""

_SHARED = "common"  # the folder of a C++ export with files that do not depend on the model
_SOURCES = (".c", ".cpp", ".cc", ".cxx")
_ENTRY_POINT = (
    r"CalculateSubmodel\w{0,80}\s{0,80}\([^();{]{0,500}\)\s{0,80}\{|::\s{0,80}CopyInputsToVariables\s{0,80}\("
)
_BLANK = re.compile(r"\s+")
_NOT_IN_LISTS = r"[\[\]$;\"\\|]"  # characters that a list of CMake cannot hold


class Neighbours:
    """The folders beside ``directory``.  They are read when they are first needed.

    In C++ exports (``cpp``), the files in ``common/`` do not depend on the model.  The ``common/`` in the folder of
    another model can therefore be used.
    """

    def __init__(self, directory: Path, cpp: bool) -> None:
        self.directory = directory
        self._cpp = cpp
        home = [above(directory)] if directory.name.lower() in SOURCE_FOLDERS else []
        self._homes = [directory, *home]
        self.looked = False
        self.read: set[Path] = set()  # files that were read to decide if they belong to the model

    @cached_property
    def _found(self) -> tuple[tuple[Path, ...], tuple[Path, ...], str]:
        """The folders that are searched, the folders of other models, and the reason if no folder is searched."""
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
                    is_model = self._holds_model(folder)
                    (models if is_model else searched)[folder] = None
                    if is_model and self._cpp and may_hold_sources(folder / _SHARED):
                        searched[folder / _SHARED] = None
        return tuple(searched), tuple(models), "" if searched else reason

    @property
    def folders(self) -> tuple[Path, ...]:
        return self._found[0]

    @property
    def models(self) -> tuple[Path, ...]:
        """The folders of other models.  Their files are not used."""
        return self._found[1]

    @property
    def watched(self) -> tuple[Path, ...]:
        """The folders in which a new or removed file can change the model.  Empty if no folder was searched."""
        if not self.looked:
            return ()
        return tuple(dict.fromkeys([*map(above, self._homes), *self.folders, *self.models]))

    def files(self, name: str) -> list[Path]:
        """The files that ``#include "name"`` can mean."""
        found: dict[str, Path] = {}
        for folder in self.folders:
            path = folder / name
            if is_file(path):
                found.setdefault(os.path.realpath(path), path)
        return list(found.values())

    def sources(self, folder: Path, suffixes: Iterable[str], names: Iterable[str]) -> list[SourceFile]:
        """The sources in ``folder`` whose text contains one of ``names``."""
        wanted = tuple(suffixes)
        word = re.compile(rf"\b(?:{'|'.join(re.escape(name) for name in sorted(names))})\b")
        paths = [path for path in entries_of(folder) or () if path.suffix.lower() in wanted]
        files = (self._read(path) for path in paths[:MAX_SOURCES])
        return [file for file in files if file is not None and word.search(file.text)]

    def are_alike(self, paths: Sequence[Path]) -> bool:
        """True if all files have the same text, apart from comments, blanks and line ends."""
        files = [self._read(path) for path in paths]
        return all(files) and len({_BLANK.sub(" ", file.without_comments).strip() for file in files if file}) == 1

    def _holds_model(self, folder: Path) -> bool:
        """True if ``folder`` is the folder of a model.

        It then holds an unpacked FMU, a model.yaml, sources with entry points, or tokens without sources.
        """
        entries = entries_of(folder) or []
        names = {entry.name.lower() for entry in entries}
        if not names.isdisjoint(("model.yaml", "modeldescription.xml")):
            return True
        sources = [entry for entry in entries if entry.suffix.lower() in _SOURCES]
        if not sources and not any(name.endswith(".h") for name in names):
            return any(name.endswith("tokens.xml") for name in names)
        files = (self._read(path) for path in sources[:MAX_SOURCES])
        return any(file is not None and re.search(_ENTRY_POINT, file.text) for file in files)

    def _read(self, path: Path) -> SourceFile | None:
        """The text of a file; None if it cannot be read or is not text."""
        try:
            if not path.is_file() or path.stat().st_size > MAX_BYTES:
                return None
            data = path.read_bytes()
        except OSError:
            return None
        self.read.add(path)
        is_text = b"\0" not in data[:1024] or data.startswith((b"\xff\xfe", b"\xfe\xff"))
        return SourceFile(path, decode(data)) if is_text else None

    def elsewhere(self, name: str) -> list[Path]:
        """Other files with the same name, for the message that the file was not found.  Searches two levels."""
        base = name.replace("\\", "/").rsplit("/", 1)[-1]
        found: dict[str, Path] = {}
        for folder in (*self._homes, *self.models, *self.folders):
            below = [entry for entry in entries_of(folder) or () if may_hold_sources(entry)]
            for place in (folder, *below[:MAX_FOLDERS]):
                if is_file(place / base):
                    found.setdefault(os.path.realpath(place / base), place / base)
        return list(found.values())[:6]

    def notes(self, name: str) -> list[Note]:
        """A note for each file of :meth:`elsewhere`."""
        other = {os.path.realpath(folder) for folder in self.models}
        return [
            Note(
                "a file of this name" + (", of another model" if os.path.realpath(path.parent) in other else ""),
                Span(str(path)),
            )
            for path in self.elsewhere(name)
        ]

    def description(self) -> str:
        """The places that were searched, as text: ``EPG has searched 'pan' and its subfolders``."""
        names = [os.path.relpath(folder, above(self.directory)) for folder in self.folders]
        names = [f"'{Path(name).as_posix()}'" for name in names if name not in (".", "..")]
        text = f"EPG has searched '{os.path.basename(os.path.abspath(self.directory))}' and its subfolders"
        if self._found[2]:
            return f"{text}, but not the folders beside it: {self._found[2]}"
        return text + (
            f", and the folders beside it: {', '.join([*names[:6], *(['...'] if len(names) > 6 else [])])}"
            if names
            else ""
        )


def report_taken(paths: Iterable[Path], main: Path, near: Neighbours, diagnostics: Diagnostics) -> None:
    """Reports the files of the model that are beside its folder, with one note for each folder."""
    folders: dict[Path, list[str]] = {}
    for path in dict.fromkeys(paths):
        folders.setdefault(path.parent, []).append(path.name)
    for folder, names in sorted(folders.items()):
        names.sort()
        place = Path(os.path.relpath(folder, near.directory)).as_posix()
        shown = ", ".join(names[:12]) + (f" and {len(names) - 12} more" if len(names) > 12 else "")
        message = f"these files are from '{place}', because the model's folder does not have them: {shown}"
        hint = "EPG first uses a file of the same name in the model's folder"
        diagnostics.note("model-neighbour", Span(str(main)), message, hint=hint)


def above(folder: Path) -> Path:
    """The folder above ``folder``, by its name.  A link is not followed, because its target is elsewhere."""
    return folder.parent if folder.name not in ("", "..") else folder / os.pardir


def entries_of(folder: Path) -> list[Path] | None:
    """The entries of a folder, sorted.  None if it cannot be read or has more than :data:`MAX_ENTRIES`."""
    names: list[str] = []
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if len(names) >= MAX_ENTRIES:
                    return None
                names.append(entry.name)
    except (OSError, ValueError):
        return None
    return [folder / name for name in sorted(names)]


def _siblings(parent: Path) -> tuple[list[Path], str]:
    """The folders in ``parent`` that can hold sources, and the reason if they are not searched."""
    try:
        whole = Path(os.path.realpath(parent))
        mode = whole.stat().st_mode
        home = Path(os.path.realpath(Path.home()))
    except (OSError, RuntimeError, ValueError):
        return [], "the folder above cannot be read"
    if whole == home or whole in home.parents:
        return [], "the folder above is a home folder or a system folder"
    if here.all_may_write(mode):
        return [], "all users can write to the folder above"
    entries = entries_of(parent)
    if entries is None:
        return [], f"the folder above has more than {MAX_ENTRIES} entries"
    folders = [entry for entry in entries if _is_nameable(entry.name) and may_hold_sources(entry)]
    return (folders, "") if len(folders) <= MAX_FOLDERS else ([], f"there are more than {MAX_FOLDERS} folders")


def _is_nameable(name: str) -> bool:
    """True if a list of CMake can hold a folder of this name."""
    return name.isprintable() and not re.search(_NOT_IN_LISTS, name)
