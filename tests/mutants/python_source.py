# SPDX-License-Identifier: Apache-2.0
"""Mutants of Python: comparisons, boundaries, and/or/not, arithmetic, arguments, removed statements, returned values.

>>> [mutant.identity.after for mutant in mutants("def f(a, b):\\n    return a < b\\n", "f.py")]
['return None', 'return a <= b']
"""

from __future__ import annotations

import ast
import copy
import functools
import itertools
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from .mutant import Identity, Mutant

OPERATORS: dict[type[ast.AST], Any] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.And: ast.Or, ast.Or: ast.And,
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.FloorDiv, ast.FloorDiv: ast.Mult,
    ast.Mod: ast.FloorDiv, ast.BitOr: ast.BitAnd, ast.BitAnd: ast.BitOr,
}  # fmt: skip
CALLS = {"any": "all", "all": "any", "min": "max", "max": "min"}
LEFT_OUT = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Import, ast.ImportFrom, ast.Assert)
BODIES = ("body", "orelse", "finalbody", "handlers", "cases")
LONGEST = 120
"""A shorter statement is an identity by itself; in a longer one, the identity is an expression around the change."""
NOT_RUN = ("annotation", "returns", "format_spec")


@dataclass(frozen=True)
class Edit:
    """Puts ``new`` in place of a field of ``owner``, or in place of one entry of a list there."""

    owner: ast.AST
    field: str
    index: int | None
    new: object

    @contextmanager
    def applied(self) -> Iterator[None]:
        old = getattr(self.owner, self.field)
        before = old if self.index is None else old[self.index]
        self.put()
        try:
            yield
        finally:
            Edit(self.owner, self.field, self.index, before).put()

    def put(self) -> None:
        if self.index is None:
            setattr(self.owner, self.field, self.new)
        else:
            getattr(self.owner, self.field)[self.index] = self.new


def mutants(source: str, file: str) -> Iterator[Mutant]:
    """All mutants of a module."""
    for number, place in enumerate(_places(_WithoutProse().visit(ast.parse(source)))):
        shown = next((node for node in place.around if len(_one_line(node)) <= LONGEST), place.around[-1])
        before = _one_line(shown)
        with place.edit.applied():
            after = "pass" if isinstance(place.edit.new, ast.Pass) else _one_line(shown)
        if after != before:
            identity = Identity(place.function, before, after)
            lines = range(place.around[0].lineno, _last_line(place.around[0]) + 1)
            yield Mutant(identity, file, lines, place.at_import, functools.partial(_changed, source, number))


def _changed(source: str, number: int) -> ast.Module:
    """The module with one of its changes.  Functions keep their lines."""
    tree = ast.parse(source)
    place = next(itertools.islice(_places(tree), number, None))
    place.edit.put()
    return ast.fix_missing_locations(tree)


@dataclass(frozen=True)
class Place:
    """An edit, the nodes around it from the statement inwards, and the position of the statement."""

    edit: Edit
    around: list[Any]
    function: str
    at_import: bool


def _places(tree: ast.Module) -> Iterator[Place]:
    for removal, statement, function, at_import in _statements(tree, "", True):
        if _removable(statement):
            yield Place(removal, [statement], function, at_import)
        for around, edits in _edits(statement):
            for edit in edits:
                yield Place(edit, around, function, at_import)


def _statements(node: ast.AST, name: str, at_import: bool) -> Iterator[tuple[Edit, ast.stmt, str, bool]]:
    """Each statement with its place, the name of its function, and whether it runs at import."""
    for field in BODIES:
        children = getattr(node, field, [])
        for index, child in enumerate(children if isinstance(children, list) else []):
            inner, importing = name, at_import
            if isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
                inner = f"{name}.{child.name}".removeprefix(".")
                importing = at_import and isinstance(child, ast.ClassDef)
            if isinstance(child, ast.stmt) and not isinstance(child, LEFT_OUT) and not _is_docstring(child):
                yield Edit(node, field, index, ast.Pass()), child, name or "module", at_import
            yield from _statements(child, inner, importing)


