# SPDX-License-Identifier: Apache-2.0
"""The largest stack that a function of an image can use, from its machine code.

The compiler's own figures (-fstack-usage) leave out the C library and the code that the linker adds.  Here, the pushes
of each function and its subtractions from SP are added up, as if all of them were executed, and the calls are followed.
The functions behind a call by a pointer must be named.  A recursion is refused.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from tests.platforms.firmware.builds import PROCESSORS

_FUNCTION = re.compile(r"^([0-9a-f]{8}) <(.+)>:$")
_INSTRUCTION = re.compile(r"^ *([0-9a-f]+):\t(\S+)(?:\t([^@;]*))?")
_TARGET = re.compile(r"([0-9a-f]+) <([^>+]+)(\+0x[0-9a-f]+)?>")
_CONDITIONS = "eq ne cs cc mi pl vs vc hi ls ge lt gt le".split()
_BRANCHES = {"bl", "b", *(f"b{condition}" for condition in _CONDITIONS)}


@dataclass
class Function:
    """``stack``: bytes of its own frame; ``calls``: names; ``by_pointer``: true if it calls functions by pointers."""

    name: str
    stack: int = 0
    calls: set[str] = field(default_factory=set)
    by_pointer: bool = False


@cache
def functions(elf: Path) -> Mapping[str, Function]:
    """The functions of an image.  Static functions of the same name are one, with the larger frame of each."""
    command = [PROCESSORS["m7"].tool("objdump"), "-d", "--no-show-raw-insn", str(elf)]
    found: dict[str, Function] = {}
    present = Function("")
    for line in subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines():
        head = _FUNCTION.match(line)
        if head is not None:
            before = found.get(head[2])
            present = Function(head[2])
            if before is not None:
                present.calls, present.by_pointer = before.calls, before.by_pointer
                present.stack = before.stack  # the sum of both is at least the larger one
            found[head[2]] = present
            continue
        instruction = _INSTRUCTION.match(line)
        if instruction is not None:
            _add(present, instruction[2], (instruction[3] or "").strip())
    return found


def _add(function: Function, name: str, operands: str) -> None:
    name = name.removesuffix(".n").removesuffix(".w")
    if name in ("push", "vpush") or (name in ("stmdb", "vstmdb") and operands.startswith("sp!")):
        function.stack += _registers(operands)
    elif name in ("str", "strd") and (moved := re.search(r"\[sp, #-(\d+)\]!", operands)):
        function.stack += int(moved[1])
    elif name in ("sub", "subw", "subs") and operands.startswith("sp, "):
        size = re.search(r"#(\d+)", operands)
        assert size is not None, f"{function.name} has an array whose size is not constant: {name} {operands}"
        function.stack += int(size[1])
    elif name in _BRANCHES and (target := _TARGET.search(operands)):
        if target[2] != function.name:
            function.calls.add(target[2])
    elif (name == "blx") or (name == "bx" and operands != "lr"):
        function.by_pointer = True


def _registers(operands: str) -> int:
    """Bytes of a list such as {r4, r6-r8, lr} or {d8-d15}."""
    listed = operands[operands.index("{") + 1 : operands.index("}")]
    total = 0
    for part in listed.split(", "):
        first, _, last = part.partition("-")
        size = 8 if first.startswith("d") else 4
        total += size * (int(last[1:]) - int(first[1:]) + 1 if last else 1)
    return total


def bound(
    elf: Path, entry: str, pointers: Mapping[str, Collection[str]], *, without: Collection[str] = ()
) -> tuple[int, Sequence[str]]:
    """The largest stack in bytes, and the calls that lead to it.

    ``pointers``: the functions that a function can call by pointers.  ``without``: functions that do not return, and
    have their own stack.
    """
    known = functions(elf)
    done: dict[str, tuple[int, tuple[str, ...]]] = {}

    def deepest(name: str, path: tuple[str, ...]) -> tuple[int, tuple[str, ...]]:
        assert name not in path, f"a recursion: {' -> '.join((*path, name))}"
        if name in done:
            return done[name]
        function = known[name]
        called = {_plain(call) for call in function.calls} - set(without)
        if function.by_pointer:
            assert name in pointers, f"{name} calls functions by pointers: name them"
            called |= set(pointers[name])
        below = max((deepest(call, (*path, name)) for call in sorted(called)), default=(0, ()))
        done[name] = (function.stack + below[0], (name, *below[1]))
        return done[name]

    return deepest(entry, ())


def _plain(name: str) -> str:
    """The function behind a piece of code that the linker adds for a far call."""
    return name.removeprefix("__").removesuffix("_veneer") if name.endswith("_veneer") else name
