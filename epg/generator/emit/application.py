# SPDX-License-Identifier: Apache-2.0
"""The C files of an application: ``<name>.h``, ``<name>_app.c``, ``<name>_access.c``, ``<name>_version.c`` and ``.h``.

The templates of the platform can add files, for example a devicetree overlay.

The templates in ``templates/`` define the layout of the files.  The ``code.c.j2`` of a component kind defines the code
that each component of the kind contributes.  It has one macro for each place of the generation order;
docs/architecture.md lists the macros.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment

from epg import __version__
from epg.generator.emit.access import access_of
from epg.generator.emit.claims import board_nodes, claims_of, tick_of
from epg.generator.emit.cmake import platform_files
from epg.generator.emit.fingerprint import LITERAL, model_hash
from epg.generator.emit.macros import Macros
from epg.generator.emit.pins import pin_lists
from epg.generator.emit.ros_services import ros_services_of
from epg.generator.emit.service import MiddlewareView, console_word, service_of
from epg.generator.emit.symbols import TEMPLATES, constants
from epg.generator.emit.template import environment
from epg.generator.emit.text import CMakeCode, Code, DevicetreeCode, Escaped, KconfigCode, double, identifier
from epg.generator.emit.topics import Topics, topics_of
from epg.generator.emit.views import POINTS, Arrival, ComponentCode, FollowedView, InputView, OutputView
from epg.generator.resolve.application import Application, ConversionStep, ResolvedComponent, Wire
from epg.generator.resolve.conversion import folded
from epg.generator.resolve.setpoints import computed_steps

LANGUAGES: Mapping[str, type[Escaped]] = {".overlay": DevicetreeCode, ".Kconfig": KconfigCode, ".cmake": CMakeCode}
"""The output language of a platform's template, by the suffix of the file that it makes.  All other files are C."""


