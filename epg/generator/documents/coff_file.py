# SPDX-License-Identifier: Apache-2.0
"""Object files of Windows' compilers, in the format COFF.

Source: Microsoft, "PE Format", sections "COFF File Header", "Section Table" and "COFF Symbol Table".
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import replace

from epg.generator.dataclass import dataclass
from epg.generator.documents.object_file import NotAnObjectFile, ObjectVariable, Section

_X86 = b"\x4c\x01"
MACHINES = (_X86, b"\x64\x86", b"\x64\xaa")
"""The first bytes of an object file: its processor, x86 of 32 or 64 bits or Arm of 64 bits."""

_HEADER, _SECTION, _SYMBOL = struct.Struct("<HHIIIHH"), struct.Struct("<8s6IHHI"), struct.Struct("<8sIhHBB")
_ZERO, _SHARED, _WRITE = 0x80, 0x1000, 0x80000000  # IMAGE_SCN_CNT_UNINITIALIZED_DATA, _LNK_COMDAT, _MEM_WRITE
_EXTERNAL, _STATIC = 2, 3  # storage classes

_NOT_VARIABLES = (".ctors", ".dtors", ".CRT$", ".idata$", ".eh_frame")
"""Writable sections that only the loader and the start-up code write."""

_OF_THREAD = "__emutls_v."
"""What GCC puts before the name of a variable of a thread; Clang puts the variable into the section .tls$."""


@dataclass(frozen=True)
class _Symbol:
    """A symbol, with the bytes of the further entries that belong to it."""

    name: bytes
    value: int
    section: int
    type: int
    storage: int
    more: bytes

    def packed(self) -> bytes:
        values = (self.value, self.section, self.type, self.storage, len(self.more) // _SYMBOL.size)
        return _SYMBOL.pack(self.name, *values) + self.more


class CoffObject:
    """An object file; an :class:`~epg.generator.documents.object_file.ObjectFile`."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._machine, count, time, self._table, self._count, optional, flags = _HEADER.unpack_from(data)
        if not self._table:
            raise NotAnObjectFile("this object file has no symbols")
        self._rest = (time, optional, flags)
        self._headers = [_SECTION.unpack_from(data, _HEADER.size + optional + n * _SECTION.size) for n in range(count)]
        self._strings = data[self._table + self._count * _SYMBOL.size :]
        if any(self._text(header[0]).startswith(".gnu.lto_") for header in self._headers):
            raise NotAnObjectFile("this object file is one of link-time optimisation")
        self._before = "_" if data.startswith(_X86) else ""  # what a compiler puts before each name of C

    def sections(self) -> list[Section]:
        result = []
        for number, (code, _, _, size, *_, flags) in enumerate(self._headers, 1):
            name = self._text(code)
            if flags & _WRITE and size and not name.startswith(_NOT_VARIABLES):
                result.append(Section(number, name, size, bool(flags & _ZERO), bool(flags & _SHARED)))
        return result

    def has_constructors(self) -> bool:
        return any(self._text(header[0]).startswith((".ctors", ".CRT$XC")) for header in self._headers if header[3])

    def variables(self, section: int) -> list[ObjectVariable]:
        """COFF has no sizes of variables: each one extends to the next one, and the gap before that counts."""
        header = self._headers[section - 1]
        places = {
            self._name(symbol): symbol.value
            for symbol in self._symbols()
            if symbol.section == section and symbol.storage in (_EXTERNAL, _STATIC) and not symbol.more
        }
        ends = sorted({*places.values(), header[3]})
        of_thread = self._text(header[0]).startswith(".tls$")
        return [
            ObjectVariable(
                name.removeprefix(_OF_THREAD),
                offset,
                next((end for end in ends if end > offset), offset) - offset,
                separate=of_thread or name.startswith(_OF_THREAD),
            )
            for name, offset in sorted(places.items(), key=lambda item: item[::-1])
        ]

    def common(self) -> list[ObjectVariable]:
        common = (s for s in self._symbols() if s.section == 0 and s.storage == _EXTERNAL and s.value)
        return [ObjectVariable(self._name(symbol), 0, symbol.value) for symbol in common]

    def with_symbols(self, symbols: Mapping[int, str], replaced: Mapping[str, str]) -> bytes:
        strings, entries = self._strings, b""

        def stored(name: str) -> bytes:
            nonlocal strings
            place = struct.pack("<II", 0, len(strings))
            strings += f"{self._before}{name}".encode() + b"\0"
            return place

        for symbol in self._symbols():
            new = replaced.get(self._name(symbol)) if symbol.section == 0 else None
            entries += (replace(symbol, name=stored(new)) if new else symbol).packed()
        for number, name in symbols.items():
            entries += _Symbol(stored(name), 0, number, 0, _EXTERNAL, b"").packed()
        count = len(entries) // _SYMBOL.size
        time, optional, flags = self._rest
        header = _HEADER.pack(self._machine, len(self._headers), time, self._table, count, optional, flags)
        size = struct.pack("<I", len(strings))
        return header + self._data[_HEADER.size : self._table] + entries + size + strings[len(size) :]

    def _symbols(self) -> Iterator[_Symbol]:
        at, end = self._table, self._table + self._count * _SYMBOL.size
        while at < end:
            name, value, section, kind, storage, more = _SYMBOL.unpack_from(self._data, at)
            first, at = at + _SYMBOL.size, at + (1 + more) * _SYMBOL.size
            yield _Symbol(name, value, section, kind, storage, self._data[first:at])

    def _name(self, symbol: _Symbol) -> str:
        """The name of a symbol, as C has it."""
        zeros, place = struct.unpack("<II", symbol.name)
        code = symbol.name.rstrip(b"\0") if zeros else _bytes(self._strings, place)
        return code.decode(errors="replace").removeprefix(self._before)

    def _text(self, code: bytes) -> str:
        """The name of a section, whose long form is the place of a string."""
        name = code.rstrip(b"\0")
        return (_bytes(self._strings, int(name[1:])) if name.startswith(b"/") else name).decode(errors="replace")


def _bytes(strings: bytes, start: int) -> bytes:
    return strings[start : strings.index(b"\0", start)]
