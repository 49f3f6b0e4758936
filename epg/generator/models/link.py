# SPDX-License-Identifier: Apache-2.0
"""Finds the files that belong to one model: as a linker does, by the names that its functions use.

EPG searches the model's folder first, then the folders beside it (see ``neighbours.py``).

An export also contains demo programs, FMI functions and helpers that the model does not use.  Users put drivers and
other models beside it.  EPG leaves these files out, because it only follows the names that are used.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.source_file import SourceFile, read_source
from epg.generator.models.c_code import CFile, Function, parse_code
from epg.generator.models.declarations import declared_names, open_classes
from epg.generator.models.folders import entries, searched_folders, source_files
from epg.generator.models.headers import Headers, Shim
from epg.generator.models.neighbours import SOURCE_FOLDERS, Neighbours, report_taken
from epg.generator.models.whole import is_whole
from epg.generator.source import Span

_FMI_FILE = re.compile(r"fmi\w*functions?\w*\.c$", re.IGNORECASE)
_DEMO_FILE = re.compile(r"(test_.*|xxmain|sketch_.*)\.\w+$", re.IGNORECASE)
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
_INCLUDE_FOLDERS = ("include", "includes", "inc")


@dataclass(frozen=True)
class Linked:
    """The files of one model.  ``units`` are compiled; the first one has the model's entry points."""

    units: tuple[CFile, ...]
    headers: tuple[CFile, ...]
    include_dirs: tuple[Path, ...]
    shims: tuple[Shim, ...]
    searched: tuple[Path, ...] = ()
    """The folders outside the model's that were searched: a new or removed file in them can change the model."""
    considered: tuple[Path, ...] = ()
    """Files that were read to find those of the model, and that may not belong to it.  Their changes can change it."""
    looked: str = ""
    """The places that were searched for functions that no file defines, as text; empty if no function is missing."""
    elsewhere: Mapping[str, Span] = field(default_factory=dict)
    """The places in folders of other models that define these functions."""

    @property
    def main(self) -> CFile:
        return self.units[0]

    @property
    def all(self) -> tuple[CFile, ...]:
        return self.units + self.headers

    def macros(self) -> dict[str, str]:
        """The macros without parameters in all files: name to value."""
        return {macro.name: macro.value for code in self.all for macro in code.macros if not macro.parameters}

    def macro_names(self) -> set[str]:
        return {macro.name for code in self.all for macro in code.macros}

    def functions(self) -> Iterator[tuple[CFile, Function]]:
        return ((code, function) for code in self.all for function in code.functions)

    def reachable(self, roots: Iterable[Function]) -> list[tuple[CFile, Function]]:
        """The functions that can run when the functions ``roots`` are called, in the order of the files."""
        by_name: dict[str, list[tuple[CFile, Function]]] = {}
        for code, function in self.functions():
            by_name.setdefault(function.name, []).append((code, function))
        expansions = {macro.name: macro.value for code in self.all for macro in code.macros}
        open_names = [function.name for function in roots]
        seen: set[str] = set()
        while open_names:
            name = open_names.pop()
            if name in seen:
                continue
            seen.add(name)
            if name in expansions:
                open_names.extend(_IDENTIFIER.findall(expansions[name]))
            for code, function in by_name.get(name, ()):
                open_names.extend(_IDENTIFIER.findall(code.body(function)))
        return [(code, function) for code, function in self.functions() if function.name in seen]


def is_program(path: Path) -> bool:
    """True if a file is a demo program, or a file of FMI functions, that 20-sim writes beside a model."""
    return bool(_FMI_FILE.fullmatch(path.name) or _DEMO_FILE.fullmatch(path.name))


def link(main: CFile, suffixes: Iterable[str], diagnostics: Diagnostics) -> Linked | None:
    """The files that ``main`` needs.  None if a file is missing or a definition is ambiguous; both are reported."""
    return _Linker(main, tuple(suffixes), diagnostics).link()


