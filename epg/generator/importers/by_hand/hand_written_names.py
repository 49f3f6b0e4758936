# SPDX-License-Identifier: Apache-2.0
"""Checks that the names in a ``model.yaml`` exist in its sources.

Without this check, the user would see a misspelt name only as an error of the compiler or of the linker.

The check is skipped if the sources can have more names than EPG sees: if an include is not found, or if macros paste
names together.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import field
from functools import cached_property
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.documents.source_file import read_source
from epg.generator.documents.text_file import is_file
from epg.generator.importers.fmu.fmu_reader import C_HEADERS
from epg.generator.models.c_code import CFile, Include, parse_code
from epg.generator.models.declarations import declared_names, end_of_block
from epg.generator.models.folders import source_files
from epg.generator.source import Span

MAX_FILES = 500
_STRUCT = re.compile(r"\b(?:struct|class|union)\b\s{0,80}([A-Za-z_]\w{0,255})?\s{0,80}(:[^;{}()]{0,300})?\{", re.ASCII)
_ATTRIBUTE = re.compile(  # those of GCC and C++, and __packed of Arm's compilers: they name no type and no member
    r"\b__attribute__\s{0,80}\(\((?:[^()]|\([^()]{0,200}\)){0,200}\)\)|\[\[[^\[\]]{0,200}\]\]|\b__packed\b", re.ASCII
)
_ALIAS = re.compile(
    r"\btypedef\s{1,80}(?:struct\s{1,80})?([A-Za-z_]\w{0,255})\s{1,80}([A-Za-z_]\w{0,255})\s{0,80};", re.ASCII
)
_USING = re.compile(r"\busing\s{1,80}([A-Za-z_]\w{0,255})\s{0,80}=\s{0,80}([A-Za-z_]\w{0,255})\s{0,80};", re.ASCII)
_TYPE_NAME = re.compile(
    r"\b(?:struct|class|union|enum)\s{1,80}([A-Za-z_]\w{0,255})|[}\w]\s{0,80}\b([A-Za-z_]\w{0,255})\s{0,80};", re.ASCII
)
_BRACE_OR_SEMICOLON = re.compile(r"[{;]")
_LABEL = re.compile(r"\b(?:public|private|protected)\s{0,80}:(?!:)", re.ASCII)
_BIT_FIELD = re.compile(r"\s{0,80}(?<!:):(?!:)\s{0,80}([^:]{1,200})$")
_NUMBER = re.compile(r"\(?\s{0,80}(0[xX][0-9a-fA-F]{1,4}|[1-9]\d{0,3})[uU]?\s{0,80}\)?", re.ASCII)
_QUALIFIERS = frozenset(("const", "volatile", "mutable", "std"))
_INTEGER_WORDS = frozenset(("signed", "unsigned", "int", "short", "long", "char"))
_FIXED = re.compile(r"(u?)int(?:_least|_fast)?(8|16|32|64)_t", re.ASCII)
_MEMBER = re.compile(r"([A-Za-z_]\w{0,255})\s{0,80}(?:\[[^\]]{0,200}\]\s{0,80}){0,8}$", re.ASCII)


@dataclass(frozen=True)
class Declaration:
    """The words of a member's type, and the text of its width if it is a bit-field."""

    type: tuple[str, ...]
    width: str = ""


@dataclass(frozen=True)
class Struct:
    """A struct or class.  ``members`` maps the name of a member to its struct, or to None if that is not known."""

    members: dict[str, Struct | None] = field(default_factory=dict)
    open: bool = False  # True if there can be more members, for example those of a base class
    declarations: dict[str, Declaration] = field(default_factory=dict)


