# SPDX-License-Identifier: Apache-2.0
"""Finds the files of an FMU that must be compiled, their definitions, and the headers that they include.

In FMI 2.0, the description lists the files.  FMUs of some tools do not have a list.  Then the C files in ``sources``
that no other file includes are compiled, and those in folders below it that define functions which these need.
FMI 3.0 has ``sources/buildDescription.xml``, with definitions of macros and folders of headers.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Mapping
from dataclasses import field
from functools import cached_property
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.source_file import SourceFile
from epg.generator.documents.text_file import one_line
from epg.generator.documents.xml_file import Element, parse_xml
from epg.generator.importers.fmu.fmu_description import FmuDescription
from epg.generator.importers.fmu.fmu_files import SOURCES, FmuFiles
from epg.generator.importers.fmu.fmu_reader import FMI_HEADERS, Reader, also
from epg.generator.models.c_code import CFile, parse_code
from epg.generator.models.conditions import NO, YES
from epg.generator.models.identifiers import is_identifier
from epg.generator.models.link import Linked
from epg.generator.models.preprocessor import ConditionalSection, condition_at, deciding_macros
from epg.generator.source import Span

BUILD = f"{SOURCES}/buildDescription.xml"
MAX_SOURCES = 2000
_PREFIX = re.compile(r"FMI[23]_(?:OVERRIDE_|ACTUAL_)?FUNCTION_PREFIX")


@dataclass(frozen=True)
class FmuSources:
    """The source files of an FMU.  All names are relative to its top.

    ``units`` are compiled, ``headers`` are the files that they include.  ``include_dirs`` are folders of headers.
    ``definitions`` are macros with their values.  ``own_headers`` are the headers of FMI that the FMU contains.
    ``others`` are files that are included only under conditions that are false.  ``parts`` are the parts of each parsed
    file with the conditions under which they are compiled.  ``hidden`` is None if the function DoStep is compiled.
    Else it has the macros of which each alone can change that, if there are any, and an error was reported.
    """

    units: tuple[str, ...]
    headers: tuple[str, ...]
    include_dirs: tuple[str, ...]
    definitions: tuple[tuple[str, str], ...]
    codes: dict[str, CFile] = field(repr=False)
    own_headers: frozenset[str]
    others: Mapping[str, SourceFile] = field(repr=False)
    parts: Mapping[str, list[ConditionalSection]] = field(repr=False)
    hidden: tuple[str, ...] | None

    @property
    def names(self) -> list[str]:
        """All files that a compiler can read."""
        return sorted({*self.units, *self.headers, *self.others})

    def condition(self, name: str, offset: int) -> str:
        """The condition under which the text at ``offset`` of the file ``name`` is compiled."""
        return condition_at(self.parts.get(name, ()), offset)

    def is_compiled(self, code: CFile, offset: int) -> bool:
        """True if the text at ``offset`` of one of the files is compiled under all conditions."""
        return self.condition(self._by_path[code.file.path], offset) == YES

    @cached_property
    def _by_path(self) -> dict[Path, str]:
        return {code.file.path: name for name, code in self.codes.items()}

    def text(self, name: str) -> str:
        file = self.others[name] if name in self.others else self.codes[name].file
        return file.text

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
    complete: bool = True  # False if the FMU has no list


def find_sources(
    files: FmuFiles,
    description: FmuDescription,
    diagnostics: Diagnostics,
    definitions: tuple[tuple[str, str], ...] = (),
    beside: Path | None = None,
) -> FmuSources | None:
    """The sources of the FMU.  None if it cannot be compiled; the reasons are reported.

    ``definitions`` are macros in addition to those of the FMU, from the model.yaml ``beside`` if there is one.
    """
    before = diagnostics.error_count
    if not _has_sources(files, description, diagnostics):
        return None
    listed = _listed(files, description, diagnostics)
    if listed is None or diagnostics.error_count > before:
        return None
    include_dirs = tuple(dict.fromkeys((SOURCES, *listed.include_dirs)))
    prefix = {f"FMI{description.standard}_FUNCTION_PREFIX": "", "_DEFAULT_SOURCE": "1"}  # as in <name>_names.h
    macros = {**prefix, **dict(listed.definitions), **dict(definitions)}
    reader = Reader(files, include_dirs, macros, diagnostics)
    units = _units(listed, files, reader, diagnostics)
    if diagnostics.error_count > before:
        return None
    own = reader.own(FMI_HEADERS[description.standard])
    if listed.complete:
        reader.go([*units, *own.values()])
    else:
        units = reader.linked(reader.without_included(units), own.values())
    reader.report(beside)
    if diagnostics.error_count > before:
        return None
    main = {2: "fmi2DoStep", 3: "fmi3DoStep"}[description.standard]
    left_out = _left_out(main, reader)
    if left_out is None and not any(main in code.identifiers for code in reader.codes.values()):
        message = f"none of the FMU's sources has the function {main}"
        hint = "export it for co-simulation, with all its sources"
        diagnostics.error("fmu-file-missing", description.span, message, hint=hint)
        return None
    others = {name: reader.file(name) for name in sorted(reader.mentioned() - reader.codes.keys())}
    return FmuSources(
        tuple(dict.fromkeys(units)),
        tuple(sorted(reader.codes.keys() - set(units))),
        reader.include_dirs,
        listed.definitions,
        reader.codes,
        frozenset(own),
        others,
        reader.parts,
        _hidden(main, left_out, reader, beside, diagnostics) if left_out is not None else None,
    )


def _units(listed: _Listed, files: FmuFiles, reader: Reader, diagnostics: Diagnostics) -> list[str]:
    """The C files that the FMU lists.  Reports files that are missing or not in C."""
    units, foreign, missing = [], [], []
    for name, span in listed.files:
        place = _inside(name)
        if place not in files.contents:
            missing.append((one_line(name)[:80], span))
        elif place.lower().endswith(".h"):
            continue  # some tools also list the headers; the files that include them find them
        elif not place.lower().endswith(".c"):
            foreign.append((name, span))
        elif reader.read(place):
            units.append(place)
    if missing:
        message = f"'{missing[0][0]}' is listed as a source, but the FMU does not contain it"
        message += also([name for name, _ in missing])
        hint = "export the FMU again, with its sources"
        diagnostics.error("fmu-file-missing", missing[0][1], message, hint=hint)
    if foreign:
        names = ", ".join(f"'{one_line(name)[:80]}'" for name, _ in foreign[:4])
        more = f" and {len(foreign) - 4} more" if foreign[4:] else ""
        message = (
            f"{names}{more} {'are not C files' if foreign[1:] else 'is not a C file'}: EPG supports only FMUs in C"
        )
        diagnostics.error("fmu-language", foreign[0][1], message, hint="export the FMU as C code")
    return units


def _left_out(main: str, reader: Reader) -> tuple[str, int] | None:
    """The file, and the offset in it, of the function ``main``, if no compiler sees it; None if it is not left out."""
    if any(function.name == main for code in reader.codes.values() for function in code.functions):
        return None
    for name, parts in sorted(reader.parts.items()):
        if main in reader.file(name).text:
            for function in parse_code(reader.file(name)).functions:
                if function.name == main and condition_at(parts, function.start) == NO:
                    return name, function.start
    return None


def _hidden(
    main: str, place: tuple[str, int], reader: Reader, beside: Path | None, diagnostics: Diagnostics
) -> tuple[str, ...]:
    """The macros of which one must be defined, because ``main`` at ``place`` is left out without it.  Reports that."""
    name, offset = place
    start, line = _false(name, offset, reader)
    macros = deciding_macros(line, YES)
    span = reader.file(name).span(start, start + len(line))
    message = f"{main} is not compiled: the condition '{one_line(line)[:80]}' is false"
    diagnostics.error("fmu-not-compiled", span, message, hint=definitions_hint(reader.files, macros, beside))
    return tuple(macros)


def _false(name: str, offset: int, reader: Reader) -> tuple[int, str]:
    """The offset and the line of the outermost condition that leaves out the text at ``offset``."""
    text = reader.file(name).without_comments
    conditions = {text.index("#", p.directive): p.condition for p in reader.parts[name] if p.directive >= 0}
    branch = branch_of_no = None
    for start, line in reader.around(name, offset):
        branch = branch or (start, line)
        if re.match(r"#\s*if", line):  # the other directives of a group are before its branch
            branch_of_no = branch if conditions.get(branch[0]) == NO or branch_of_no is None else branch_of_no
            branch = None
    return branch_of_no or (offset, "")


def definitions_hint(files: FmuFiles, macros: list[str], beside: Path | None) -> str:
    """The hint that a model.yaml must define the first of ``macros``."""
    shown = f"'definitions: {{{macros[0]}: 1}}'" if macros else "the macros that make it true as 'definitions'"
    if beside is not None:
        return f"write {shown} in '{beside.name}'"
    fmu = one_line(files.root.name)
    return f"write {shown} in a model.yaml with 'version: 1' and 'fmu: {fmu}', and name this file as the model"


def _has_sources(files: FmuFiles, description: FmuDescription, diagnostics: Diagnostics) -> bool:
    """True if the FMU has files in C.  Reports an FMU without them."""
    suffixes = {Path(name).suffix for name in files.contents if name.startswith(f"{SOURCES}/")}
    if suffixes & {".c", ".h"}:
        return True
    hint = "export it as a source code FMU, with C code in 'sources'"
    if {suffix.lower() for suffix in suffixes} & {".cpp", ".cc", ".cxx"}:
        message = "the FMU's sources are C++: EPG supports only FMUs in C"
        diagnostics.error("fmu-language", description.span, message, hint=hint)
    else:
        compiled = f": it is compiled for {', '.join(files.binaries[:6])} only" if files.binaries else ""
        diagnostics.error("fmu-no-sources", description.span, f"the FMU has no sources{compiled}", hint=hint)
    return False


def _listed(files: FmuFiles, description: FmuDescription, diagnostics: Diagnostics) -> _Listed | None:
    """The sources that the description or the build description names, or else all C files in ``sources``."""
    if description.standard == 3 and BUILD in files.contents:
        whole = Span(str(files.path(BUILD)))
        root = parse_xml(files.contents[BUILD], whole, diagnostics, hint="export the FMU again", shown=files.archive)
        chosen = _configuration(root, description, diagnostics) if root is not None else None
        return _configured(chosen, diagnostics) if chosen is not None else None
    if description.sources:
        return _Listed(description.sources)
    found = [name for name in sorted(files.contents) if re.fullmatch(rf"{SOURCES}/[^/]+\.[cC]", name)]
    names = tuple((name[len(SOURCES) + 1 :], description.span) for name in found[:MAX_SOURCES])
    return _Listed(names, complete=False)


def _configuration(root: Element, description: FmuDescription, diagnostics: Diagnostics) -> Element | None:
    """The build configuration for this FMU: the first one without a platform, else the first one for Linux.

    Sources for Linux are written for compilers such as EPG's.
    """
    configurations = [child for child in root.children if child.name == "BuildConfiguration"]
    fitting = [child for child in configurations if child.attributes.get("modelIdentifier") == description.identifier]
    wanted = f"'{one_line(description.identifier)[:60]}'"
    if not fitting and len({child.attributes.get("modelIdentifier") for child in configurations}) == 1:
        fitting = configurations  # if an FMU was made from the files of another one, that one's name can be left here
        other = one_line(configurations[0].attributes.get("modelIdentifier", ""))[:60]
        message = f"the build configuration is for '{other}', but the FMU is {wanted}: EPG uses it anyway"
        diagnostics.warning(
            "fmu-other-name", configurations[0].span, message, hint="check that these are the FMU's sources"
        )
    fitting.sort(key=_by_platform)
    if not fitting:
        message = f"there is no build configuration for {wanted}"
        diagnostics.error("fmu-file-missing", root.span, message, hint="export the FMU again, with its sources")
        return None
    if "platform" in fitting[0].attributes:
        _warn_of_platform(fitting, diagnostics)
    return fitting[0]


def _configured(configuration: Element, diagnostics: Diagnostics) -> _Listed:
    """The sources that a build configuration lists.  Reports libraries and languages that EPG does not have."""
    listed: list[tuple[str, Span]] = []
    folders: list[str] = []
    definitions: dict[str, str] = {}
    for part in configuration.children:
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


def _by_platform(configuration: Element) -> int:
    """The rank of a configuration for a platform: 0 for all platforms, 1 for Linux, 2 for others."""
    platform = configuration.attributes.get("platform")
    return 0 if platform is None else 1 if "linux" in platform else 2


def _warn_of_platform(configurations: list[Element], diagnostics: Diagnostics) -> None:
    """Warns that each of the configurations is for a platform.  EPG uses the first one."""
    chosen, *others = configurations
    names = [f"'{one_line(each.attributes.get('platform', ''))[:40]}'" for each in configurations]
    message = f"this build configuration is for {names[0]}, and there is none for all platforms: EPG uses it anyway"
    hint = "check that its sources and definitions are right for the target, too"
    notes = [Note(f"another one, for {name}", each.span) for name, each in zip(names[1:], others, strict=True)]
    diagnostics.warning("fmu-platform", chosen.span, message, hint=hint, notes=notes)


def _define(name: str, item: Element, definitions: dict[str, str], diagnostics: Diagnostics) -> None:
    """Adds a definition.  All files of the FMU get the same definitions, so that one name cannot have two values."""
    value = item.attributes.get("value", "")
    if not is_identifier(name) or not is_definition(value):
        message = f"'{one_line(name)[:40]}={one_line(value)[:40]}' is not the definition of a macro in C"
        diagnostics.error("fmu-definition", item.span, message, hint="export the FMU again")
    elif definitions.setdefault(name, value) != value:
        message = f"'{name}' has two values, '{definitions[name][:40]}' and '{value[:40]}'"
        hint = "EPG compiles all files of an FMU with the same macros"
        diagnostics.error("fmu-definition", item.span, message, hint=hint)


def is_definition(value: str) -> bool:
    """True if a macro can have this value: it is on one line and does not begin a comment."""
    return value.isprintable() and not value.endswith("\\") and "/*" not in value


def _inside(name: str) -> str:
    """The name inside the FMU of a file whose ``name`` is relative to ``sources``."""
    return posixpath.normpath(posixpath.join(SOURCES, name.replace("\\", "/")))
