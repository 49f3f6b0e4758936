# SPDX-License-Identifier: Apache-2.0
"""Calls the macros of component kinds for the components of one application."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any

from jinja2 import Environment

from epg.generator.catalog.kind import TEMPLATE, Kind, KindFault
from epg.generator.diagnostics import Diagnostics, UserError, did_you_mean
from epg.generator.emit.symbols import component_symbols, constants
from epg.generator.emit.template import CodeMacro, macro_mistake, macro_span, unused_macros
from epg.generator.emit.text import Code, identifier
from epg.generator.emit.views import ComponentView, UseView, ValueView
from epg.generator.resolve.application import Application, ResolvedComponent

MACROS = """applied check count globals layout message message_size message_type plant_read plant_write prepare probe
read resets safe safe_level sample start transport write""".split()
"""All macros of a kind that EPG calls."""


class Macros:
    """The macros in the ``code.c.j2`` of each kind that ``app`` uses.  ``env`` loads the templates."""

    def __init__(self, app: Application, env: Environment) -> None:
        self.app = app
        self.env = env
        self.modules: dict[str, Any] = {}
        self.symbols = component_symbols(app, env)
        self.faults = fault_constants(app)
        self.value_names = {**value_constants(app, "SETPOINT"), **value_constants(app, "PUBLISHED")}
        self.components = {component.name: component for component in app.components}
        self.views = {component.name: self._view(component) for component in app.components}
        self.views |= {name: replace(view, uses=self._uses(name)) for name, view in self.views.items()}

    def macro(self, component: ResolvedComponent, macro: str, *arguments: object) -> Code:
        """The text of a macro for one component; empty if the template of its kind does not have the macro.

        Raises UserError if the macro takes too few arguments, or if the values of parameters give a number that is
        not finite.
        """
        function = getattr(self._module(component), macro, None)
        if not isinstance(function, CodeMacro):
            return Code("")
        taken, given = len(function.arguments), 1 + len(arguments)
        if taken < given and not function.catch_varargs:
            raise macro_mistake(
                component.kind.folder, macro, f"macro '{macro}' must have {given} parameters, not {taken}", given
            )
        try:
            return Code(str(function(self.views[component.name], *arguments)).strip("\n"))
        except ArithmeticError:  # each parameter is in its range, but a computation with several of them is not
            problems = Diagnostics()
            message = f"the parameters of '{component.name}' together result in a number that a double cannot represent"
            hint = "check their units: very large and very small values do not fit together"
            problems.error("out-of-range", component.span, message, hint=hint)
            raise UserError(problems) from None

    def expression(self, component: ResolvedComponent, macro: str, *arguments: object) -> Code:
        """The text of a macro that is an expression, on one line.  Raises UserError if it is empty."""
        return Code(" ".join(str(self.statement(component, macro, *arguments)).split()))

    def statement(self, component: ResolvedComponent, macro: str, *arguments: object) -> Code:
        """The text of a macro that the kind must have.  Raises UserError if it is missing or empty."""
        code = self.macro(component, macro, *arguments)
        if not code.strip():
            port = f", which port '{arguments[0]}' needs" if arguments else ""
            message = f"kind '{component.kind.name}' has no macro '{macro}'{port}"
            if isinstance(getattr(self._module(component), macro, None), CodeMacro):
                message = f"macro '{macro}' prints nothing" + (f" for port '{arguments[0]}'" if arguments else "")
            raise macro_mistake(component.kind.folder, macro, message, 1 + len(arguments))
        return code

    def _view(self, component: ResolvedComponent) -> ComponentView:
        return ComponentView(
            name=component.name,
            symbol=self.symbols[component.name],
            parameters=component.parameters,
            claims=component.claims,
            first_index=component.first_index,
            value_index=component.value_index,
            values=[
                ValueView(port.name, port.element, port.part, component.value_index[port.name])
                for port in component.kind.ports
                if port.name in component.value_index
            ],
            value_names=self.value_names.get(component.name, {}),
            application=identifier(self.app.name),
            period=self.app.period,
            write_period=self.app.period * self.app.step_divider,
            faults={fault.name: self.faults[fault] for fault in component.kind.faults},
        )

    def _uses(self, name: str) -> dict[str, UseView]:
        result = {}
        for use, used in self.components[name].uses.items():
            other = self.components[used.component]
            value = Code("")
            if used.port is not None:
                value = self.expression(other, "applied" if used.port.drive else "read", used.port.name)
            result[use] = UseView(other.name, value, self.macro(other, "resets").strip() or Code("0"))
        return result

    def _module(self, component: ResolvedComponent) -> Any:
        kind = component.kind.name
        if kind not in self.modules:
            module: Any = self.env.get_template(f"components/{kind}/{TEMPLATE}").make_module(
                {"pi": self.env.globals["pi"]}
            )
            self._check(component.kind, {name for name, value in vars(module).items() if isinstance(value, CodeMacro)})
            self.modules[kind] = module
        return self.modules[kind]

    def _check(self, kind: Kind, macros: set[str]) -> None:
        """Raises UserError if nothing calls one of the ``macros`` of ``kind``, or if it lacks one for safety."""
        others = macros.difference(MACROS)
        unused = unused_macros(self.env, f"components/{kind.name}/{TEMPLATE}", others) if others else []
        problems = Diagnostics()
        for name in unused:
            hint = did_you_mean(name, MACROS, "macros")
            message = f"nothing calls the macro '{name}': EPG has no macro of this name"
            problems.error("template-wrong", macro_span(kind.folder, name), message, hint=hint)
        if problems.error_count:
            raise UserError(problems)
        needed = [("safe", f"actuator '{port.name}'") for port in kind.ports if port.actuator]
        needed += [("check", f"fault '{fault.name}'") for fault in kind.faults]
        for name, what in needed:
            if name not in macros:
                message = f"kind '{kind.name}' has no macro '{name}', which its {what} needs"
                raise macro_mistake(kind.folder, name, message, 1)

    def safe_level(self, component: ResolvedComponent, claim: str) -> Code:
        """A C expression, true if the safe level of the claim's pins is high.  The default is ``false``."""
        return self.macro(component, "safe_level", claim).strip() or Code("false")


def fault_constants(app: Application) -> dict[KindFault, Code]:
    """The constant of each fault that the kinds of the components declare, in the order of their numbers."""
    faults = sorted({fault for c in app.components for fault in c.kind.faults}, key=lambda fault: fault.number)
    return dict(zip(faults, constants(app, "FAULT", [fault.name for fault in faults]), strict=True))


def value_constants(app: Application, word: str) -> dict[str, dict[str, Code]]:
    """The constants of setpoints (``word`` is SETPOINT) or published values (PUBLISHED), by component and port."""
    direction = {"SETPOINT": "subscribe", "PUBLISHED": "publish"}[word]
    values = sorted(
        (index, component.name, port)
        for component in app.components
        if component.kind.communication == direction
        for port, index in component.value_index.items()
    )
    alone = Counter(component for _, component, _ in values)
    names = [component if alone[component] == 1 else f"{component}_{port}" for _, component, port in values]
    result: dict[str, dict[str, Code]] = {}
    for (_, component, port), constant in zip(values, constants(app, word, names), strict=True):
        result.setdefault(component, {})[port] = constant
    return result
