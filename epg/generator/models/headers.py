# SPDX-License-Identifier: Apache-2.0
"""Finds the headers that the files of a model include, and reports headers that are missing."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.source_file import SourceFile, read_source
from epg.generator.documents.text_file import is_file
from epg.generator.models.c_code import CFile, Include, parse_code
from epg.generator.models.folders import entries
from epg.generator.models.neighbours import Neighbours
from epg.generator.source import Span

#: headers of an export that a model needs only if it calls their functions
_OPTIONAL = r"motionprofiles|eulerangles|\w*(table2d|matrix|inverse|funcs)\w*"


@dataclass(frozen=True)
class Shim:
    """A header that the export includes as ``name``, but whose file ``target`` has another name.

    The names can differ in case or in their folder.  ``target`` is None if the header does not exist.
    """

    name: str
    target: Path | None


class Headers:
    """Collects the headers that files include.

    ``search`` are the model's own folders.  The neighbours ``near`` are searched last.  ``good`` is False after an
    error.
    """

    def __init__(self, search: Sequence[Path], near: Neighbours, diagnostics: Diagnostics) -> None:
        self.search = search
        self.near = near
        self.diagnostics = diagnostics
        self.found: dict[Path, CFile] = {}
        self.shims: dict[str, Shim] = {}
        self.taken: list[Path] = []  # headers from folders beside the model's, which no include names with its folder
        self.good = True
        self._bases: dict[Path, None] = {}
        self._told: set[str] = set()

    def follow(self, unit: CFile) -> None:
        """Finds the headers that ``unit`` includes, directly or through other headers.  Reports missing ones."""
        waiting = [unit]
        while waiting:
            code = waiting.pop()
            for include in code.includes:
                path = None if include.system else self._find(include, code.file)
                if path is None or path in self.found:
                    continue
                place = code.file.span(include.start, include.start + len(include.name))
                file = read_source(path, self.diagnostics, place)
                if file is None:
                    self.good = False
                    continue
                self.found[path] = parse_code(file)
                waiting.append(self.found[path])

    def folders(self) -> list[Path]:
        """The folders of the include path, in the order in which they are searched."""
        used = dict.fromkeys([*self._bases, *(path.parent for path in self.found)])
        order = {folder: number for number, folder in enumerate(self.search)}
        return sorted(used, key=lambda folder: order.get(folder, len(order)))

    def named(self, directory: Path) -> list[Path]:
        """The folders outside ``directory`` with headers that were found, such as that of ``"../common/xxinteg.h"``."""
        folders = dict.fromkeys(path.parent for path in self.found)
        return [folder for folder in folders if not folder.is_relative_to(directory)]

    def _find(self, include: Include, file: SourceFile) -> Path | None:
        """The file that ``include`` means.  None if there is none, or if several fit; both are reported."""
        name = include.name
        if is_file(file.path.parent / name):
            return _plain(file.path.parent / name)
        for folder in self.search:
            if is_file(folder / name):
                self._bases[folder] = None
                return _plain(folder / name)
        other = _other_case(name, [file.path.parent, *self.search])
        return self._find_near(include, file) if other is None else self._shimmed(name, other)

    def _find_near(self, include: Include, file: SourceFile) -> Path | None:
        """As :meth:`_find`, in the folders beside the model's."""
        name = include.name
        exact = self.near.files(name)
        candidates = exact or self._similar(name)
        if len(candidates) > 1 and self.near.are_alike(candidates):
            candidates = candidates[:1]
        if len(candidates) == 1:
            path = candidates[0]
            self.taken.append(path)
            self._bases[next((f for f in self.near.folders if f / name == path), path.parent)] = None
            return path if exact else self._shimmed(name, path)
        if candidates and not _is_optional(name):
            self._report_ambiguous(include, file, candidates)
            return None
        self.shims[name] = Shim(name, None)
        self._report_missing(include, file)
        return None

    def _similar(self, name: str) -> list[Path]:
        """The files in the folders beside the model's with the name in another case, else without the folder in it."""
        others = (_other_case(name, [folder]) for folder in self.near.folders)
        candidates = [path for path in others if path is not None]
        return candidates if candidates or ".." in name else self.near.files(_base(name))

    def _shimmed(self, name: str, path: Path) -> Path:
        self.shims[name] = Shim(name, path)
        return path

    def _report_ambiguous(self, include: Include, file: SourceFile, candidates: list[Path]) -> None:
        message = f"'{include.name}' is not in the model's folder, but {len(candidates)} different ones are beside it"
        notes = [Note("one of them", Span(str(path))) for path in candidates[:8]]
        hint = "copy the right one into the model's folder"
        self._refuse("model-ambiguous-definition", include, file, message, hint, notes)

    def _refuse(
        self, id: str, include: Include, file: SourceFile, message: str, hint: str, notes: Sequence[Note]
    ) -> None:
        """Reports an error about a header, only once."""
        self.good = False
        if include.name not in self._told:
            self._told.add(include.name)
            span = file.span(include.start, include.start + len(include.name))
            self.diagnostics.error(id, span, message, hint=hint, notes=notes)

    def _report_missing(self, include: Include, file: SourceFile) -> None:
        """Reports a header that does not exist, only once.  For an optional header, this is a warning."""
        span = file.span(include.start, include.start + len(include.name))
        if _is_optional(include.name):
            hint = "the file is needed only if the model uses its functions; to get it, export the model again"
            message = f"'{include.name}' is not in the model's folder"
            self.diagnostics.warning("model-file-missing", span, message, hint=hint)
            return
        notes = self.near.notes(_base(include.name))
        mend = "copy the right one into the model's folder" if notes else "copy all files that 20-sim exported"
        message, hint = f"'{include.name}' is not in the model's folder, nor beside it", self.near.description()
        self._refuse("model-file-missing", include, file, message, f"{hint}; {mend}", notes)


def _is_optional(name: str) -> bool:
    return re.fullmatch(_OPTIONAL, _base(name).removesuffix(".h"), re.IGNORECASE) is not None


def _base(name: str) -> str:
    return name.replace("\\", "/").rsplit("/", 1)[-1]


def _plain(path: Path) -> Path:
    """``path`` without ``..``, if this is the same file; else ``path``."""
    plain = Path(os.path.normpath(path))
    return plain if ".." in path.parts and os.path.realpath(plain) == os.path.realpath(path) else path


def _other_case(name: str, search: Sequence[Path]) -> Path | None:
    """The file in one of the folders ``search`` whose name differs from ``name`` only in case."""
    for directory in search:
        path: Path | None = directory
        for part in name.replace("\\", "/").split("/"):
            if path is None or part in ("", ".", ".."):
                path = None
                break
            path = next((entry for entry in entries(path) if entry.name.casefold() == part.casefold()), None)
        if path is not None and path.is_file():
            return path
    return None
