# SPDX-License-Identifier: Apache-2.0
"""An application as C: ``<name>.h``, ``<name>_version.c`` and ``.h``, ``<name>_app.c`` and what its platform adds.

The layout of the files stands in ``templates/``; what each component contributes stands in the ``code.c.j2`` of its
kind, one macro per place of the generation order (docs/architecture.md lists them).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from jinja2 import Environment

from epg import __version__
from epg.catalog.kind import OUTPUT_CLASSES
from epg.diagnostics import Diagnostics, UserError
from epg.emit.claims import board_nodes, claims_of, gpios_of, tick_of
from epg.emit.cmake import platform_files
from epg.emit.fingerprint import LITERAL, model_hash
from epg.emit.service import MiddlewareView, service_of
from epg.emit.template import CodeMacro, environment, macro_mistake
from epg.emit.text import CMakeCode, Code, DevicetreeCode, Escaped, KconfigCode, double, identifier
from epg.emit.topics import Topics, topics_of
from epg.models.details import HandWritten
from epg.resolve.application import Application, ResolvedComponent, Step, Wire
from epg.resolve.conversion import folded

TEMPLATES = Path(__file__).resolve().parent / "templates"


@dataclass(frozen=True)
class UseView:
    """Another component that one names: the C expressions for its value, and for how often that was reset.

    ``value`` is what a sensor gives or what a drive is given at present; empty for a topic.
    """

    name: str
    value: Code
    resets: Code


@dataclass(frozen=True)
class ValueView:
    """One number of a component's topic: the port, with element and part as in :class:`~epg.catalog.kind.KindPort`."""

    port: str
    element: str
    part: str
    index: int


@dataclass(frozen=True)
class ComponentView:
    """A component as templates of its kind see it; names that are printed are code already.

    ``period`` is that of the control cycle, ``write_period`` the one at which actuators are written, both in seconds.
    ``values`` are the numbers of its topic in the order of the message, ``value_index`` their indices by port,
    ``first_index`` the first one.
    """

    name: str
    symbol: Code
    parameters: Mapping[str, object]
    claims: Mapping[str, Any]
    first_index: int | None
    application: Code
    period: Fraction
    write_period: Fraction
    value_index: Mapping[str, int] = field(default_factory=dict)
    values: Sequence[ValueView] = ()
    uses: Mapping[str, UseView] = field(default_factory=dict)


@dataclass(frozen=True)
class Part:
    """What one component contributes to the places of the generation order."""

    component: ComponentView
    number: int
    globals: Code
    start: Code
    sample: Code
    check: Code
    safe: Code
    probes: Mapping[str, Code]


POINTS = ("cycle", "inputs", "model", "outputs")
"""Points of the control cycle at which a kind may have statements: its macro ``probe(c, point)``."""


@dataclass(frozen=True)
class Arrival:
    """Statements for when a setpoint has arrived, or a publication is about to leave."""

    component: str
    index: int  # of the topic's first setpoint, or of the publication
    statement: Code


@dataclass(frozen=True)
class InputView:
    """An assignment to a model input."""

    name: str
    source: str
    member: Code
    value: Code


@dataclass(frozen=True)
class OutputView:
    """Statements that hand a model output on: what can be done before its instant, if anything, and the rest."""

    name: str
    sink: str
    prepare: Code
    statement: Code


@dataclass(frozen=True)
class OutputPin:
    """A pin that a component drives; ``high`` is C that says whether its level is high while nothing is to move."""

    component: str
    signal: str
    pin: int
    high: Code


@dataclass(frozen=True)
class InputPin:
    """A pin that the component ``name`` reads; ``invert``: as 1 when it is low."""

    name: str
    pin: int
    invert: bool


@dataclass(frozen=True)
class SafeState:
    """Which of a component's outputs must be low and which must be high, one bit each, the first one lowest."""

    low: int
    high: int


@dataclass(frozen=True)
class OutputGroup:
    """The output pins of one component, ``count`` of them from the ``first`` on, and its safe states."""

    component: str
    first: int
    count: int
    states: tuple[SafeState, ...]


LANGUAGES: Mapping[str, type[Escaped]] = {
    ".overlay": DevicetreeCode,
    ".Kconfig": KconfigCode,
    ".cmake": CMakeCode,
}
"""What templates of platforms are written in, by the ends of the files they become; the others are C."""