class Names:
    """The names that the sources of a controller written by hand declare and define.

    ``certain`` is False if there can be more names than were found; then nothing must be reported as missing.
    """

    def __init__(
        self, folder: Path, header: str, directories: Sequence[Path], sources: Sequence[Path], cpp: bool
    ) -> None:
        self.folder = folder
        self.header = header
        self.cpp = cpp
        self.certain = True
        self._directories = [*directories, *(source.parent for source in sources)]
        self._codes: dict[Path, CFile] = {}
        place = next((d / header for d in directories if is_file(d / header)), None)
        self.headers = self._read([place] if place else [])
        self.units = self._read(sources)

    def _read(self, paths: Iterable[Path]) -> list[CFile]:
        """Parses ``paths`` and all files that they include."""
        files: dict[Path, CFile] = {}
        waiting = list(paths)
        while waiting:
            path = waiting.pop(0)
            if path in files:
                continue
            if path not in self._codes:
                file = read_source(path, Diagnostics()) if len(self._codes) < MAX_FILES else None
                if file is None:
                    self.certain = False
                    continue
                self._codes[path] = parse_code(file)
                self.certain &= "##" not in file.text
            files[path] = self._codes[path]
            for include in files[path].includes:
                other = self._find(include, path)
                if other is not None:
                    waiting.append(other)
                elif not include.system or not (include.name in C_HEADERS or "." not in include.name):
                    self.certain = False
        return list(files.values())

    def _find(self, include: Include, path: Path) -> Path | None:
        folders = self._directories if include.system else [path.parent, *self._directories]
        return next((folder / include.name for folder in folders if is_file(folder / include.name)), None)

    @property
    def seen(self) -> list[CFile]:
        """The files whose names generated code can use.  Generated code includes C++ sources, but not C sources."""
        return [*self.headers, *self.units] if self.cpp else self.headers

    @property
    def all(self) -> list[CFile]:
        return list(self._codes.values())

    @property
    def files(self) -> list[Path]:
        """All files that were read."""
        return list(self._codes)

    def check_function(self, name: str, span: Span, diagnostics: Diagnostics) -> None:
        """Reports a function that the header does not declare, or that no source defines."""
        last = name.rpartition("::")[2]
        if self._is_known(last):
            if last not in _functions(self.all) and last not in self._macros and not self._is_in_body(last):
                self._undefined(last, span, diagnostics)
            return
        functions = {name for code in self.seen for name in declared_names(code)}
        functions |= _functions(self.seen)
        where = f"'{self.header}'" if not self.cpp else f"'{self.header}' and the sources"
        message = f"there is no function '{name}' in {where}"
        notes = self._defined_in(last) if diagnostics.wants_hints else []
        hint = "declare it in the header" if notes else did_you_mean(last, functions, "functions there")
        diagnostics.error("wrong-value", span, message, hint=hint, notes=notes)

    def check_type(self, name: str, span: Span, diagnostics: Diagnostics) -> None:
        """Reports a type that does not exist in the header."""
        last = name.rpartition("::")[2].removeprefix("struct ")
        if not self._is_known(last):
            types = {a or b for code in self.seen for a, b in _TYPE_NAME.findall(code.file.code)}
            hint = did_you_mean(last, types - {""} or {*self.structs}, "types there")
            diagnostics.error("wrong-value", span, f"there is no type '{name}' in '{self.header}'", hint=hint)

    def check_member(self, type: str, member: str, span: Span, diagnostics: Diagnostics) -> None:
        """Reports a ``member``, such as ``gains.kp[2]``, that the struct ``type`` does not have."""
        struct = self.structs.get(type.rpartition("::")[2].removeprefix("struct "))
        for part in member.split("."):
            if struct is None or struct.open:
                return
            name = part.partition("[")[0]
            if name not in struct.members:
                hint = did_you_mean(name, struct.members, "members") if diagnostics.wants_hints else ""
                diagnostics.error("wrong-value", span, f"'{type}' has no member '{member}'", hint=hint)
                return
            struct = struct.members[name]

    def declaration(self, type: str, member: str) -> Declaration | None:
        """The declaration of a ``member`` of the struct ``type``; None if it is not known."""
        struct = self.structs.get(type.rpartition("::")[2].removeprefix("struct "))
        *parts, last = (part.partition("[")[0] for part in member.split("."))
        for part in parts:
            struct = struct.members.get(part) if struct is not None else None
        return struct.declarations.get(last) if struct is not None else None

    def number(self, text: str) -> int | None:
        """The value of a number, or of a macro that is a number; None if it is not one."""
        texts = {macro.value.strip() for code in self.all for macro in code.macros if macro.name == text} or {text}
        match = _NUMBER.fullmatch(texts.pop()) if len(texts) == 1 else None
        return int(match[1], 0 if match[1].lower().startswith("0x") else 10) if match else None

    def check_variable(self, member: str, span: Span, diagnostics: Diagnostics) -> None:
        """Reports a ``member``, such as ``gains.kp``, whose global variable is not declared or not defined."""
        name = re.split(r"[.\[]", member)[0]
        if self._is_known(name):
            if name not in self._variables and name not in self._macros:
                self._undefined(name, span, diagnostics)
            return
        message = f"there is no variable '{name}' in '{self.header}'"
        hint = "'member' must name the variable, and 'instance' the type that has it"
        if diagnostics.wants_hints:
            declared = {other for code in self.seen for other in declared_names(code)}
            known = self._variables & (declared | {v.name for code in self.seen for v in code.variables})
            hint = did_you_mean(name, known, "variables there") or hint
        diagnostics.error("wrong-value", span, message, hint=hint)

    def _is_known(self, name: str) -> bool:
        return any(name in code.identifiers for code in self.seen)

    @cached_property
    def _variables(self) -> set[str]:
        return {variable.name for code in self.all for variable in code.variables}

    def _is_in_body(self, name: str) -> bool:
        """True if a class contains a function called ``name`` with its body."""
        pattern = re.compile(rf"\b{re.escape(name)}\s{{0,80}}\([^();{{}}]{{0,1000}}\)[^;{{}}()]{{0,80}}\{{")
        return any(pattern.search(code.file.code) for code in self.all)

    @cached_property
    def _macros(self) -> set[str]:
        return {macro.name for code in self.all for macro in code.macros}

    @cached_property
    def _members_of_macros(self) -> set[str]:
        """The macros that can declare members of a struct."""
        return {m.name for code in self.all for m in code.macros if m.parameters or ";" in m.value}

    def _undefined(self, name: str, span: Span, diagnostics: Diagnostics) -> None:
        notes = self._defined_in(name) if diagnostics.wants_hints else []
        hint = "add that file to 'sources'" if notes else "add the file that defines it to 'sources'"
        message = f"'{name}' is declared in '{self.header}', but none of the sources defines it"
        diagnostics.error("model-incomplete", span, message, hint=hint, notes=notes)

    def _defined_in(self, name: str) -> list[Note]:
        """Notes of the files in the folder that define a function or variable, also of files that are not sources."""
        notes = []
        for path in source_files(self.folder, (".c", ".cpp", ".cc", ".cxx"))[:MAX_FILES]:
            file = read_source(path, Diagnostics())
            if file is None or name not in file.text:
                continue
            span = parse_code(file).definition(name)
            notes += [Note("it is defined here", span)] if span else []
        return notes[:3]

    @cached_property
    def structs(self) -> dict[str, Struct]:
        """The structs and classes by their names."""
        by_name: dict[str, Struct] = {}
        for code in self.seen:
            text = _ATTRIBUTE.sub(" ", code.file.code)
            for name, body, behind, derived in _structs(text):
                struct = _struct(body, derived or not self._members_of_macros.isdisjoint(re.findall(r"\w+", body)))
                alias = re.match(r"\s{0,80}([A-Za-z_]\w{0,255})\s{0,80};", text[behind : behind + 500])
                for key in (name, alias[1] if alias else ""):
                    if key:
                        by_name.setdefault(key, struct)
        for code in self.seen:
            pairs = [(m[2], m[1]) for m in _ALIAS.finditer(code.file.code)]
            pairs += [(m[1], m[2]) for m in _USING.finditer(code.file.code)]
            for new, old in pairs:
                if old in by_name:
                    by_name.setdefault(new, by_name[old])
        return by_name