class Emitter:
    """Renders the files of one application.  ``roots`` are the ``targets`` folders; the user's folders come first."""

    def __init__(self, app: Application, roots: Sequence[Path]) -> None:
        self.app = app
        self.roots = tuple(roots)
        self.prefix = identifier(app.name)
        self.env = environment([TEMPLATES, *roots])
        self.macros = Macros(app, self.env)

    def files(self) -> dict[str, str]:
        """The text of each generated file of the application and its platform, by file name."""
        context = self._context()
        name = str(self.prefix)
        frames = {
            ".h": "app.h.j2",
            "_version.c": "version.c.j2",
            "_version.h": "version.h.j2",
            "_app.c": "app.c.j2",
            "_access.c": "access.c.j2",
        }
        result = {f"{name}{end}": self.env.get_template(frame).render(context) for end, frame in frames.items()}
        platform = self.app.target.platform
        for file, template in platform_files(self.app).items():
            env = self._environment(file)
            result[file] = env.get_template(f"{platform.template_folder}/{template}").render(context)
        return {file: _tidy(text) for file, text in result.items()}

    def topics(self) -> Topics:
        """The topics of the application with their messages."""
        return topics_of(self.app, self.macros.macro)

    def _environment(self, file: str) -> Environment:
        """The Jinja environment for the output language of ``file``."""
        language = next((found for suffix, found in LANGUAGES.items() if file.endswith(suffix)), Code)
        return self.env if language is Code else environment([TEMPLATES, *self.roots], language)

    def _context(self) -> dict[str, Any]:
        """The variables that all templates of the application and its platform can use."""
        app = self.app
        names = constants(app, "COMPONENT", [component.name for component in app.components])
        parts = [self._part(name, component) for name, component in zip(names, app.components, strict=True)]
        drivers = {str(header) for component in app.components for header in component.kind.headers}
        headers = drivers.union(*(each.headers for each in app.communication.middlewares))
        service = service_of(app, self._service_macro, self.macros.symbols)
        model = model_hash(app.model, app.parameters)
        return {
            "app": app,
            "prefix": self.prefix,
            "headers": sorted(headers),
            "driver_headers": sorted(drivers),
            "parts": parts,
            "faults": list(self.macros.faults.items()),
            "numbers": {component.name: number for number, component in enumerate(app.components)},
            "component_constants": {part.component.name: part.constant for part in parts},
            "setpoint_constants": self._constants("subscribe"),
            "published_constants": self._constants("publish"),
            "signal_constants": constants(app, "SIGNAL", [*(signal.name for signal in service.signals), "time"]),
            "topics": self.topics(),
            "followed": dict(self._followed()),
            "setpoint_units": self._setpoint_units(),
            "arrivals": self._arrivals("subscribe"),
            "departures": self._arrivals("publish"),
            **self._values(),
            **pin_lists(self.macros),
            "claims": claims_of(app),
            "tick": tick_of(app),
            "board_nodes": board_nodes(app),
            "service": service,
            "access": access_of(app, bool(service.parameters)),
            "ros_services": ros_services_of(app),
            "transport": self._transport(app.communication.transport),
            "console_transport": self._transport(app.communication.console_transport),
            "middleware_code": self._middleware_code(service.middleware),
            "console_code": self._middleware_code(service.console),
            "model_hash": model,
            "model_number": Code(f"0x{model}u"),
            "model_limits": app.model.code.limits_values(app.model),
            "rounded": sorted(app.model.code.rounded(app.model)),
            "version": __version__,
            "hash": LITERAL,
            "fail_safe": self._fail_safe(),
            **self._plant(),
        }

    def _values(self) -> dict[str, Any]:
        """The views of the model's inputs and outputs.  ``monitor`` has the outputs that are only published."""
        outputs = self.app.outputs
        return {
            "inputs": [self._input(wire) for wire in self.app.inputs],
            "outputs": [self._output(wire) for wire in outputs if wire.component.kind.communication != "publish"],
            "monitor": [self._output(wire) for wire in outputs if wire.component.kind.communication == "publish"],
        }

    def _setpoint_units(self) -> dict[int, str]:
        return {
            value.index: console_word(value.setpoint.unit)
            for topic in self.app.subscriptions
            for value in topic.values
            if value.setpoint is not None
        }

    def _fail_safe(self) -> Code | None:
        """The expression that is true while the component ``fail_safe`` asks for it, if there is one."""
        component = self.app.fail_safe
        if component is None:
            return None
        port = next(p for p in component.kind.ports if p.direction == "source" and p.type == "boolean")
        return self.macros.expression(component, "read", port.name)

    def _plant(self) -> dict[str, Any]:
        """The template variables of a simulated plant.  The lists are empty if the application has no plant."""
        plant = self.app.plant
        return {
            "plant_library": identifier(plant.library or f"{self.app.name}_plant") if plant else Code(""),
            "plant_starts_by_step": plant is not None and plant.model.code.starts_by_step,
            "plant_inputs": [self._input(wire, "plant_read", counted=False) for wire in plant.inputs] if plant else [],
            "plant_outputs": [self._plant_output(wire) for wire in plant.outputs] if plant else [],
        }

    def _constants(self, communication: str) -> list[Code]:
        """The constants of all setpoints ("subscribe") or of all published values ("publish"), in their order."""
        views = [self.macros.views[c.name] for c in self.app.components if c.kind.communication == communication]
        return [
            constant
            for _, constant in sorted(
                (v.value_index[port], name) for v in views for port, name in v.value_names.items()
            )
        ]

    def _part(self, constant: Code, component: ResolvedComponent) -> ComponentCode:
        drives = any(port.actuator for port in component.kind.ports)
        return ComponentCode(
            component=self.macros.views[component.name],
            constant=constant,
            globals=self.macros.macro(component, "globals"),
            start=_indented(self.macros.macro(component, "start")),
            sample=_indented(self.macros.macro(component, "sample")),
            check=self.macros.macro(component, "check").strip(),
            safe=_indented((self.macros.statement if drives else self.macros.macro)(component, "safe")),
            probes={point: _indented(self.macros.macro(component, "probe", point)) for point in POINTS},
        )

    def _service_macro(self, component: ResolvedComponent, macro: str, *arguments: object) -> Code:
        if macro == "write":  # there is no output delay when the user moves an actuator by hand: write it at once
            prepare, write = self._output_statements(component, *arguments)
            return Code("\n".join(statements for statements in (prepare, write) if statements))
        return self.macros.macro(component, macro, *arguments)

    def _middleware_code(self, view: MiddlewareView | None) -> Code:
        templates = {m.name for m in self.app.communication.middlewares if m.has_template}
        if view is None or view.name not in templates:
            return Code("")
        template = self.env.get_template(f"middlewares/{view.name}/code.c.j2")
        return Code(str(template.make_module().globals(view)).strip("\n"))  # type: ignore[attr-defined]

    def _transport(self, name: str | None) -> Code:
        """The C expression of a transport component, which carries the bytes of a middleware.

        Empty if ``name`` is not such a component.
        """
        component = self.macros.components.get(name or "")
        if component is None or not component.kind.transport:
            return Code("")
        return self.macros.expression(component, "transport")

    def _arrivals(self, direction: str) -> list[Arrival]:
        """The statements of components that use a topic, for topics of one direction, in the order of topics.

        ``direction`` is "subscribe" or "publish".  The statements come from the macro ``probe(c, "topic")``.
        """
        publications = [topic.component.name if topic.component else "" for topic in self.app.publications]
        result = []
        for component in self.app.components:
            for used in component.uses.values():
                topic = self.macros.components[used.component]
                statement = _indented(self.macros.macro(component, "probe", "topic"), " " * 8)
                if topic.kind.communication == direction and topic.first_index is not None and statement:
                    index = topic.first_index if direction == "subscribe" else publications.index(topic.name)
                    result.append(Arrival(component.name, index, statement))
        return sorted(result, key=lambda arrival: arrival.index)

    def _followed(self) -> Iterable[tuple[int, FollowedView]]:
        """The measured values that setpoints follow, with the indices of the setpoints."""
        for topic in self.app.subscriptions:
            for value in topic.values:
                followed = value.setpoint.followed if value.setpoint is not None else None
                if followed is not None:
                    wire = followed.measured
                    read = self.macros.expression(wire.component, "read", wire.component_port.name)
                    converted = self._converted(read, [followed.step])
                    signal = console_word(f"inputs.{wire.port.name}")
                    yield value.index, FollowedView(value.name, signal, converted, followed.guard)

    def _input(self, wire: Wire, macro: str = "read", *, counted: bool = True) -> InputView:
        value = self.macros.expression(wire.component, macro, wire.component_port.name)
        member = identifier(wire.port.identifier)
        return InputView(
            wire.port.name, _reference(wire), member, self._converted(value, computed_steps(wire), counted=counted)
        )

    def _output(self, wire: Wire) -> OutputView:
        value = Code(f"{self.prefix}_outputs.{identifier(wire.port.identifier)}")
        value = self._converted(value, wire.steps)
        prepare, write = self._output_statements(wire.component, wire.component_port.name, value)
        return OutputView(wire.port.name, _reference(wire), prepare, write)

    def _output_statements(self, component: ResolvedComponent, port: object, value: object) -> tuple[Code, Code]:
        prepare = self.macros.macro(component, "prepare", port, value)
        write = (self.macros.macro if prepare else self.macros.statement)(component, "write", port, value)
        return _indented(prepare), _indented(write)

    def _plant_output(self, wire: Wire) -> OutputView:
        value = Code(f"outputs.{identifier(wire.port.identifier)}")
        value = self._converted(value, wire.steps, counted=False)
        statement = self.macros.statement(wire.component, "plant_write", wire.component_port.name, value)
        return OutputView(wire.port.name, _reference(wire), Code(""), _indented(statement))

    def _converted(self, value: Code, steps: Sequence[ConversionStep], *, counted: bool = True) -> Code:
        """The C expression for ``value`` after all conversion steps.

        Steps without limits between them become one step.  If ``counted``, the controller's statistics count each
        value that a limit changed.  Limits of a plant must not be ``counted``.
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


def _reference(wire: Wire) -> str:
    text = f"{wire.component.name}.{wire.component_port.name}"
    reasons = [step.reason for step in wire.steps if step.reason]
    return f"{text} ({', '.join(reasons)})" if reasons else text


def _indented(code: Code, blanks: str = "    ") -> Code:
    """The statements of a macro, indented by ``blanks``.  Their depth relative to each other stays."""
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