class Emitter:
    """Renders one application; ``roots`` are the ``targets`` folders, the user's first."""

    def __init__(self, app: Application, roots: Sequence[Path]) -> None:
        self.app = app
        self.roots = tuple(roots)
        self.prefix = identifier(app.name)
        self.env = environment([TEMPLATES, *roots])
        self.modules: dict[str, Any] = {}
        self.components = {component.name: component for component in app.components}
        self.views = {component.name: self._view(component) for component in app.components}
        self.views |= {name: replace(view, uses=self._uses(name)) for name, view in self.views.items()}

    def files(self) -> dict[str, str]:
        """All generated C of the application by file name."""
        context = self._context()
        name = str(self.prefix)
        result = {
            f"{name}.h": self.env.get_template("app.h.j2").render(context),
            f"{name}_version.c": self.env.get_template("version.c.j2").render(context),
            f"{name}_version.h": self.env.get_template("version.h.j2").render(context),
            f"{name}_app.c": self.env.get_template("app.c.j2").render(context),
        }
        platform = self.app.target.platform
        for file, template in platform_files(self.app).items():
            env = self._environment(file)
            result[file] = env.get_template(f"platforms/{platform.name}/{template}").render(context)
        return {file: _tidy(text) for file, text in result.items()}

    def _environment(self, file: str) -> Environment:
        """The one for the language that ``file`` is written in."""
        language = next((found for suffix, found in LANGUAGES.items() if file.endswith(suffix)), Code)
        return self.env if language is Code else environment([TEMPLATES, *self.roots], language)

    def _context(self) -> dict[str, Any]:
        app = self.app
        parts = [self._part(number, component) for number, component in enumerate(app.components)]
        publishers = {c.name for c in app.components if c.kind.communication == "publish"}
        drivers = {str(header) for component in app.components for header in component.kind.headers}
        headers = set(drivers)
        for middleware in app.communication.middlewares:
            headers.update(middleware.headers)
        service = service_of(app, self._service_macro)
        context: dict[str, Any] = {
            "app": app,
            "prefix": self.prefix,
            "headers": sorted(headers),
            "driver_headers": sorted(drivers),
            "parts": parts,
            "numbers": {part.component.name: part.number for part in parts},
            "topics": topics_of(app, self.macro),
            "arrivals": self._arrivals("subscribe"),
            "departures": self._arrivals("publish"),
            "inputs": [self._input(wire) for wire in app.inputs],
            "outputs": [self._output(wire) for wire in app.outputs if wire.component.name not in publishers],
            "monitor": [self._output(wire) for wire in app.outputs if wire.component.name in publishers],
            "output_pins": self._output_pins(),
            "input_pins": self._input_pins(),
            "output_groups": self._output_groups(),
            "claims": claims_of(app),
            "gpios": gpios_of(app),
            "tick": tick_of(app),
            "board_nodes": board_nodes(app),
            "service": service,
            "transport": self._transport(),
            "middleware_code": self._middleware_code(service.middleware),
            "console_code": self._middleware_code(service.console),
            "model_hash": model_hash(app.model, app.parameters),
            "version": __version__,
            "hash": LITERAL,
            "fail_safe": None,
            "plant_starts_by_step": False,
            "plant_inputs": [],
            "plant_outputs": [],
        }
        if app.fail_safe is not None:
            port = next(p for p in app.fail_safe.kind.ports if p.direction == "source" and p.type == "boolean")
            context["fail_safe"] = self._expression(app.fail_safe, "read", port.name)
        if app.plant is not None:
            details = app.plant.model.details
            context["plant_starts_by_step"] = isinstance(details, HandWritten) and not details.init
            context["plant_inputs"] = [self._plant_input(wire) for wire in app.plant.inputs]
            context["plant_outputs"] = [self._plant_output(wire) for wire in app.plant.outputs]
        return context

    def _view(self, component: ResolvedComponent) -> ComponentView:
        return ComponentView(
            name=component.name,
            symbol=identifier(component.symbol),
            parameters=component.parameters,
            claims=component.claims,
            first_index=component.first_index,
            value_index=component.value_index,
            values=[
                ValueView(port.name, port.element, port.part, component.value_index[port.name])
                for port in component.kind.ports
                if port.name in component.value_index
            ],
            application=self.prefix,
            period=self.app.period,
            write_period=self.app.period * self.app.step_divider,
        )

    def _uses(self, name: str) -> dict[str, UseView]:
        result = {}
        for use, used in self.components[name].uses.items():
            other = self.components[used.component]
            value = Code("")
            if used.port is not None:
                value = self._expression(other, "applied" if used.port.drive else "read", used.port.name)
            result[use] = UseView(other.name, value, self.macro(other, "resets").strip() or Code("0"))
        return result

    def _module(self, component: ResolvedComponent) -> Any:
        kind = component.kind.name
        if kind not in self.modules:
            self.modules[kind] = self.env.get_template(f"components/{kind}/code.c.j2").make_module(
                {"pi": self.env.globals["pi"]}
            )
        return self.modules[kind]

    def macro(self, component: ResolvedComponent, macro: str, *arguments: object) -> Code:
        """What the template of a component's kind gives; empty when it has no such macro."""
        function = getattr(self._module(component), macro, None)
        if not isinstance(function, CodeMacro):
            return Code("")
        taken, given = len(function.arguments), 1 + len(arguments)
        if taken < given and not function.catch_varargs:
            raise macro_mistake(
                component.kind.folder, macro, f"macro '{macro}' takes {taken} of {given} arguments", given
            )
        try:
            return Code(str(function(self.views[component.name], *arguments)).strip("\n"))
        except ArithmeticError:  # what a kind computes of parameters that are each in their range
            problems = Diagnostics()
            message = f"the parameters of '{component.name}' together give a number that C's doubles do not hold"
            hint = "very large and very small ones cancel out badly: check their units"
            problems.error("out-of-range", component.span, message, hint=hint)
            raise UserError(problems) from None

    def _expression(self, component: ResolvedComponent, macro: str, *arguments: object) -> Code:
        return Code(" ".join(str(self._statement(component, macro, *arguments)).split()))

    def _statement(self, component: ResolvedComponent, macro: str, *arguments: object) -> Code:
        code = self.macro(component, macro, *arguments)
        if not code.strip():
            port = f", which port '{arguments[0]}' needs" if arguments else ""
            message = f"kind '{component.kind.name}' has no macro '{macro}'{port}"
            if isinstance(getattr(self._module(component), macro, None), CodeMacro):
                message = f"macro '{macro}' gives nothing" + (f" for port '{arguments[0]}'" if arguments else "")
            raise macro_mistake(component.kind.folder, macro, message, 1 + len(arguments))
        return code

    def _part(self, number: int, component: ResolvedComponent) -> Part:
        return Part(
            component=self.views[component.name],
            number=number,
            globals=self.macro(component, "globals"),
            start=_indented(self.macro(component, "start")),
            sample=_indented(self.macro(component, "sample")),
            check=self.macro(component, "check").strip(),
            safe=_indented(self.macro(component, "safe")),
            probes={point: _indented(self.macro(component, "probe", point)) for point in POINTS},
        )

    def _service_macro(self, component: ResolvedComponent, macro: str, *arguments: object) -> Code:
        if macro == "write":  # at once
            prepare, write = self._output_statements(component, *arguments)
            return Code("\n".join(statements for statements in (prepare, write) if statements))
        return self.macro(component, macro, *arguments)

    def _middleware_code(self, view: MiddlewareView | None) -> Code:
        templates = {m.name for m in self.app.communication.middlewares if m.has_template}
        if view is None or view.name not in templates:
            return Code("")
        template = self.env.get_template(f"middlewares/{view.name}/code.c.j2")
        return Code(str(template.make_module().globals(view)).strip("\n"))  # type: ignore[attr-defined]

    def _transport(self) -> Code:
        """The C object of the component that carries the middleware's bytes; empty when no component does."""
        component = self.components.get(self.app.communication.transport or "")
        if component is None or not component.kind.transport:
            return Code("")
        return self._expression(component, "transport")

    def _output_pins(self) -> list[OutputPin]:
        return [
            OutputPin(component.name, signal, pin, self._safe_level(component, claim.name))
            for component in self.app.components
            for claim in component.kind.claims
            if claim.resource_class in OUTPUT_CLASSES
            for signal, pin in sorted(component.claims[claim.name].pins.items())
        ]

    def _input_pins(self) -> list[InputPin]:
        return [
            InputPin(component.name, pin, bool(component.parameters.get("invert", False)))
            for component in self.app.components
            for claim in component.kind.claims
            if claim.resource_class == "digital_input"
            for pin in component.claims[claim.name].pins.values()
        ]

    def _output_groups(self) -> list[OutputGroup]:
        groups = []
        first = 0
        for component in self.app.components:
            claims = [
                claim.name
                for claim in component.kind.claims
                if claim.resource_class in OUTPUT_CLASSES
                for _ in component.claims[claim.name].pins
            ]
            if claims:
                safe = {claim: "high" if self._safe_level(component, claim) == "true" else "low" for claim in claims}
                states = tuple(_safe_state(claims, state) for state in component.kind.safe_states or [safe])
                groups.append(OutputGroup(component.name, first, len(claims), states))
                first += len(claims)
        return groups

    def _safe_level(self, component: ResolvedComponent, claim: str) -> Code:
        return self.macro(component, "safe_level", claim).strip() or Code("false")

    def _arrivals(self, direction: str) -> list[Arrival]:
        """What components have to do with topics of a direction besides their values."""
        publications = [topic.component.name if topic.component else "" for topic in self.app.publications]
        result = []
        for component in self.app.components:
            for used in component.uses.values():
                topic = self.components[used.component]
                statement = _indented(self.macro(component, "probe", "topic"), " " * 8)
                if topic.kind.communication == direction and topic.first_index is not None and statement:
                    index = topic.first_index if direction == "subscribe" else publications.index(topic.name)
                    result.append(Arrival(component.name, index, statement))
        return sorted(result, key=lambda arrival: arrival.index)

    def _input(self, wire: Wire) -> InputView:
        value = self._expression(wire.component, "read", wire.component_port.name)
        member = identifier(wire.port.identifier)
        return InputView(wire.port.name, _reference(wire), member, self._converted(value, wire.steps))

    def _output(self, wire: Wire) -> OutputView:
        value = Code(f"{self.prefix}_outputs.{identifier(wire.port.identifier)}")
        value = self._converted(value, wire.steps)
        prepare, write = self._output_statements(wire.component, wire.component_port.name, value)
        return OutputView(wire.port.name, _reference(wire), prepare, write)

    def _output_statements(self, component: ResolvedComponent, port: object, value: object) -> tuple[Code, Code]:
        prepare = self.macro(component, "prepare", port, value)
        write = (self.macro if prepare else self._statement)(component, "write", port, value)
        return _indented(prepare), _indented(write)

    def _plant_input(self, wire: Wire) -> InputView:
        value = self._expression(wire.component, "plant_read", wire.component_port.name)
        member = identifier(wire.port.identifier)
        return InputView(wire.port.name, _reference(wire), member, self._converted(value, wire.steps, counted=False))

    def _plant_output(self, wire: Wire) -> OutputView:
        value = Code(f"outputs.{identifier(wire.port.identifier)}")
        value = self._converted(value, wire.steps, counted=False)
        statement = self._statement(wire.component, "plant_write", wire.component_port.name, value)
        return OutputView(wire.port.name, _reference(wire), Code(""), _indented(statement))

    def _converted(self, value: Code, steps: Sequence[Step], *, counted: bool = True) -> Code:
        """The C expression for ``value`` after all steps; steps without limits between them become one.

        Limits count in the controller's statistics, those of a plant (not ``counted``) do not.
        """
        for step in folded(steps):
            if step.scale != 1:
                value = Code(f"{value} * {double(step.scale)}")
            if step.offset != 0:
                sign = "+" if step.offset > 0 else "-"
                value = Code(f"{value} {sign} {double(abs(step.offset))}")
            if step.limits is not None:
                low, high = (double(limit) for limit in step.limits)
                call = f"epg_limit(&{self.prefix}_control, " if counted else "epg_clamp("
                value = Code(f"{call}{value}, {low}, {high})")
        return value