def _functions(codes: Iterable[CFile]) -> set[str]:
    """The functions with a body in ``codes``."""
    return {function.name for code in codes for function in code.functions}


def _structs(text: str) -> Iterator[tuple[str, str, int, bool]]:
    """Each struct that is not inside another one: its name, its body, the offset behind it, True if it has a base."""
    at = 0
    for match in _STRUCT.finditer(text):
        if match.start() >= at:
            at = end_of_block(text, match.end())
            yield match[1] or "", text[match.end() : at], at + 1, match[2] is not None


def _struct(body: str, derived: bool, depth: int = 0) -> Struct:
    """The members in ``body``, including members whose type is a struct that is declared inside ``body``."""
    if depth > 8 or "#" in body or re.search(r"\b(?:template|using|union)\b", body):
        return Struct(open=True)
    members: dict[str, Struct | None] = {}
    declarations: dict[str, Declaration] = {}
    start = position = 0
    while (match := _BRACE_OR_SEMICOLON.search(body, position)) is not None:
        if match[0] == ";":
            _declare(_LABEL.sub("", body[start : match.start()]), members, declarations)
            start = position = match.end()
            continue
        end = end_of_block(body, match.end())
        head = body[start : match.start()]
        if re.search(r"\b(?:struct|class)\b", head) and "(" not in head:
            name = re.match(r"\s{0,80}([A-Za-z_]\w{0,255})\s{0,80};", body[end + 1 : end + 500])
            if name:
                members[name[1]] = _struct(body[match.end() : end], False, depth + 1)
            elif not re.match(r"\s{0,80}\w", head.strip()[6:]):
                return Struct(open=True)  # an anonymous struct, whose members count as those of the outer struct
            start = position = end + 1
        elif "(" in head:  # a function with a body
            start = position = end + 1
        else:
            position = end + 1  # a member with an initial value
            named = _MEMBER.search(head.partition("=")[0].strip()[-300:])
            if named:
                members.setdefault(named[1], None)
    return Struct(members, derived, declarations)