def _is_docstring(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _edits(statement: ast.stmt) -> Iterator[tuple[list[ast.AST], list[Edit]]]:
    """The edits of each node, and the nodes around it, from the statement inwards."""
    own = []
    if isinstance(statement, ast.Return) and statement.value and not isinstance(statement.value, ast.Constant):
        own.append(Edit(statement, "value", None, ast.Constant(None)))
    if isinstance(statement, ast.AugAssign) and isinstance(statement.value, ast.Constant):
        own.append(Edit(statement, "op", None, OPERATORS[type(statement.op)]()))
    yield [statement], own
    for around, field, index, node in _expressions([statement]):
        found = [*_variants(node), *_conditions(field, node)]
        yield around, [Edit(around[-1], field, index, new) for new in found]


def _removable(statement: ast.stmt) -> bool:
    if isinstance(statement, ast.Assign):
        return all(isinstance(target, (ast.Attribute, ast.Subscript)) for target in statement.targets)
    return isinstance(statement, (ast.Expr, ast.AugAssign, ast.Raise, ast.Continue, ast.Break, ast.Delete))


def _expressions(around: list[ast.AST]) -> Iterator[tuple[list[ast.AST], str, int | None, ast.AST]]:
    """The expressions of a statement without those in its body: the nodes around, field, index and node."""
    for field, value in ast.iter_fields(around[-1]):
        if field in NOT_RUN:
            continue
        for index, item in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if isinstance(item, ast.AST) and not isinstance(item, (ast.stmt, ast.ExceptHandler, ast.match_case)):
                yield around, field, index, item
                yield from _expressions([*around, item])


def _variants(node: ast.AST) -> Iterator[ast.AST]:
    if isinstance(node, ast.Compare):
        for index, operator in enumerate(node.ops):
            operators = [*node.ops[:index], OPERATORS[type(operator)](), *node.ops[index + 1 :]]
            yield ast.Compare(node.left, operators, node.comparators)
    elif isinstance(node, ast.BoolOp):
        yield ast.BoolOp(OPERATORS[type(node.op)](), node.values)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield node.operand
    elif isinstance(node, ast.BinOp) and type(node.op) in OPERATORS and not any(map(_is_text, (node.left, node.right))):
        yield ast.BinOp(node.left, OPERATORS[type(node.op)](), node.right)
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield ast.Constant(not node.value)
    elif isinstance(node, ast.Constant) and isinstance(node.value, int):
        yield ast.Constant(node.value + 1)
        yield ast.Constant(node.value - 1)
    elif isinstance(node, ast.IfExp):
        yield ast.IfExp(node.test, node.orelse, node.body)
    elif isinstance(node, ast.comprehension):
        for index in range(len(node.ifs)):
            yield ast.comprehension(node.target, node.iter, node.ifs[:index] + node.ifs[index + 1 :], node.is_async)
    elif isinstance(node, ast.Call):
        yield from _calls(node)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def _calls(node: ast.Call) -> Iterator[ast.AST]:
    name = node.func.id if isinstance(node.func, ast.Name) else ""
    if name in CALLS:
        yield ast.Call(ast.Name(CALLS[name], ast.Load()), node.args, node.keywords)
    if name == "sorted":
        yield ast.Call(ast.Name("list", ast.Load()), node.args, [])
    for index, (first, second) in enumerate(itertools.pairwise(node.args)):
        alike = type(first) is type(second) and isinstance(first, (ast.Name, ast.Attribute))
        if alike and "diagnostics" not in (getattr(first, "id", ""), getattr(second, "id", "")):
            yield ast.Call(node.func, [*node.args[:index], second, first, *node.args[index + 2 :]], node.keywords)


def _conditions(field: str, node: ast.AST) -> Iterator[ast.AST]:
    """The opposite of a condition, if no operator above makes it."""
    if field == "test" and isinstance(node, (ast.Name, ast.Attribute, ast.Call, ast.Subscript, ast.NamedExpr)):
        yield ast.UnaryOp(ast.Not(), node)


def _last_line(statement: ast.stmt) -> int:
    """The last line of a statement, or of its head if it has a body."""
    body = getattr(statement, "body", None) or getattr(statement, "cases", None)
    last = statement.end_lineno or statement.lineno
    if not body:
        return last
    first = body[0].pattern.lineno if isinstance(body[0], ast.match_case) else body[0].lineno
    return max(statement.lineno, min(last, first - 1))


class _WithoutProse(ast.NodeTransformer):
    """Replaces strings that contain a space, because they are messages: a mutant stays the same if its words change."""

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        prose = isinstance(node.value, str) and " " in node.value
        return ast.copy_location(ast.Constant("…"), node) if prose else node


def _one_line(node: ast.AST) -> str:
    """A node as text on one line; only the head of a statement that has a body."""
    head = copy.copy(node)
    for field in BODIES:
        if isinstance(getattr(head, field, None), list):
            setattr(head, field, [ast.Pass()] if field == "body" else [])
    return " ".join(ast.unparse(head).removesuffix("\n    pass").split())
