# SPDX-License-Identifier: Apache-2.0
"""Files of the format ELF: object files, and the memory of programs."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

from epg.generator.dataclass import dataclass
from epg.generator.documents.object_file import NotAnObjectFile, ObjectVariable, Section

_PROGBITS, _SYMTAB, _NOBITS, _INIT_ARRAY, _SYMTAB_SHNDX = 1, 2, 8, 14, 18
_WRITE, _ALLOC, _GROUP = 0x1, 0x2, 0x200
_UNDEFINED, _COMMON = 0, 0xFFF2
_OBJECT, _OF_COMMON, _OF_THREAD = 1, 5, 6
_GLOBAL, _HIDDEN = 1, 2

_NOT_VARIABLES = (".data.rel.ro", ".ctors", ".dtors", ".init_array", ".fini_array", ".eh_frame", ".tm_clone_table")
"""Writable sections that only the loader and the start-up code write."""


@dataclass(frozen=True)
class _Header:
    """The header of a section."""

    name: int
    type: int
    flags: int
    address: int
    offset: int
    size: int
    link: int
    info: int
    align: int
    entry: int


@dataclass(frozen=True)
class _Symbol:
    name: int
    value: int
    size: int
    info: int
    other: int
    section: int


class _Elf:
    """A file of the format ELF, with the headers of its sections."""

    def __init__(self, data: bytes) -> None:
        if data[:4] != b"\x7fELF":
            raise NotAnObjectFile("this file has neither the format ELF nor COFF")
        self.data = data
        self._order = "<" if data[5] == 1 else ">"
        self._wide = data[4] == 2

    @cached_property
    def headers(self) -> list[_Header]:
        count = self._unpack("H", 60 if self._wide else 48)[0]
        return [_Header(*self._unpack(self._header_form, self._place(number))) for number in range(count)]

    @cached_property
    def _table(self) -> int:
        return self._unpack("Q", 40)[0] if self._wide else self._unpack("I", 32)[0]

    @property
    def _header_form(self) -> str:
        return "IIQQQQIIQQ" if self._wide else "IIIIIIIIII"

    def _place(self, number: int) -> int:
        return self._table + number * struct.calcsize("<" + self._header_form)

    def _unpack(self, form: str, offset: int) -> Sequence[int]:
        return struct.unpack_from(self._order + form, self.data, offset)


class ElfObject(_Elf):
    """An object file; an :class:`~epg.generator.documents.object_file.ObjectFile`."""

    def __init__(self, data: bytes) -> None:
        super().__init__(data)
        if self._unpack("H", 16)[0] != 1:
            raise NotAnObjectFile("this file is a program or a library")
        if any(header.type == _SYMTAB_SHNDX for header in self.headers) or not self.headers:
            raise NotAnObjectFile("this object file has too many sections")
        self._names = self._content(self._unpack("H", 62 if self._wide else 50)[0])
        if any(_text(self._names, header.name).startswith(".gnu.lto_") for header in self.headers):
            raise NotAnObjectFile("this object file is one of link-time optimisation")
        self._symbol_table = next((n for n, header in enumerate(self.headers) if header.type == _SYMTAB), 0)
        if self._symbol_table == 0:
            raise NotAnObjectFile("this object file has no symbols")

    def sections(self) -> list[Section]:
        result = []
        for number, header in enumerate(self.headers):
            name = _text(self._names, header.name)
            writable = header.flags & _WRITE and header.flags & _ALLOC and header.type in (_PROGBITS, _NOBITS)
            if writable and header.size and not name.startswith(_NOT_VARIABLES):
                zero = header.type == _NOBITS and name.split(".")[1:2] in (["bss"], ["sbss"], ["tbss"])
                result.append(Section(number, name, header.size, zero, shared=bool(header.flags & _GROUP)))
        return result

    def has_constructors(self) -> bool:
        names = (_text(self._names, header.name) for header in self.headers if header.size)
        return any(name.startswith((".init_array", ".ctors")) for name in names)

    def variables(self, section: int) -> list[ObjectVariable]:
        names = self._strings
        types = (_OBJECT, _OF_COMMON, _OF_THREAD)
        found = (symbol for symbol in self._symbols() if symbol.section == section and symbol.info & 0xF in types)
        variables = (
            ObjectVariable(_text(names, s.name), s.value, s.size, separate=s.info & 0xF == _OF_THREAD) for s in found
        )
        return sorted(variables, key=lambda variable: (variable.offset, variable.size))

    def common(self) -> list[ObjectVariable]:
        return self.variables(_COMMON)

    def with_symbols(self, symbols: Mapping[int, str], replaced: Mapping[str, str]) -> bytes:
        table = self.headers[self._symbol_table]
        strings, entries = self._strings, b""
        for symbol in self._symbols():
            new = replaced.get(_text(self._strings, symbol.name), "") if symbol.section == _UNDEFINED else ""
            entries += self._packed_symbol(replace(symbol, name=len(strings)) if new else symbol)
            strings += new.encode() + b"\0" if new else b""
        for number, name in symbols.items():
            info = _GLOBAL << 4 | _OBJECT
            symbol = _Symbol(len(strings), 0, self.headers[number].size, info, _HIDDEN, number)
            strings += name.encode() + b"\0"
            entries += self._packed_symbol(symbol)
        data = self.data + bytes(-len(self.data) % 8)
        places = {self._symbol_table: entries, table.link: strings}
        for number, content in places.items():
            data = self._replaced(data, number, content)
        return data

    def _replaced(self, data: bytes, number: int, content: bytes) -> bytes:
        """``data`` with ``content`` at its end, as the content of section ``number``."""
        header = self.headers[number]
        values = (header.name, header.type, header.flags, header.address, len(data), len(content))
        packed = struct.pack(self._order + self._header_form, *values, *_rest(header))
        place = self._place(number)
        data = data[:place] + packed + data[place + len(packed) :] + content
        return data + bytes(-len(data) % 8)

    def _content(self, number: int) -> bytes:
        header = self.headers[number]
        return self.data[header.offset : header.offset + header.size]

    @property
    def _strings(self) -> bytes:
        return self._content(self.headers[self._symbol_table].link)

    def _symbols(self) -> Iterator[_Symbol]:
        """All symbols.  The two formats have the same members in another order."""
        content = self._content(self._symbol_table)
        if self._wide:
            for name, info, other, section, value, size in struct.iter_unpack(self._order + "IBBHQQ", content):
                yield _Symbol(name, value, size, info, other, section)
        else:
            for values in struct.iter_unpack(self._order + "IIIBBH", content):
                yield _Symbol(*values)

    def _packed_symbol(self, s: _Symbol) -> bytes:
        if self._wide:
            return struct.pack(self._order + "IBBHQQ", s.name, s.info, s.other, s.section, s.value, s.size)
        return struct.pack(self._order + "IIIBBH", s.name, s.value, s.size, s.info, s.other, s.section)


def program_memory(data: bytes) -> tuple[int, int]:
    """The bytes of flash and of RAM that a linked program occupies.  The initial values of variables need both."""
    flash = ram = 0
    for header in _Elf(data).headers:
        if header.flags & _ALLOC:
            flash += header.size if header.type != _NOBITS else 0
            ram += header.size if header.flags & _WRITE else 0
    return flash, ram


def _rest(header: _Header) -> tuple[int, int, int, int]:
    return header.link, header.info, header.align, header.entry


def _text(strings: bytes, start: int) -> str:
    return strings[start : strings.index(b"\0", start)].decode(errors="replace")