class _Linker:
    """Adds files to a model until all names that it uses are defined, or until no file defines the missing ones."""

    def __init__(self, main: CFile, suffixes: tuple[str, ...], diagnostics: Diagnostics) -> None:
        self.main = main
        self.suffixes = suffixes
        self.diagnostics = diagnostics
        self.directory = main.file.path.parent
        self.near = Neighbours(self.directory, ".c" not in suffixes)
        self.definitions = _definitions(_pool(main, self.directory, suffixes, diagnostics))
        self.headers = Headers(_include_directories(self.directory), self.near, diagnostics)
        self.units = [main]
        self.taken: list[Path] = []
        self.done: set[str] = set()
        self.good = True

    def link(self) -> Linked | None:
        """The model's files.  None after an error."""
        self._collect()
        whole = [is_whole(unit.file, self.diagnostics) for unit in self.units]
        if not self._is_good() or not all(whole) or not self._all_classes():
            return None
        rest = sorted(self.units[1:], key=lambda code: str(code.file.path))
        places = [self.directory, *self.headers.folders(), *(code.file.path.parent for code in rest)]
        taken = [*self.headers.taken, *self.taken]
        report_taken(taken, self.main.file.path, self.near, self.diagnostics)
        missing = self._missing()
        return Linked(
            (self.main, *rest),
            tuple(self.headers.found[path] for path in sorted(self.headers.found)),
            tuple(dict.fromkeys(places)),
            tuple(self.headers.shims[name] for name in sorted(self.headers.shims)),
            self.near.watched,
            tuple(sorted({*source_files(self.directory, self.suffixes), *self.near.read})),
            self.near.description() if missing else "",
            self._elsewhere(missing) if missing else {},
        )

    def _collect(self) -> None:
        """Adds files until no more are found."""
        position = 0
        while position < len(self.units):
            self._follow(self.units[position])
            position += 1
            if position == len(self.units) and self._is_good():
                self._take_sources()

    def _is_good(self) -> bool:
        return self.good and self.headers.good

    def _follow(self, unit: CFile) -> None:
        """Adds the headers of ``unit``, and the files of the model's folder that define the names that it uses."""
        self.headers.follow(unit)
        for name in sorted(self._used(unit) - self.done):
            self.done.add(name)
            holders = self.definitions.get(name, [])
            if not holders or any(code is known for code in holders for known in self.units):
                continue
            self._add(name, holders, _choose(holders, self.main.file.path))

    def _used(self, unit: CFile) -> set[str]:
        """The names that ``unit`` uses, also those inside the macros of headers."""
        names = set(unit.used)
        for header in self.headers.found.values():
            names |= {
                word for macro in header.macros if macro.name in names for word in _IDENTIFIER.findall(macro.value)
            }
            if header.file.path.stem == unit.file.path.stem and unit.file.path.suffix != ".c":
                names |= header.identifiers  # the header of a C++ class names the types of its members
        return names

    def _add(self, name: str, holders: list[CFile], chosen: CFile | None) -> None:
        """Adds the file ``chosen``.  Reports an error if it is None, because several files define ``name``."""
        if chosen is not None:
            self.units.append(chosen)
            return
        self.good = False
        places = [Note("defined here", code.definition(name) or code.file.span(0)) for code in holders]
        message = f"'{name}' is defined in {len(holders)} files, so it is not clear which of them belongs to this model"
        hint = "put each model into a separate folder"
        self.diagnostics.error("model-ambiguous-definition", self.main.file.span(0), message, hint=hint, notes=places)

    def _take_sources(self) -> None:
        """Adds files from folders beside the model's, for names that the model's files declare but do not define."""
        missing = self._missing()
        if not missing:
            return
        named = self.headers.named(self.directory)
        definitions = _definitions(self._beside(named, missing))
        for name in sorted(missing & definitions.keys()):
            holders = definitions[name]
            if any(code is known for code in holders for known in self.units):
                continue
            chosen = self._meant(holders, named)
            self._add(name, holders, chosen)
            self.taken += [chosen.file.path] if chosen is not None else []

    def _beside(self, named: Iterable[Path], names: set[str]) -> list[CFile]:
        """The files with ``names`` in the folders ``named`` and in those beside the model's, each file once."""
        pool: list[CFile] = []
        seen = {os.path.realpath(unit.file.path) for unit in self.units}
        for folder in (*named, *self.near.folders):
            for file in self.near.sources(folder, self.suffixes, names):
                place = os.path.realpath(file.path)
                code = None if is_program(file.path) or place in seen else _not_a_program(file)
                seen.add(place)
                pool += [code] if code is not None else []
        return pool

    def _meant(self, holders: list[CFile], named: Iterable[Path]) -> CFile | None:
        """The file in one of the folders ``named``, any of several equal files, or the one that is nearest by name."""
        meant = [code for code in holders if code.file.path.parent in named]
        if len(meant) == 1:
            return meant[0]
        if len(holders) > 1 and self.near.are_alike([code.file.path for code in holders]):
            return holders[0]
        return _choose(holders, self.main.file.path)

    def _elsewhere(self, names: set[str]) -> Mapping[str, Span]:
        """The places in folders of other models that define ``names``."""
        definitions: dict[str, Span] = {}
        for folder in self.near.models:
            for file in self.near.sources(folder, self.suffixes, names):
                code = parse_code(file)
                for name, holders in _definitions([code]).items():
                    if name in names:
                        definitions.setdefault(name, holders[0].definition(name) or holders[0].file.span(0))
        return definitions

    def _missing(self) -> set[str]:
        """The functions, classes and variables that are declared and used, but that no file defines."""
        codes = [*self.units, *self.headers.found.values()]
        declared = {name for code in codes for name in declared_names(code)}
        used = {name for unit in self.units for name in self._used(unit)}
        defined = {function.owner or function.name for code in codes for function in code.functions}
        defined |= {variable.name for code in codes for variable in code.variables}
        defined |= {macro.name for code in codes for macro in code.macros}
        return (declared & used) - defined

    def _all_classes(self) -> bool:
        """True if the functions of each used class are defined.  Reports classes whose functions no file defines."""
        if ".c" in self.suffixes:
            return True
        owners = {function.owner for unit in self.units for function in unit.functions}
        used = self._used(self.main)
        good = True
        for header in self.headers.found.values():
            for name in sorted(open_classes(header) & used - owners):
                good = False
                match = re.search(rf"\b{name}\b", self.main.file.code)
                start = match.start() if match else 0
                message = f"'{name}' is declared in '{header.file.path.name}', but no file defines its functions"
                notes = self.near.notes(f"{header.file.path.stem}{self.main.file.path.suffix}")
                hint = f"{self.near.description()}: copy all files that 20-sim exported"
                span = self.main.file.span(start, start + len(name)) if match else self.main.file.span(0)
                self.diagnostics.error("model-incomplete", span, message, hint=hint, notes=notes)
        return good


