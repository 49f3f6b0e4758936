# SPDX-License-Identifier: Apache-2.0
"""Expressions in 20-sim's equation language and their form in C.

>>> to_c("if a\\\\b > 1 then -a\\\\b else c * 2 end", {"a\\\\b": "xx_V[0]", "c": "xx_P[0]"}.__getitem__)
'((xx_V[0] > 1.0) ?\\n\\t\\t/* -a\\\\b */\\n\\t\\t-xx_V[0]\\n\\t:\\n\\t\\t/* c * 2 */\\n\\t\\txx_P[0] * 2.0\\n\\t)'

Known: ``if then else end``, ``or``, ``and``, ``not``, comparisons, ``+ - * /``, unary minus, ``abs``, ``sin``,
``cos``.  Names may be hierarchical (``Pan\\PID\\kp``).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

_TOKEN = re.compile(r"\s*(?:(\d+\.?\d*(?:[eE][-+]?\d+)?)|([A-Za-z_][\w\\]*)|(<=|>=|<>|==|[-+*/()<>]))")
_FUNCTIONS = {"abs": "XXAbsolute", "sin": "sin", "cos": "cos"}
_OPERATORS = {"or": "||", "and": "&&", "<>": "!="}
_LEVELS: tuple[tuple[str, ...], ...] = (("or",), ("and",), ("<", ">", "<=", ">=", "==", "<>"), ("+", "-"), ("*", "/"))
_CONDITIONS = {operator for level in _LEVELS[:3] for operator in level}


@dataclass(frozen=True)
class Expression:
    """A node of the tree: ``kind`` is an operator, a function, ``number``, ``name``, ``group``, ``not`` or ``if``."""

    kind: str
    text: str
    parts: tuple[Expression, ...] = ()


def to_c(source: str, symbol: Callable[[str], str]) -> str:
    """The C form of an expression; ``symbol`` returns the array element for a name."""
    return _c(parse(source), symbol, 1)


def names(source: str) -> set[str]:
    """The names in an expression."""
    found: set[str] = set()

    def visit(expression: Expression) -> None:
        if expression.kind == "name":
            found.add(expression.text)
        for part in expression.parts:
            visit(part)

    visit(parse(source))
    return found


def functions(source: str) -> set[str]:
    """The functions of 20-sim's language that an expression calls."""
    return {name for name in _FUNCTIONS if re.search(rf"(?<![\w\\]){name}\s*\(", source)}


def parse(source: str) -> Expression:
    """The tree of an expression.  Raises ValueError for text that is not an expression."""
    tokens: list[str] = []
    position = 0
    while source[position:].strip():
        match = _TOKEN.match(source, position)
        if not match:
            raise ValueError(f"not understood: {source[position:]!r}")
        tokens.append(match[0].strip())
        position = match.end()
    expression, rest = _parse(tokens, 0)
    if rest:
        raise ValueError(f"not understood: {' '.join(rest)!r}")
    return expression


def _parse(tokens: list[str], level: int) -> tuple[Expression, list[str]]:
    if level == len(_LEVELS):
        return _operand(tokens)
    left, rest = _parse(tokens, level + 1)
    while rest and rest[0] in _LEVELS[level]:
        operator = rest[0]
        right, rest = _parse(rest[1:], level + 1)
        left = Expression(operator, f"{left.text} {operator} {right.text}", (left, right))
    return left, rest


def _operand(tokens: list[str]) -> tuple[Expression, list[str]]:
    if not tokens:
        raise ValueError("the expression ends too early")
    head, rest = tokens[0], tokens[1:]
    if head == "if":
        condition, rest = _parse(rest, 0)
        yes, rest = _parse(_after("then", rest), 0)
        no, rest = _parse(_after("else", rest), 0)
        rest = _after("end", rest)
        return Expression("if", f"(if {condition.text} then {yes.text} else {no.text} end)", (condition, yes, no)), rest
    if head in ("-", "not"):
        operand, rest = _operand(rest)
        if head == "-":
            return Expression("minus", f"-{operand.text}", (operand,)), rest
        return Expression("not", f"not {operand.text}", (operand,)), rest
    if head == "(":
        inner, rest = _parse(rest, 0)
        if inner.kind == "if":  # this has its own parentheses
            return inner, _after(")", rest)
        return Expression("group", f"({inner.text})", (inner,)), _after(")", rest)
    if head in _FUNCTIONS:
        inner, rest = _parse(_after("(", rest), 0)
        return Expression(head, f"{head} ({inner.text})", (inner,)), _after(")", rest)
    if head[0].isdigit():
        return Expression("number", head), rest
    if head[0].isalpha() or head[0] == "_":
        return Expression("name", head), rest
    raise ValueError(f"not understood: {head!r}")


def _after(wanted: str, tokens: list[str]) -> list[str]:
    if not tokens or tokens[0] != wanted:
        raise ValueError(f"'{wanted}' expected before {' '.join(tokens)!r}")
    return tokens[1:]


def _c(expression: Expression, symbol: Callable[[str], str], depth: int) -> str:
    parts = expression.parts
    if expression.kind == "number":
        return expression.text if re.search(r"[.eE]", expression.text) else f"{expression.text}.0"
    if expression.kind == "name":
        return symbol(expression.text)
    if expression.kind == "if":
        tabs = "\t" * (depth + 1)
        yes, no = (f"{tabs}/* {part.text} */\n{tabs}{_c(part, symbol, depth + 1)}\n" for part in parts[1:])
        outer = "\t" * depth
        condition = _c(parts[0], symbol, depth)
        if parts[0].kind not in _CONDITIONS:
            condition = f"({condition})"
        return f"({condition} ?\n{yes}{outer}:\n{no}{outer})"
    inner = [_c(part, symbol, depth) for part in parts]
    if expression.kind in ("minus", "not"):
        return ("-" if expression.kind == "minus" else "!") + inner[0]
    if expression.kind == "group":
        return f"({inner[0]})"
    if expression.kind in _FUNCTIONS:
        return f"{_FUNCTIONS[expression.kind]} ({inner[0]})"
    operator = _OPERATORS.get(expression.kind, expression.kind)
    if expression.kind in _CONDITIONS:
        return f"({inner[0]} {operator} {inner[1]})"
    return f"{inner[0]} {operator} {inner[1]}"