def emit_application(app: Application, roots: Sequence[Path]) -> dict[str, str]:
    """The generated C of ``app`` by file name."""
    return Emitter(app, roots).files()


def application_topics(app: Application, roots: Sequence[Path]) -> Topics:
    """The topics of ``app`` with their messages."""
    return topics_of(app, Emitter(app, roots).macro)


def _reference(wire: Wire) -> str:
    text = f"{wire.component.name}.{wire.component_port.name}"
    reasons = [step.reason for step in wire.steps if step.reason]
    return f"{text} ({', '.join(reasons)})" if reasons else text


def _indented(code: Code, blanks: str = "    ") -> Code:
    """Statements of a macro at the depth of a function body, whatever depth they are written at."""
    lines = [line.rstrip() for line in str(code).split("\n")]
    filled = [line for line in lines if line]
    depth = min((len(line) - len(line.lstrip()) for line in filled), default=0)
    return Code("\n".join(blanks + line[depth:] for line in filled))


def _tidy(text: str) -> str:
    lines = [line.rstrip() for line in text.split("\n")]
    result: list[str] = []
    for line in lines:
        if line or (result and result[-1]):
            result.append(line)
    return "\n".join(result).rstrip("\n") + "\n"


def _safe_state(claims: Sequence[str], levels: Mapping[str, str]) -> SafeState:
    """The masks of a kind's safe state, for outputs that belong to these ``claims``."""

    def bits(level: str) -> int:
        return sum(1 << bit for bit, claim in enumerate(claims) if levels.get(claim) == level)

    return SafeState(bits("low"), bits("high"))
