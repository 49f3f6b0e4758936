# SPDX-License-Identifier: Apache-2.0
"""Formulas of parameters: numbers, names of parameters, ``+ - * / ^``, parentheses, ``sqrt()`` and ``pi``.

>>> formula = parse_formula("Supply\\\\voltage * Motor\\\\k^2 / (1 + sqrt(4))")
>>> formula.names, formula.value({"Supply\\\\voltage": 12.0, "Motor\\\\k": 0.5})
(('Supply\\\\voltage', 'Motor\\\\k'), 1.0)
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping, Sequence

from epg.generator.dataclass import dataclass

# A name or a number.  The name of a parameter of 20-sim has parts that are separated by "\"; that of an FMU, or of C,
# also by ".".
_WORD = re.compile(
    r"(?P<name>[A-Za-z_]\w*(?:(?:\\|\.|::)[A-Za-z_]\w*|\[\d+(?:,\d+)*\])*)|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
)
_OPERATORS: Mapping[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: math.pow,
}
LONGEST = 1000


class FormulaError(Exception):
    """A formula that EPG cannot compute, for the reason in its text."""


@dataclass(frozen=True)
class Formula:
    """A formula.  ``names`` are its parameters, in their order."""

    text: str
    names: tuple[str, ...]
    tree: ast.expr

    def value(self, values: Mapping[str, float]) -> float:
        """The value for these values of the parameters.

        :raises FormulaError: it has none, as for a division by zero
        """
        try:
            result = _value(self.tree, [values[name] for name in self.names])
        except (ArithmeticError, ValueError) as error:
            raise FormulaError(f"'{self.text}' has no value: {error}") from None
        if not math.isfinite(result):
            raise FormulaError(f"'{self.text}' has no finite value")
        return result


def parse_formula(text: str) -> Formula:
    """The formula in ``text``.

    :raises FormulaError: it is not a formula
    """
    if len(text) > LONGEST:
        raise FormulaError(f"a formula has at most {LONGEST} characters")
    names: list[str] = []

    def numbered(found: re.Match[str]) -> str:
        name = found["name"]
        if name is None or name in ("sqrt", "pi"):
            return found[0]
        if name not in names:
            names.append(name)
        return f" _{names.index(name)} "

    written = _WORD.sub(numbered, text)
    try:
        tree = ast.parse(written.replace("^", "**").strip(), mode="eval").body
        _check(tree)
    except (SyntaxError, RecursionError, MemoryError, ValueError):
        raise FormulaError(f"'{text}' is not a formula") from None
    return Formula(text, tuple(names), tree)


def _check(node: ast.expr) -> None:
    """Raises FormulaError at a part that a formula cannot have."""
    if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
        _check(node.left)
        _check(node.right)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.UAdd, ast.USub)):
        _check(node.operand)
    elif _root_of(node) is not None:
        _check(_root_of(node) or node)
    elif not (
        (isinstance(node, ast.Constant) and type(node.value) in (int, float))
        or (isinstance(node, ast.Name) and (node.id == "pi" or node.id[1:].isdecimal()))
    ):
        raise SyntaxError


def _root_of(node: ast.expr) -> ast.expr | None:
    """The argument of a square root; None if the node is something else."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "sqrt":
        return node.args[0] if len(node.args) == 1 and not node.keywords else None
    return None


def _value(node: ast.expr, values: Sequence[float]) -> float:
    if isinstance(node, ast.BinOp):
        return _OPERATORS[type(node.op)](_value(node.left, values), _value(node.right, values))
    if isinstance(node, ast.UnaryOp):
        inner = _value(node.operand, values)
        return -inner if isinstance(node.op, ast.USub) else inner
    if isinstance(node, ast.Call):
        return math.sqrt(_value(node.args[0], values))
    if isinstance(node, ast.Name):
        return math.pi if node.id == "pi" else values[int(node.id[1:])]
    assert isinstance(node, ast.Constant) and isinstance(node.value, (int, float))
    return float(node.value)
