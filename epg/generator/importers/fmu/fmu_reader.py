# SPDX-License-Identifier: Apache-2.0
"""Reads the C files of an FMU as a compiler does: with the files that they include, and without the parts left out."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.source_file import SourceFile, decode
from epg.generator.documents.text_file import one_line
from epg.generator.importers.fmu.fmu_files import SOURCES, FmuFiles
from epg.generator.models.c_code import CFile, Include, includes, parse_code
from epg.generator.models.conditions import NO, YES
from epg.generator.models.declarations import declared_names
from epg.generator.models.identifiers import words
from epg.generator.models.preprocessor import ConditionalSection, Preprocessor, TooManyFiles, blank, deciding_macros
from epg.generator.source import Span

FMI_HEADERS = {
    2: ("fmi2TypesPlatform.h", "fmi2FunctionTypes.h", "fmi2Functions.h"),
    3: ("fmi3PlatformTypes.h", "fmi3FunctionTypes.h", "fmi3Functions.h"),
}
C_HEADERS = {
    f"{name}.h"
    for name in words("""
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic
    stdbool stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype
""")
}
_CONDITION = re.compile(r"^[ \t]*#[ \t]*(if\w*|elif|else|endif)\b[^\n]*", re.MULTILINE)
_MOST_ROUNDS = 30  # in which units are added that others need; each round adds all that are known to be missing
_WORD = re.compile(r"[A-Za-z_]\w*", re.ASCII)


class Reader:
    """The files of an FMU that its compiler reads, parsed.  ``macros`` are those that all units are compiled with.

    ``codes`` and ``parts`` belong to the units of the last :meth:`go`.
    """

    def __init__(
        self, files: FmuFiles, include_dirs: Iterable[str], macros: Mapping[str, str], diagnostics: Diagnostics
    ) -> None:
        self.files = files
        self.include_dirs = tuple(include_dirs)
        self.macros = macros
        self.diagnostics = diagnostics
        self.codes: dict[str, CFile] = {}
        self.parts: dict[str, list[ConditionalSection]] = {}
        self.included: dict[str, str] = {}
        self._texts: dict[str, SourceFile] = {}
        self._taken: dict[str, list[str]] = {}
        self._missing: dict[str, tuple[Span, list[str]]] = {}
        self._told: set[str] = set()
        self._parsed: dict[str, tuple[tuple[tuple[int, int], ...], CFile]] = {}  # and the parts that were left out
        self._work = 0

    @cached_property
    def _places(self) -> dict[str, list[str]]:
        """All files of the FMU, by the last part of their names."""
        places: dict[str, list[str]] = {}
        for name in sorted(self.files.contents):
            places.setdefault(posixpath.basename(name), []).append(name)
        return places

    def own(self, headers: Iterable[str]) -> dict[str, str]:
        """The headers of the standard that the FMU contains in a folder where generated code finds them."""
        found = {}
        for header in headers:
            places = [f"{folder}/{header}" for folder in self.include_dirs]
            place = next((place for place in places if place in self.files.contents), None)
            if place is not None and self.read(place):
                found[header] = place
        return found

    def file(self, name: str) -> SourceFile:
        """The text of a file."""
        if name not in self._texts:
            text = decode(self.files.contents[name])
            self._texts[name] = SourceFile(self.files.path(name), text, self.files.archive)
        return self._texts[name]

    def is_text(self, name: str) -> bool:
        data = self.files.contents[name]
        return b"\0" not in data or data.startswith((b"\xff\xfe", b"\xfe\xff"))

    def read(self, name: str) -> bool:
        """Returns False, after an error, if a file is not a text file."""
        if not self.is_text(name):
            if name not in self._told:
                self._told.add(name)
                place = Span(str(self.files.path(name)))
                message = f"'{posixpath.basename(name)}' is not a text file"
                self.diagnostics.error("model-unreadable", place, message, hint="export the FMU again")
            return False
        return True

    def go(self, units: Iterable[str]) -> None:
        """Parses ``units`` and the files that they include, without the parts that no compiler sees."""
        preprocessor = Preprocessor(self.file, self._find, self._work)
        try:
            for unit in units:
                preprocessor.add(unit, self.macros)
        except TooManyFiles as problem:
            place = Span(str(self.files.path(unit)))
            self.diagnostics.error("model-unreadable", place, str(problem), hint="export the FMU again")
        self._work = preprocessor.work
        self.included = preprocessor.included
        self.parts = {name: preprocessor.parts(name) for name in preprocessor.names()}
        self.codes = {name: self._code(name, blank(parts)) for name, parts in self.parts.items()}

    def _code(self, name: str, left_out: tuple[tuple[int, int], ...]) -> CFile:
        """The file without the parts that are ``left_out``, parsed; only once if these are the same as before."""
        known = self._parsed.get(name)
        if known is None or known[0] != left_out:
            known = left_out, parse_code(self.file(name).leaving_out(left_out))
            self._parsed[name] = known
        return known[1]

    def mentioned(self) -> set[str]:
        """The files that the files of :attr:`codes` include, and the files that those include, under any condition."""
        files = set(self.codes)
        waiting = sorted(files)
        while waiting:
            name = waiting.pop()
            for include in includes(self.file(name)):
                place = self._in_folders(name, include)
                if place is not None and place not in files and self.is_text(place):
                    files.add(place)
                    waiting.append(place)
        return files

    # units of an FMU without a list of its sources --------------------------------------------------------------------

    def without_included(self, units: list[str]) -> list[str]:
        """``units`` without those that are parts of others, by ``#include "part.c"``."""
        probe = Reader(self.files, self.include_dirs, self.macros, Diagnostics())
        probe.go(units)
        rest = [unit for unit in units if probe.included.get(unit, NO) == NO]
        return rest or units

    def linked(self, units: list[str], headers: Iterable[str]) -> list[str]:
        """``units``, and C files in folders below them that define functions which these need, as a linker finds them.

        Functions that are still missing after :data:`_MOST_ROUNDS` rounds are reported when the model is linked.
        Afterwards :attr:`codes` are those of the result and of ``headers``.
        """
        pool: dict[str, set[str]] = {}
        headers = tuple(headers)
        for _ in range(_MOST_ROUNDS):
            self.go([*units, *headers])
            chosen = self._defining(self.missing(), pool)
            if not chosen:
                return units
            units = [*units, *sorted(chosen)]
        self.go([*units, *headers])
        return units

    def _defining(self, symbols: set[str], pool: dict[str, set[str]]) -> set[str]:
        """C files, not yet compiled, that define ``symbols``; of several for one symbol, that in the upper folder.

        ``pool`` keeps the names that each file defines.
        """
        holders: dict[str, list[str]] = {}
        for name in sorted(self.files.contents, key=lambda name: (name.count("/"), name)):
            if not re.fullmatch(rf"{SOURCES}/.*\.[cC]", name) or name in self.codes or not self.is_text(name):
                continue
            if name not in pool:
                pool[name] = set(parse_code(self.file(name)).global_names())
            for symbol in pool[name] & symbols:
                holders.setdefault(symbol, []).append(name)
        chosen: set[str] = set()
        for symbol in sorted(holders):
            if chosen.isdisjoint(holders[symbol]):
                chosen.add(holders[symbol][0])
        return chosen

    def missing(self) -> set[str]:
        """The functions and variables that the files declare and use, but that none of them defines."""
        declared: set[str] = set()
        used: set[str] = set()
        defined: set[str] = set()
        macros: dict[str, list[str]] = {}
        for code in self.codes.values():
            declared |= declared_names(code)
            used |= code.used
            defined |= {function.name for function in code.functions}
            defined |= {variable.name for variable in code.variables}
            for macro in code.macros:
                macros.setdefault(macro.name, []).append(macro.value)
        waiting = sorted(used & macros.keys())
        while waiting:
            for value in macros[waiting.pop()]:
                new = set(_WORD.findall(value)) - used
                used |= new
                waiting += sorted(new & macros.keys())
        return (declared & used) - defined - macros.keys()

    # headers ---------------------------------------------------------------------------------------------------------

    def _find(self, name: str, include: Include, condition: str) -> str | None:
        """The file that ``include`` in the file ``name`` means.  Collects files that are missing."""
        file = self._in_folders(name, include)
        if file is None and condition == YES and _must_exist(include):
            file = self._find_below(name, include)
        return file if file is not None and self.read(file) else None

    def _in_folders(self, name: str, include: Include) -> str | None:
        wanted = include.name.replace("\\", "/")
        folders = self.include_dirs if include.system else (posixpath.dirname(name), *self.include_dirs)
        for folder in folders:
            place = posixpath.normpath(posixpath.join(folder, wanted))
            if place in self.files.contents:
                return place
        return None

    def _find_below(self, name: str, include: Include) -> str | None:
        """The header in any folder of the FMU, or None if it is missing.

        Some tools put headers into folders that no file of the FMU names.  The header is taken if there is only one, or
        if all have the same text.
        """
        wanted = f"/{include.name.replace(chr(92), '/')}"
        places = [place for place in self._places.get(posixpath.basename(wanted), ()) if place.endswith(wanted)]
        if len({re.sub(rb"\s+", b" ", self.files.contents[place]) for place in places}) == 1:
            folder = places[0][: -len(wanted)]
            self.include_dirs = (*self.include_dirs, folder)
            self._taken.setdefault(folder, []).append(include.name)
            return places[0]
        span = self.file(name).span(include.start, include.start + len(include.name))
        shown = one_line(include.name)[:80]
        if not places:
            self._missing.setdefault(shown, (span, self._excluding(name, include)))
        elif shown not in self._told:
            self._told.add(shown)
            message = f"'{shown}' is in {len(places)} folders of the FMU, and it is not clear which of them is meant"
            hint = f"write the folder in the #include: {', '.join(one_line(place) for place in places[:4])}"
            self.diagnostics.error("fmu-file-missing", span, message, hint=hint)
        return None

    def _excluding(self, name: str, include: Include) -> list[str]:
        """The macros that leave out ``include`` if one of them is defined."""
        around = (deciding_macros(line, NO) for _, line in self.around(name, include.start))
        return next((macros for macros in around if macros), [])

    def around(self, name: str, offset: int) -> Iterator[tuple[int, str]]:
        """The directives before ``offset`` of the groups around it, the last one first: their offsets and lines.

        For each group these are its ``#if`` and those before its branch, and that of the branch itself.
        """
        text = self.file(name).without_comments
        depth = 0
        for match in reversed(list(_CONDITION.finditer(text, 0, offset))):
            if match[1] == "endif":
                depth += 1
            elif not depth:
                yield text.index("#", match.start()), match[0].strip()
            elif match[1].startswith("if"):
                depth -= 1

    def report(self, beside: Path | None) -> None:
        """Reports files that are missing, as one error, and headers in folders that nothing names, as notes."""
        names = list(self._missing)
        if names:
            message = f"'{names[0]}' is not among the FMU's sources{also(names)}"
            hint = "export the FMU again, with all its sources"
            span, macros = self._missing[names[0]]
            if macros:
                place = f"'{beside.name}'" if beside is not None else "a model.yaml"
                hint += f", or write 'definitions: {{{macros[0]}: 1}}' in {place}, if it was made for that"
            self.diagnostics.error("fmu-file-missing", span, message, hint=hint)
        for folder, found in sorted(self._taken.items()):
            message = f"these headers are in '{one_line(folder)}', which the FMU does not list as a folder of headers: "
            shown = ", ".join(one_line(name) for name in sorted(set(found))[:12])
            self.diagnostics.note("model-neighbour", Span(str(self.files.path(folder))), message + shown)


def also(names: list[str]) -> str:
    """The names after the first one, for the end of a message: `` (nor are 'b.h', 'c.h')``."""
    rest = ", ".join(f"'{name}'" for name in names[1:5])
    more = f" and {len(names) - 5} more" if names[5:] else ""
    return f" (nor {'are' if names[2:] else 'is'} {rest}{more})" if rest else ""


def _must_exist(include: Include) -> bool:
    """True if the FMU must contain the file of ``include``: it is not a header of C or of FMI."""
    basename = posixpath.basename(include.name)
    return not (include.system or basename in C_HEADERS or any(basename in names for names in FMI_HEADERS.values()))
