# SPDX-License-Identifier: Apache-2.0
"""The code and data that code can reach, from an ELF file: calls, branches, and addresses in literal pools.

An address in a literal pool counts as a possible call or read.  The graph therefore has more edges than any run, and
misses none as long as the code does not compute addresses.
"""

from __future__ import annotations

import re
import struct
from bisect import bisect_right
from dataclasses import dataclass
from pathlib import Path

from tests.doubles.toolchain import binutils

_BRANCH = re.compile(r"\s*[0-9a-f]+:\s+(?:b|cb)[a-z.]*\s+(?:r\d+, )?([0-9a-f]+) <")
_LITERAL = re.compile(r"\s*[0-9a-f]+:\s+\.word\s+0x([0-9a-f]{8})")
FLASH = range(0x10000000, 0x20000000)
RAM = range(0x20000000, 0x30000000)


@dataclass(frozen=True)
class Symbol:
    name: str
    address: int
    size: int
    is_function: bool


class Image:
    """The symbols, code and data of an ELF file for Cortex-M."""

    def __init__(self, elf: Path) -> None:
        self.symbols = sorted(_symbols(elf), key=lambda symbol: symbol.address)
        self._addresses = [symbol.address for symbol in self.symbols]
        self._memory = _memory(elf)
        self._edges = _edges(elf)

    def named(self, name: str) -> Symbol:
        return next(symbol for symbol in self.symbols if symbol.name == name)

    def at(self, address: int) -> Symbol | None:
        """The symbol that contains ``address``."""
        index = bisect_right(self._addresses, address) - 1
        while index >= 0 and self._addresses[index] > address - 0x10000:
            symbol = self.symbols[index]
            if symbol.address <= address < symbol.address + max(symbol.size, 2):
                return symbol
            index -= 1
        return None

    def reachable(self, *roots: str, stop: frozenset[str] = frozenset()) -> dict[Symbol, tuple[str, ...]]:
        """All symbols that code of ``roots`` can reach, each with its path; the search ends at those in ``stop``."""
        ways: dict[Symbol, tuple[str, ...]] = {}
        waiting = [(self.named(root), (root,)) for root in roots]
        while waiting:
            symbol, way = waiting.pop()
            if symbol in ways:
                continue
            ways[symbol] = way
            if symbol.name in stop:
                continue
            for address in self._references(symbol):
                found = self.at(address & ~1)
                if found is not None and found not in ways:
                    waiting.append((found, (*way, found.name)))
        return ways

    def _references(self, symbol: Symbol) -> list[int]:
        words = self._edges.get(symbol.address, []) if symbol.is_function else self._words(symbol)
        return [word for word in words if word in RAM or word in FLASH]

    def _words(self, symbol: Symbol) -> list[int]:
        """All aligned words of a table."""
        for start, data in self._memory:
            if start <= symbol.address < start + len(data):
                first = (symbol.address + 3) // 4 * 4 - start
                end = symbol.address + symbol.size - start
                part = data[first : max(first, end)]
                return list(struct.unpack(f"<{len(part) // 4}I", part[: len(part) // 4 * 4]))
        return []


def _symbols(elf: Path) -> list[Symbol]:
    found = []
    for line in binutils("readelf", "-sW", str(elf)).splitlines():
        fields = line.split()
        if len(fields) >= 8 and fields[3] in ("FUNC", "OBJECT", "NOTYPE") and re.fullmatch(r"[0-9a-f]{8}", fields[1]):
            name, address = fields[7], int(fields[1], 16)
            if not name.startswith("$") and fields[6] != "ABS":
                is_function = fields[3] == "FUNC"
                size = int(fields[2], 0)
                found.append(Symbol(name, address & ~1 if is_function else address, size, is_function))
    return found


def _memory(elf: Path) -> list[tuple[int, bytes]]:
    """Loaded segments by the address at which they are used."""
    data = elf.read_bytes()
    offset, size, count = struct.unpack_from("<I", data, 28)[0], *struct.unpack_from("<HH", data, 42)
    segments = []
    for index in range(count):
        kind, start, address, _, length = struct.unpack_from("<5I", data, offset + index * size)
        if kind == 1 and length:
            segments.append((address, data[start : start + length]))
    return segments


def _edges(elf: Path) -> dict[int, list[int]]:
    """Each function with the targets of its calls and branches, and the words of its literal pools."""
    edges: dict[int, list[int]] = {}
    current = 0
    for line in binutils("objdump", "-d", "--no-show-raw-insn", str(elf)).splitlines():
        head = re.match(r"^([0-9a-f]{8}) <", line)
        if head:
            current = int(head[1], 16)
            continue
        reference = _BRANCH.match(line) or _LITERAL.match(line)
        if reference:
            edges.setdefault(current, []).append(int(reference[1], 16))
    return edges