def _declare(text: str, members: dict[str, Struct | None], declarations: dict[str, Declaration]) -> None:
    """Adds the members in ``text``, such as ``unsigned int mode : 3, level : 2``."""
    type: tuple[str, ...] = ()
    for part in re.sub(r"<[^<>;]{0,200}>", "", text).split(","):
        written = part.partition("=")[0].strip()[-300:]
        field = _BIT_FIELD.search(written)
        if field and re.search(r"\w\s+\w", field[1]):
            field = None  # a label, such as those of Qt
        named = _MEMBER.search(written[: field.start()] if field else written)
        if named is None:
            continue
        before = written[: named.start()].rstrip()
        type = type or tuple(re.findall(r"\w+", before))
        if field and not type:
            continue  # bits without a name
        members.setdefault(named[1], None)
        if not before.endswith(("*", "&")):
            declarations.setdefault(named[1], Declaration(type, field[1] if field else ""))


def integer_range(declaration: Declaration, bits: int | None) -> tuple[int, int] | None:
    """The range of an integer type: of a bit-field with ``bits``, else of a type with a fixed width.

    None if the declaration does not tell the range.

    >>> integer_range(Declaration(("const", "unsigned", "int"), "3"), 3), integer_range(Declaration(("int8_t",)), None)
    ((0, 7), (-128, 127))
    """
    words = {word for word in declaration.type if word not in _QUALIFIERS}
    if words in ({"_Bool"}, {"bool"}):
        return 0, 1
    unsigned = "unsigned" in words
    fixed = _FIXED.fullmatch(next(iter(words))) if len(words) == 1 else None
    if fixed is not None:
        unsigned, bits = bool(fixed[1]), bits or int(fixed[2])
    elif bits is None or not words or words == {"char"} or not words <= _INTEGER_WORDS:
        return None
    return (0, 2**bits - 1) if unsigned else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def is_integer(declaration: Declaration) -> bool:
    """True if the words of the type are those of an integer."""
    return integer_range(declaration, 1) is not None or "char" in declaration.type
