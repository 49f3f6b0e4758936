# SPDX-License-Identifier: Apache-2.0
"""An ELF file: its segments, its symbols, and its instructions that can end the masking of interrupts."""

from __future__ import annotations

import re
import struct
from functools import cached_property
from pathlib import Path

from tests.doubles.toolchain import binutils

_UNMASKS = re.compile(
    r"\s*([0-9a-f]+):\t.*\t(?:cpsie\t|msr\t(?:PRIMASK|BASEPRI|BASEPRI_MAX|FAULTMASK),)", re.IGNORECASE
)


class Image:
    def __init__(self, elf: Path) -> None:
        self.elf = elf

    @cached_property
    def symbols(self) -> dict[str, int]:
        lines = (line.split() for line in binutils("nm", str(self.elf)).splitlines())
        return {words[2]: int(words[0], 16) for words in lines if len(words) == 3}

    @cached_property
    def unmasks(self) -> list[int]:
        """The addresses of ``cpsie`` and of writes of PRIMASK, BASEPRI and FAULTMASK."""
        found = (_UNMASKS.match(line) for line in binutils("objdump", "-d", str(self.elf)).splitlines())
        return [int(match[1], 16) for match in found if match]

    @cached_property
    def segments(self) -> list[tuple[int, bytes]]:
        """The contents of flash before the reset.

        Source: ELF for the Arm architecture, program headers, physical addresses.
        """
        data = self.elf.read_bytes()
        (offset,), (size, count) = struct.unpack_from("<I", data, 28), struct.unpack_from("<HH", data, 42)
        found = []
        for number in range(count):
            kind, start, _, physical, length = struct.unpack_from("<5I", data, offset + number * size)
            if kind == 1 and length > 0:
                found.append((physical, data[start : start + length]))
        return found
