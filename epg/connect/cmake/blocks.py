# SPDX-License-Identifier: Apache-2.0
"""The commands of a CMakeLists.txt, put together to the blocks that if(), foreach() and others begin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Union

from epg.connect.cmake.syntax import Command, NotCMake

_ENDS = {name: f"end{name}" for name in ("if", "foreach", "while", "function", "macro", "block")}


@dataclass(frozen=True)
class Block:
    """if, foreach, ... with what stands in it; an if has a part for each of its branches."""

    parts: tuple[tuple[Command, Tree], ...]


Tree = tuple[Union[Command, Block], ...]


def commands_of(tree: Tree) -> list[Command]:
    """All commands, wherever they stand."""
    found: list[Command] = []
    for item in tree:
        if isinstance(item, Command):
            found.append(item)
        else:
            found += [command for _, body in item.parts for command in commands_of(body)]
    return found


def tree_of(commands: Sequence[Command]) -> Tree:
    """The commands with blocks put together.  Raises :class:`NotCMake` where one is not closed."""
    tree: list[Command | Block] = []
    stack: list[list[tuple[Command, list[Command | Block]]]] = []
    for command in commands:
        inner = stack[-1][-1][1] if stack else tree
        if command.name in _ENDS:
            stack.append([(command, [])])
        elif command.name in ("elseif", "else") and stack:
            stack[-1].append((command, []))
        elif stack and command.name == _ENDS[stack[-1][0][0].name]:
            block = Block(tuple((opening, tuple(body)) for opening, body in stack.pop()))
            (stack[-1][-1][1] if stack else tree).append(block)
        else:
            inner.append(command)
    if stack:
        opening = stack[-1][0][0]
        raise NotCMake(f"this {opening.name}() has no {_ENDS[opening.name]}()", opening.span)
    return tuple(tree)