def _pool(main: CFile, directory: Path, suffixes: Iterable[str], diagnostics: Diagnostics) -> list[CFile]:
    """The files that can belong to the model.

    Warns of a file that cannot be read, because its definitions may be missing later.
    """
    codes = [main]
    for path in source_files(directory, suffixes):
        if path == main.file.path or is_program(path):
            continue
        problems = Diagnostics()
        file = read_source(path, problems)
        for problem in problems:
            diagnostics.warning("model-unreadable", problem.span, problem.message, hint=problem.hint)
        if file is None:
            continue
        code = _not_a_program(file)
        if code is not None:
            codes.append(code)
    return codes


def _not_a_program(file: SourceFile) -> CFile | None:
    code = parse_code(file)
    return None if any(function.name == "main" and not function.owner for function in code.functions) else code


def _definitions(pool: Iterable[CFile]) -> Mapping[str, list[CFile]]:
    """The files that define each function, class and variable that is not static."""
    result: dict[str, list[CFile]] = {}
    for code in pool:
        for name in sorted(code.global_names()):
            result.setdefault(name, []).append(code)
    return result


def _choose(holders: list[CFile], main: Path) -> CFile | None:
    """The file that belongs to the model: the only one, the only one beside ``main``, or the one with the same suffix.

    None if this does not decide.  Users add the same suffix to the names of all files of a model.
    """
    if len(holders) == 1:
        return holders[0]
    beside = [code for code in holders if code.file.path.parent == main.parent]
    if len(beside) == 1:
        return beside[0]
    key = re.sub(r"(?i)^.*?submod(el)?", "", main.stem)
    same = [code for code in (beside or holders) if key and code.file.path.stem.casefold().endswith(key.casefold())]
    return same[0] if len(same) == 1 else None


def _include_directories(directory: Path) -> list[Path]:
    """The folders that are searched for headers: ``directory``, those below it, and an ``include`` beside a ``src``."""
    result = [directory]
    for parent in (directory, directory.parent if directory.name.lower() in SOURCE_FOLDERS else None):
        if parent is None:
            continue
        below = [entry for entry in entries(parent) if entry.is_dir() and not entry.name.startswith(".")]
        wanted = below if parent is directory else [entry for entry in below if entry.name.lower() in _INCLUDE_FOLDERS]
        result.extend(entry for entry in wanted if entry.name.lower() not in ("project", "build", "binaries"))
    return list(dict.fromkeys([*result, *searched_folders(directory)]))
