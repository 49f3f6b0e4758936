# SPDX-License-Identifier: Apache-2.0
"""Which files belong to one model: those that its functions need, found as a linker does.

They are looked for in the model's folder first.  What is not there may lie beside it: see ``neighbours.py``.
Exports carry demo programs, FMI functions and unused helpers, developers put drivers and a second model beside them:
following the names that are used leaves all of that out without knowing what it is called.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from epg.diagnostics import Diagnostics, Note
from epg.documents.source_file import SourceFile, read_source
from epg.models.c_code import Code, Function, parse_code
from epg.models.declarations import declared_names, open_classes
from epg.models.folders import searched_folders, source_files
from epg.models.headers import Headers, Shim
from epg.models.neighbours import SOURCE_FOLDERS, Neighbours, all_alike, report_taken
from epg.models.whole import is_whole
from epg.source import Span

_FMI_FILE = re.compile(r"fmi\w*functions?\w*\.c$", re.IGNORECASE)
_DEMO_FILE = re.compile(r"(test_.*|xxmain|sketch_.*)\.\w+$", re.IGNORECASE)
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
_INCLUDE_FOLDERS = ("include", "includes", "inc")


@dataclass(frozen=True)
class Linked:
    """The files of one model.  ``units`` are compiled, the one with the model's entry points first."""

    units: tuple[Code, ...]
    headers: tuple[Code, ...]
    include_dirs: tuple[Path, ...]
    shims: tuple[Shim, ...]
    searched: tuple[Path, ...] = ()
    """Folders outside of the model's, of which the list of files matters."""
    twins: tuple[Path, ...] = ()
    """Files that would make another model, or none, if they changed, though they are no part of it."""
    looked: str = ""
    """Where was looked for functions that no file defines; empty if there are none."""
    elsewhere: Mapping[str, Span] = field(default_factory=dict)
    """Where folders of other models define them."""

    @property
    def main(self) -> Code:
        return self.units[0]

    @property
    def all(self) -> tuple[Code, ...]:
        return self.units + self.headers

    def macros(self) -> dict[str, str]:
        """Object-like macros of all files."""
        return {macro.name: macro.value for code in self.all for macro in code.macros if not macro.parameters}

    def macro_names(self) -> set[str]:
        return {macro.name for code in self.all for macro in code.macros}

    def functions(self) -> Iterator[tuple[Code, Function]]:
        for code in self.all:
            for function in code.functions:
                yield code, function

    def reachable(self, roots: Iterable[Function]) -> list[tuple[Code, Function]]:
        """Functions that run when those of ``roots`` are called, in the order of the files."""
        by_name: dict[str, list[tuple[Code, Function]]] = {}
        for code, function in self.functions():
            by_name.setdefault(function.name, []).append((code, function))
        expansions = {macro.name: macro.value for code in self.all for macro in code.macros}
        found: set[tuple[Path, int]] = set()
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
                found.add((code.file.path, function.start))
                open_names.extend(_IDENTIFIER.findall(code.body(function)))
        return [(code, function) for code, function in self.functions() if (code.file.path, function.start) in found]


def is_program(path: Path) -> bool:
    """Whether a file is one of the demo programs or FMI glue files that 20-sim writes beside a model."""
    return bool(_FMI_FILE.fullmatch(path.name) or _DEMO_FILE.fullmatch(path.name))


def link(main: Code, suffixes: Iterable[str], diagnostics: Diagnostics) -> Linked | None:
    """The files that ``main`` needs; None after reporting an ambiguous definition or a missing file."""
    return _Linker(main, tuple(suffixes), diagnostics).link()


