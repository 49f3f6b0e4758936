"""Which files of a folder belong to one model: those that its functions need, found as a linker does.

Exports carry demo programs, FMI functions and unused helpers, developers put drivers and a second model beside them:
following the names that are used leaves all of that out without knowing what it is called.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from epg.diagnostics import Diagnostics, Note
from epg.load.models.c_code import Code, Function, Include, parse_code
from epg.load.models.folders import source_files
from epg.load.models.source_file import SourceFile, read_source
from epg.load.text_file import is_file
from epg.source import Span

_FMI_FILE = re.compile(r"fmi\w*functions?\w*\.c$", re.IGNORECASE)
_DEMO_FILE = re.compile(r"(test_.*|xxmain|sketch_.*)\.\w+$", re.IGNORECASE)
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")

#: headers of an export that declare nothing a model needs unless it calls their functions
_OPTIONAL_HEADER = re.compile(r"motionprofiles|eulerangles|\w*(table2d|matrix|inverse|funcs)\w*", re.IGNORECASE)


@dataclass(frozen=True)
class Shim:
    """A header that the export includes as ``name`` and that has another case, ``target``, or does not exist."""

    name: str
    target: Path | None


@dataclass(frozen=True)
class Linked:
    """The files of one model.  ``units`` are compiled, the one with the model's entry points first."""

    units: tuple[Code, ...]
    headers: tuple[Code, ...]
    include_dirs: tuple[Path, ...]
    shims: tuple[Shim, ...]

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
    """The files that ``main`` needs; None after reporting an ambiguous definition or a missing header."""
    directory = main.file.path.parent
    pool = _pool(main, directory, suffixes, diagnostics)
    definitions = _definitions(pool)
    units = [main]
    headers: dict[Path, Code] = {}
    shims: dict[str, Shim] = {}
    search = _include_directories(directory)
    done: set[str] = set()
    good = True
    position = 0
    while position < len(units):
        unit = units[position]
        position += 1
        good &= _collect_headers(unit, search, headers, shims, diagnostics)
        names = set(unit.used)
        for header in headers.values():
            names |= {
                word for macro in header.macros if macro.name in names for word in _IDENTIFIER.findall(macro.value)
            }
            if header.file.path.stem == unit.file.path.stem and unit.file.path.suffix != ".c":
                names |= header.identifiers  # types of a class's members
        for name in sorted(names - done):
            done.add(name)
            holders = definitions.get(name, [])
            if not holders or any(code is known for code in holders for known in units):
                continue
            chosen = _choose(holders, main.file.path)
            if chosen is None:
                good = False
                places = [Note("defined here", _definition_span(code, name)) for code in holders]
                diagnostics.error(
                    "model-ambiguous-definition",
                    main.file.span(0),
                    f"'{name}' is defined in {len(holders)} files, so it is open which of them belong to this model",
                    hint="keep each model in a folder of its own",
                    notes=places,
                )
                continue
            units.append(chosen)
    if not good:
        return None
    rest = sorted(units[1:], key=lambda code: str(code.file.path))
    directories = dict.fromkeys(
        [directory, *(path.parent for path in headers), *(code.file.path.parent for code in rest)]
    )
    return Linked(
        (main, *rest),
        tuple(headers[path] for path in sorted(headers)),
        tuple(directories),
        tuple(shims[name] for name in sorted(shims)),
    )


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
        code = parse_code(file)
        if not any(function.name == "main" and not function.owner for function in code.functions):
            codes.append(code)
    return codes


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
    for parent in (directory, directory.parent if directory.name.lower() in ("src", "source", "sources") else None):
        if parent is None:
            continue
        try:
            below = sorted(entry for entry in parent.iterdir() if entry.is_dir() and not entry.name.startswith("."))
        except OSError:
            continue
        result.extend(entry for entry in below if entry.name.lower() not in ("project", "build", "binaries"))
    return list(dict.fromkeys(result))


def _collect_headers(
    unit: Code, search: list[Path], headers: dict[Path, Code], shims: dict[str, Shim], diagnostics: Diagnostics
) -> bool:
    good = True
    open_codes = [unit]
    while open_codes:
        code = open_codes.pop()
        for include in code.includes:
            if include.system:
                continue
            path = _find_header(include, code.file, search)
            if path is None:
                path = _other_case(include.name, [code.file.path.parent, *search])
                shims[include.name] = Shim(include.name, path)
                if path is None:
                    good &= _report_missing(include, code.file, diagnostics)
                    continue
            if path in headers:
                continue
            file = read_source(path, diagnostics, code.file.span(include.start, include.start + len(include.name)))
            if file is None:
                good = False
                continue
            headers[path] = parse_code(file)
            open_codes.append(headers[path])
    return good


def _find_header(include: Include, file: SourceFile, search: list[Path]) -> Path | None:
    for directory in (file.path.parent, *search):
        path = directory / include.name
        if is_file(path):
            return path
    return None


def _other_case(name: str, search: list[Path]) -> Path | None:
    for directory in search:
        path: Path | None = directory
        for part in name.replace("\\", "/").split("/"):
            if path is None or part in ("", ".", ".."):
                path = None
                break
            try:
                path = next((e for e in sorted(path.iterdir()) if e.name.casefold() == part.casefold()), None)
            except OSError:
                path = None
        if path is not None and path.is_file():
            return path
    return None


def _report_missing(include: Include, file: SourceFile, diagnostics: Diagnostics) -> bool:
    """Reports a header that does not exist; True when the model can do without."""
    span = file.span(include.start, include.start + len(include.name))
    name = include.name.replace("\\", "/").rsplit("/", 1)[-1]
    if _OPTIONAL_HEADER.fullmatch(name.removesuffix(".h")):
        diagnostics.warning(
            "model-file-missing",
            span,
            f"'{include.name}' is not in the model's folder",
            hint="it is not needed unless the model uses its functions; export again to have it",
        )
        return True
    diagnostics.error(
        "model-file-missing",
        span,
        f"'{include.name}' is not in the model's folder",
        hint="copy all files that 20-sim exported",
    )
    return False
