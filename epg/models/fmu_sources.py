# SPDX-License-Identifier: Apache-2.0
"""Finds the files of an FMU that must be compiled, their definitions, and the headers that they include.

In FMI 2.0, the description lists the files.  FMUs of older tools do not have a list; then every C file in ``sources``
is compiled.  FMI 3.0 has ``sources/buildDescription.xml``, with definitions of macros and folders of headers.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterable
from dataclasses import field
from functools import cached_property
from pathlib import Path

from epg.dataclass import dataclass
from epg.diagnostics import Diagnostics
from epg.documents.source_file import SourceFile, decode
from epg.documents.text_file import one_line
from epg.documents.xml_file import Element, parse_xml
from epg.models.c_code import Code, Include, parse_code
from epg.models.fmu_description import Description
from epg.models.fmu_files import SOURCES, FmuFiles
from epg.models.identifiers import words
from epg.models.link import Linked
from epg.source import Span

BUILD = f"{SOURCES}/buildDescription.xml"
MAX_SOURCES = 2000
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
_PREFIX = re.compile(r"FMI[23]_(?:OVERRIDE_|ACTUAL_)?FUNCTION_PREFIX")
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_INACTIVE = re.compile(r"^[ \t]*#[ \t]*(if|endif)\w*", re.MULTILINE)


@dataclass(frozen=True)
class FmuSources:
    """The source files of an FMU.  All names are relative to its top.

    ``units`` are compiled, ``headers`` are the files that they include.  ``include_dirs`` are folders of headers.
    ``definitions`` are macros with their values.  ``own_headers`` are the headers of FMI that the FMU contains.
    """

    units: tuple[str, ...]
    headers: tuple[str, ...]
    include_dirs: tuple[str, ...]
    definitions: tuple[tuple[str, str], ...]
    codes: dict[str, Code] = field(repr=False)
    own_headers: frozenset[str]

    @property
    def linked(self) -> Linked:
        """The parsed files, for the same checks as those of exports of 20-sim."""
        units, headers = ([self.codes[name] for name in names] for names in (self.units, self.headers))
        return Linked(tuple(units), tuple(headers), (), ())


@dataclass(frozen=True)
class _Listed:
    """The sources that the FMU lists, relative to ``sources``, with their folders of headers and definitions."""

    files: tuple[tuple[str, Span], ...]
    include_dirs: tuple[str, ...] = ()
    definitions: tuple[tuple[str, str], ...] = ()


# One function, because it is a list of steps, and each step runs only if the steps before it found no errors.
def find_sources(files: FmuFiles, description: Description, diagnostics: Diagnostics) -> FmuSources | None:
    """The sources of the FMU.  None if it cannot be compiled; the reasons are reported."""
    before = diagnostics.error_count
    present = [name for name in files.contents if name.startswith(f"{SOURCES}/") and name != BUILD]
    if not any(name.endswith((".c", ".h")) for name in present):
        _no_sources(files, present, description, diagnostics)
        return None
    listed = _listed(files, description, diagnostics)
    if listed is None or diagnostics.error_count > before:
        return None
    include_dirs = tuple(dict.fromkeys((SOURCES, *listed.include_dirs)))
    reader = _Reader(files, include_dirs, diagnostics)
    units, foreign = [], []
    for name, span in listed.files:
        place = _inside(name)
        if place not in files.contents:
            message = f"'{one_line(name)[:80]}' is listed as a source, but the FMU does not contain it"
            diagnostics.error("fmu-file-missing", span, message, hint="export the FMU again, with its sources")
        elif place.lower().endswith(".h"):
            continue  # some tools also list the headers; the files that include them find them
        elif not place.lower().endswith(".c"):
            foreign.append((name, span))
        elif reader.read(place):
            units.append(place)
    if foreign:
        names = ", ".join(f"'{one_line(name)[:80]}'" for name, _ in foreign[:4])
        more = f" and {len(foreign) - 4} more" if foreign[4:] else ""
        message = (
            f"{names}{more} {'are not C files' if foreign[1:] else 'is not a C file'}: EPG supports only FMUs in C"
        )
        diagnostics.error("fmu-language", foreign[0][1], message, hint="export the FMU as C code")
    if diagnostics.error_count > before:
        return None
    own = reader.own(FMI_HEADERS[description.standard])
    reader.follow([*units, *own.values()])
    reader.report_taken()
    if diagnostics.error_count > before:
        return None
    main = {2: "fmi2DoStep", 3: "fmi3DoStep"}[description.standard]
    if not any(main in code.identifiers for code in reader.codes.values()):
        message = f"none of the FMU's sources has the function {main}"
        hint = "export it for co-simulation, with all its sources"
        diagnostics.error("fmu-file-missing", description.span, message, hint=hint)
        return None
    headers = tuple(sorted(reader.codes.keys() - set(units)))
    return FmuSources(
        tuple(dict.fromkeys(units)), headers, reader.include_dirs, listed.definitions, reader.codes, frozenset(own)
    )


def _no_sources(files: FmuFiles, present: list[str], description: Description, diagnostics: Diagnostics) -> None:
    hint = "export it as a source code FMU, with C code in 'sources'"
    if any(Path(name).suffix.lower() in (".cpp", ".cc", ".cxx") for name in present):
        message = "the FMU's sources are C++: EPG supports only FMUs in C"
        diagnostics.error("fmu-language", description.span, message, hint=hint)
        return
    compiled = f": it is compiled for {', '.join(files.binaries[:6])} only" if files.binaries else ""
    diagnostics.error("fmu-no-sources", description.span, f"the FMU has no sources{compiled}", hint=hint)


def _listed(files: FmuFiles, description: Description, diagnostics: Diagnostics) -> _Listed | None:
    """The sources that the description or the build description names, or else all C files in ``sources``."""
    if description.standard == 3 and BUILD in files.contents:
        whole = Span(str(files.path(BUILD)))
        root = parse_xml(files.contents[BUILD], whole, diagnostics, hint="export the FMU again", shown=files.archive)
        return _configuration(root, description, diagnostics) if root is not None else None
    if description.sources:
        return _Listed(description.sources)
    found = [name for name in sorted(files.contents) if re.fullmatch(rf"{SOURCES}/[^/]+\.[cC]", name)]
    return _Listed(tuple((name[len(SOURCES) + 1 :], description.span) for name in found[:MAX_SOURCES]))


def _configuration(root: Element, description: Description, diagnostics: Diagnostics) -> _Listed | None:
    """The build configuration for this FMU.  If there are several, the first one without a platform is chosen."""
    found = [child for child in root.children if child.name == "BuildConfiguration"]
    fitting = [child for child in found if child.attributes.get("modelIdentifier") == description.identifier]
    wanted = f"'{one_line(description.identifier)[:60]}'"
    if not fitting and len({child.attributes.get("modelIdentifier") for child in found}) == 1:
        fitting = found  # if an FMU was made from the files of another one, that one's name can be left here
        other = one_line(found[0].attributes.get("modelIdentifier", ""))[:60]
        message = f"the build configuration is for '{other}', but the FMU is {wanted}: EPG uses it anyway"
        diagnostics.warning("fmu-other-name", found[0].span, message, hint="check that these are the FMU's sources")
    fitting.sort(key=lambda child: "platform" in child.attributes)
    if not fitting:
        message = f"there is no build configuration for {wanted}"
        diagnostics.error("fmu-file-missing", root.span, message, hint="export the FMU again, with its sources")
        return None
    chosen = fitting[0]
    listed: list[tuple[str, Span]] = []
    folders: list[str] = []
    definitions: dict[str, str] = {}
    for part in chosen.children:
        if part.name == "Library" and part.attributes.get("name") != "m":
            message = f"the FMU needs the library '{one_line(part.attributes.get('name', ''))[:60]}'"
            diagnostics.error("fmu-library", part.span, message, hint="export the FMU with the sources of this library")
        if part.name != "SourceFileSet":
            continue
        language = part.attributes.get("language", "C")
        if re.match(r"(?i)c\+\+|cpp|fortran|ada", language):
            message = f"a part of the FMU is written in {one_line(language)[:20]}: EPG supports only FMUs in C"
            diagnostics.error("fmu-language", part.span, message, hint="export the FMU as C code")
        for item in part.children:
            name = item.attributes.get("name", "")
            if item.name == "SourceFile":
                listed.append((name, item.span))
            elif item.name == "IncludeDirectory":
                folders.append(_inside(name))
            elif item.name == "PreprocessorDefinition" and not _PREFIX.fullmatch(name):
                _define(name, item, definitions, diagnostics)
    return _Listed(tuple(listed[:MAX_SOURCES]), tuple(folders), tuple(definitions.items()))


def _define(name: str, item: Element, definitions: dict[str, str], diagnostics: Diagnostics) -> None:
    """Adds a definition.  All files of the FMU get the same definitions, so that one name cannot have two values."""
    value = item.attributes.get("value", "")
    if not is_identifier(name) or not is_definition(value):
        message = f"'{one_line(name)[:40]}={one_line(value)[:40]}' is not the definition of a macro in C"
        diagnostics.error("fmu-definition", item.span, message, hint="export the FMU again")
    elif definitions.setdefault(name, value) != value:
        message = f"'{name}' has two values, '{definitions[name][:40]}' and '{value[:40]}'"
        diagnostics.error(
            "fmu-definition", item.span, message, hint="EPG compiles all files of an FMU with the same macros"
        )


def is_identifier(name: str) -> bool:
    return _IDENTIFIER.fullmatch(name) is not None


def is_definition(value: str) -> bool:
    """True if a macro can have this value: it is on one line and does not begin a comment."""
    return value.isprintable() and not value.endswith("\\") and "/*" not in value


def _inside(name: str) -> str:
    """The name inside the FMU of a file whose ``name`` is relative to ``sources``."""
    return posixpath.normpath(posixpath.join(SOURCES, name.replace("\\", "/")))


class _Reader:
    """Parses files, and finds the files that they include."""

    def __init__(self, files: FmuFiles, include_dirs: Iterable[str], diagnostics: Diagnostics) -> None:
        self.files = files
        self.include_dirs = tuple(include_dirs)
        self.diagnostics = diagnostics
        self.codes: dict[str, Code] = {}
        self.taken: dict[str, list[str]] = {}
        self.told: set[str] = set()

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

    def read(self, name: str) -> bool:
        """Parses a file.  Returns False, after an error, if it is not a text file."""
        if name in self.codes:
            return True
        data = self.files.contents[name]
        if b"\0" in data and not data.startswith((b"\xff\xfe", b"\xfe\xff")):
            place = Span(str(self.files.path(name)))
            message = f"'{posixpath.basename(name)}' is not a text file"
            self.diagnostics.error("model-unreadable", place, message, hint="export the FMU again")
            return False
        self.codes[name] = parse_code(SourceFile(self.files.path(name), decode(data), self.files.archive))
        return True

    def follow(self, units: list[str]) -> None:
        """Parses the files that ``units`` include, directly or through other files."""
        waiting = list(units)
        while waiting:
            name = waiting.pop()
            code = self.codes[name]
            for include in code.includes:
                found = self._find(name, include)
                if found is None and self._is_needed(code, include):
                    found = self._find_below(code, include)
                if found is not None and found not in self.codes and self.read(found):
                    waiting.append(found)

    def _find(self, name: str, include: Include) -> str | None:
        wanted = include.name.replace("\\", "/")
        folders = self.include_dirs if include.system else (posixpath.dirname(name), *self.include_dirs)
        for folder in folders:
            place = posixpath.normpath(posixpath.join(folder, wanted))
            if place in self.files.contents:
                return place
        return None

    def _is_needed(self, code: Code, include: Include) -> bool:
        """True if the FMU must contain the header of ``include``.

        It need not contain headers of C and of FMI, nor headers inside ``#if``, which are often of other systems.
        """
        basename = posixpath.basename(include.name)
        if include.system or basename in C_HEADERS or any(basename in headers for headers in FMI_HEADERS.values()):
            return False
        before = [match[1] for match in _INACTIVE.finditer(code.file.without_comments, 0, include.start)]
        guards = 1 if code.file.path.suffix.lower() == ".h" else 0
        return before.count("if") - before.count("endif") <= guards

    def _find_below(self, code: Code, include: Include) -> str | None:
        """The header in any folder of the FMU, or None after an error.

        Some tools put headers into folders that no file of the FMU names.  The header is taken if there is only one, or
        if all have the same text.
        """
        wanted = f"/{include.name.replace(chr(92), '/')}"
        places = [name for name in self._places.get(posixpath.basename(wanted), ()) if name.endswith(wanted)]
        if len({re.sub(rb"\s+", b" ", self.files.contents[place]) for place in places}) == 1:
            folder = places[0][: -len(wanted)]
            self.include_dirs = (*self.include_dirs, folder)
            self.taken.setdefault(folder, []).append(include.name)
            return places[0]
        span = code.file.span(include.start, include.start + len(include.name))
        name = one_line(include.name)[:80]
        if name not in self.told:
            self.told.add(name)
            message, hint = f"'{name}' is not among the FMU's sources", "export the FMU again, with all its sources"
            if places:
                message = f"'{name}' is in {len(places)} folders of the FMU, and it is not clear which of them is meant"
                hint = f"write the folder in the #include: {', '.join(one_line(place) for place in places[:4])}"
            self.diagnostics.error("fmu-file-missing", span, message, hint=hint)
        return None

    def report_taken(self) -> None:
        """Reports, as notes, the headers that were found in folders that neither the FMU nor an include names."""
        for folder, names in sorted(self.taken.items()):
            message = f"these headers are in '{one_line(folder)}', which the FMU does not list as a folder of headers: "
            shown = ", ".join(one_line(name) for name in sorted(set(names))[:12])
            self.diagnostics.note("model-neighbour", Span(str(self.files.path(folder))), message + shown)
