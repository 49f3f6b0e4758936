# SPDX-License-Identifier: Apache-2.0
"""The section ``motors`` of a plant's bindings: what ``epg identify`` measures, as formulas of the plant's parameters.

The formulas say how fast the plant turns and how soon.  ``epg identify`` solves them for the parameters in ``change``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from epg.generator.check.formulas import Formula, FormulaError, parse_formula
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span, YamlNode

QUANTITIES = ("gain", "time_constant", "friction", "dead_zone")
"""The quantities of a motor that a plant can have.  A motor has at most one of the last two."""


@dataclass(frozen=True)
class Motor:
    """A motor of a plant.

    ``duty`` is the plant's input that drives it, ``position`` the output that follows.  ``where`` are names for parts
    of formulas, each of which can use those before it.  ``formulas`` has one formula for each quantity.  ``change`` are
    the parameters that ``epg identify`` may change, as many as there are formulas.
    """

    duty: str
    span: Span
    position: str
    position_span: Span
    where: Mapping[str, tuple[Formula, Span]]
    formulas: Mapping[str, tuple[Formula, Span]]
    change: tuple[tuple[str, Span], ...]

    def parameters(self) -> list[tuple[str, Span]]:
        """The names of the parameters in the formulas, with the positions of the formulas."""
        known: set[str] = set()
        result = []
        for name, (formula, span) in self.where.items():
            result += [(each, span) for each in formula.names if each not in known]
            known.add(name)
        for formula, span in self.formulas.values():
            result += [(each, span) for each in formula.names if each not in known]
        return result

    def values(self, parameters: Mapping[str, float]) -> list[float]:
        """The values of the formulas for these parameters.

        :raises FormulaError: a formula has no value
        """
        known = dict(parameters)
        for name, (formula, _) in self.where.items():
            known[name] = formula.value(known)
        return [formula.value(known) for formula, _ in self.formulas.values()]


def motors_of(node: YamlNode, diagnostics: Diagnostics) -> Mapping[str, Motor]:
    """The motors of a bindings file, by the plant's inputs.  Reports mistakes in formulas."""
    section = node.get("motors")
    if section is None:
        return MappingProxyType({})
    found = {name: _motor(name, section.key_span(name), value, diagnostics) for name, value in section.items()}
    return MappingProxyType(found)


def _motor(name: str, span: Span, node: YamlNode, diagnostics: Diagnostics) -> Motor:
    formulas = {
        quantity: (_formula(node[quantity], diagnostics), node[quantity].span)
        for quantity in QUANTITIES
        if quantity in node
    }
    where = node.get("where")
    change = tuple((str(each.value), each.span) for each in node["change"].elements())
    if "friction" in formulas and "dead_zone" in formulas:
        message = "a motor has friction or a dead zone: both are the duty that just moves it"
        hint = "remove 'friction' or 'dead_zone'"
        diagnostics.error("wrong-value", node.key_span("dead_zone"), message, hint=hint)
    elif len(change) != len(formulas):
        message = f"'change' has {_count(change, 'parameter')} for {_count(formulas, 'formula')}"
        hint = f"name one parameter for each of {', '.join(formulas)}"
        diagnostics.error("wrong-value", node["change"].span, message, hint=hint)
    return Motor(
        duty=name,
        span=span,
        position=str(node["position"].value),
        position_span=node["position"].span,
        where=MappingProxyType(
            {each: (_formula(value, diagnostics), value.span) for each, value in (where.items() if where else ())}
        ),
        formulas=MappingProxyType(formulas),
        change=change,
    )


def _formula(node: YamlNode, diagnostics: Diagnostics) -> Formula:
    try:
        return parse_formula(str(node.value))
    except FormulaError as problem:
        hint = "a formula has numbers, names of parameters, + - * / ^, parentheses, sqrt() and pi"
        diagnostics.error("wrong-formula", node.span, str(problem), hint=hint)
        return parse_formula("0")


def _count(items: Sequence[object] | Mapping[str, object], word: str) -> str:
    return f"{len(items)} {word}{'' if len(items) == 1 else 's'}"