class _Linker:
    def __init__(self, main: Code, suffixes: tuple[str, ...], diagnostics: Diagnostics) -> None:
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
        position = 0
        while position < len(self.units):
            self._follow(self.units[position])
            position += 1
            if position == len(self.units) and self.good and self.headers.good:
                self._take_sources()
        whole = [is_whole(unit.file, self.diagnostics) for unit in self.units]
        if not self.good or not self.headers.good or not all(whole) or not self._all_classes():
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
            tuple(sorted(self.headers.twins)),
            self.near.description() if missing else "",
            self._elsewhere(missing) if missing else {},
        )

    def _follow(self, unit: Code) -> None:
        """Adds the headers of ``unit``, and the files of the model's folder that define what it uses."""
        self.headers.follow(unit)
        for name in sorted(self._used(unit) - self.done):
            self.done.add(name)
            holders = self.definitions.get(name, [])
            if not holders or any(code is known for code in holders for known in self.units):
                continue
            self._add(name, holders, _choose(holders, self.main.file.path))

    def _used(self, unit: Code) -> set[str]:
        names = set(unit.used)
        for header in self.headers.found.values():
            names |= {
                word for macro in header.macros if macro.name in names for word in _IDENTIFIER.findall(macro.value)
            }
            if header.file.path.stem == unit.file.path.stem and unit.file.path.suffix != ".c":
                names |= header.identifiers  # types of a class's members
        return names

    def _add(self, name: str, holders: list[Code], chosen: Code | None) -> None:
        if chosen is not None:
            self.units.append(chosen)
            return
        self.good = False
        places = [Note("defined here", _definition_span(code, name)) for code in holders]
        self.diagnostics.error(
            "model-ambiguous-definition",
            self.main.file.span(0),
            f"'{name}' is defined in {len(holders)} files, so it is open which of them belong to this model",
            hint="keep each model in a folder of its own",
            notes=places,
        )

    def _take_sources(self) -> None:
        """Adds files beside the model's folder that define what its headers declare and no file of it defines."""
        missing = self._missing()
        if not missing:
            return
        pool: list[Code] = []
        seen = {os.path.realpath(unit.file.path) for unit in self.units}
        named = self.headers.named(self.directory)
        for folder in (*named, *self.near.folders):
            for file in self.near.sources(folder, self.suffixes, missing):
                place = os.path.realpath(file.path)
                code = None if is_program(file.path) or place in seen else _not_a_program(file)
                seen.add(place)
                pool += [code] if code is not None else []
        definitions = _definitions(pool)
        for name in sorted(missing & definitions.keys()):
            holders = definitions[name]
            if any(code is known for code in holders for known in self.units):
                continue
            paths = [code.file.path for code in holders]
            meant = [code for code in holders if code.file.path.parent in named]
            alike = len(paths) > 1 and all_alike(paths)
            self.headers.twins.update(paths if alike else ())
            chosen = meant[0] if len(meant) == 1 else holders[0] if alike else _choose(holders, self.main.file.path)
            self._add(name, holders, chosen)
            self.taken += [chosen.file.path] if chosen is not None else []

    def _elsewhere(self, names: set[str]) -> Mapping[str, Span]:
        """Where other models define ``names``."""
        found: dict[str, Span] = {}
        for folder in self.near.models:
            for file in self.near.sources(folder, self.suffixes, names):
                code = parse_code(file)
                for name, holders in _definitions([code]).items():
                    if name in names:
                        found.setdefault(name, _definition_span(holders[0], name))
        return found

    def _missing(self) -> set[str]:
        """Functions, classes and variables that headers declare, that the model uses, and that no file defines."""
        codes = [*self.units, *self.headers.found.values()]
        declared = {name for code in codes for name in declared_names(code)}
        used = {name for unit in self.units for name in self._used(unit)}
        defined = {function.owner or function.name for code in codes for function in code.functions}
        defined |= {variable.name for code in codes for variable in code.variables}
        defined |= {macro.name for code in codes for macro in code.macros}
        return (declared & used) - defined

    def _all_classes(self) -> bool:
        """Reports a class that the model uses and whose functions no file defines."""
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


def _pool(main: Code, directory: Path, suffixes: Iterable[str], diagnostics: Diagnostics) -> list[Code]:
    """The files that may belong to the model.  One that cannot be read is named: what it defines may be missing."""
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


def _not_a_program(file: SourceFile) -> Code | None:
    code = parse_code(file)
    return None if any(function.name == "main" and not function.owner for function in code.functions) else code


def _definitions(pool: Iterable[Code]) -> Mapping[str, list[Code]]:
    result: dict[str, list[Code]] = {}
    for code in pool:
        names = {function.owner or function.name for function in code.functions if not function.static}
        names |= {variable.name for variable in code.variables if not variable.static}
        for name in sorted(names):
            result.setdefault(name, []).append(code)
    return result


def _definition_span(code: Code, name: str) -> Span:
    places = [function.start for function in code.functions if function.name == name]
    places += [variable.start for variable in code.variables if variable.name == name]
    return code.file.span(places[0], places[0] + len(name)) if places else code.file.span(0)


def _choose(holders: list[Code], main: Path) -> Code | None:
    """The file meant: the only one, the one beside ``main``, or the one renamed in the same way."""
    if len(holders) == 1:
        return holders[0]
    beside = [code for code in holders if code.file.path.parent == main.parent]
    if len(beside) == 1:
        return beside[0]
    key = re.sub(r"(?i)^.*?submod(el)?", "", main.stem)
    same = [code for code in (beside or holders) if key and code.file.path.stem.casefold().endswith(key.casefold())]
    return same[0] if len(same) == 1 else None


def _include_directories(directory: Path) -> list[Path]:
    """Where headers are looked for: beside the sources, below them, and in the ``include`` beside a ``src``."""
    result = [directory]
    for parent in (directory, directory.parent if directory.name.lower() in SOURCE_FOLDERS else None):
        if parent is None:
            continue
        try:
            below = sorted(entry for entry in parent.iterdir() if entry.is_dir() and not entry.name.startswith("."))
        except OSError:
            continue
        wanted = below if parent is directory else [entry for entry in below if entry.name.lower() in _INCLUDE_FOLDERS]
        result.extend(entry for entry in wanted if entry.name.lower() not in ("project", "build", "binaries"))
    return list(dict.fromkeys([*result, *searched_folders(directory)]))
