# SPDX-License-Identifier: Apache-2.0
"""The kinds' code templates: rendered as the generator does, compiled, and run with simulated peripherals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from epg.generator.catalog.catalog import Catalog, load_catalog
from epg.generator.check.compose import typed_parameters
from epg.generator.check.messages import with_messages
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.yaml_file import parse_yaml
from epg.generator.emit.template import environment
from epg.generator.emit.text import Code, identifier

from .program import (
    COMPONENTS,
    ROOT,
    SOURCES,
    compile_program,
    component_sources,
    names_in,
    run_program,
    runtime_sources,
)

TARGETS = ROOT / "targets"
HOST = TARGETS / "platforms" / "host"
HARNESS = SOURCES / "templates.c"
PORT = ("port", "clock", "posix/monotonic", "elsewhere/system", "serial", "store", "posix/file")
PWM = {"prescaler": 1, "top": 6249}


def claim(
    pins: Mapping[str, int], instance: int = 0, slot: int = 0, gap: Fraction | None = None, **settings: int
) -> SimpleNamespace:
    clocks = settings.get("prescaler", 1) * (settings.get("top", 0) + 1)
    return SimpleNamespace(
        pins=dict(pins),
        instance=instance,
        slot=slot,
        settings=settings,
        frequency=Fraction(125_000_000, clocks),
        longest_gap=gap,
    )


def dual_claims(forwards: int, backwards: int, slots: tuple[int, int]) -> dict[str, Any]:
    return {
        "forwards": claim({"value": forwards}, 0, slots[0], **PWM),
        "backwards": claim({"value": backwards}, 0, slots[1], **PWM),
    }


def bridge_claims(value: int, a: int, b: int, slot: int) -> dict[str, Any]:
    return {
        "pwm": claim({"value": value}, 0, slot, **PWM),
        "direction_a": claim({"value": a}),
        "direction_b": claim({"value": b}),
    }


@dataclass(frozen=True)
class Component:
    """A component as in a ``.tcf``, and the hardware that was assigned to it."""

    name: str
    text: str
    claims: Mapping[str, Any] = field(default_factory=dict)
    first_index: int | None = None
    uses: Mapping[str, Any] = field(default_factory=dict)


def use(name: str, value: str = "", resets: str = "0") -> SimpleNamespace:
    return SimpleNamespace(name=name, value=Code(value), resets=Code(resets))


COMPONENTS_TRIED = [
    Component(
        "encoder_span",
        "{kind: quadrature_encoder, span: {counts: 1112, angle: 180 deg}}",
        {"encoder": claim({"a": 10, "b": 11}, 0, 0)},
    ),
    Component(
        "encoder_inverted",
        "{kind: quadrature_encoder, span: {counts: 1112, angle: 180 deg}, invert: true}",
        {"encoder": claim({"a": 12, "b": 13}, 0, 1)},
    ),
    Component(
        "encoder_gear",
        "{kind: quadrature_encoder, counts_per_revolution: 4096, gear: 5625/361, pull_up: true}",
        {"encoder": claim({"a": 14, "b": 15}, 1, 2)},
    ),
    Component(
        "encoder_preset",
        "{kind: quadrature_encoder, counts_per_revolution: 4096, preset: 90 deg}",
        {"encoder": claim({"a": 20, "b": 21}, 1, 3)},
    ),
    Component(
        "encoder_speed",
        "{kind: quadrature_encoder, counts_per_revolution: 4096, max_speed: 40 rad/s}",
        {"encoder": claim({"a": 22, "b": 23}, 1, 1, gap=Fraction(5, 4))},
    ),
    Component(
        "bridge", "{kind: pwm_h_bridge, frequency: 20 kHz, max_duty: 0.96, dead_time: 0 s}", bridge_claims(2, 7, 8, 1)
    ),
    Component(
        "bridge_inverted",
        "{kind: pwm_h_bridge, frequency: 20 kHz, invert: true, dead_time: 0 s}",
        bridge_claims(4, 5, 6, 2),
    ),
    Component("bridge_default", "{kind: pwm_h_bridge, frequency: 20 kHz}", bridge_claims(17, 18, 19, 11)),
    Component(
        "bridge_braking",
        "{kind: pwm_h_bridge, frequency: 20 kHz, zero: brake, dead_time: 1.5 ms}",
        bridge_claims(24, 25, 26, 9),
    ),
    Component("dual", "{kind: dual_pwm_h_bridge, max_duty: 0.96}", dual_claims(27, 28, (10, 11))),
    Component(
        "dual_inverted",
        "{kind: dual_pwm_h_bridge, invert: true, decay: brake, safe: brake, dead_time: 1 us}",
        dual_claims(29, 30, (12, 13)),
    ),
    Component(
        "guard",
        "{kind: motion_guard, actuator: bridge, encoder: encoder_span, stall: {time: 2.5 ms}, runaway: {angle: 1 rad}}",
        uses={
            "actuator": use("bridge", "bridge.bridge.duty"),
            "encoder": use("encoder_span", "encoder_span.position", "encoder_span.resets"),
        },
    ),
    Component(
        "guard_homing",
        "{kind: motion_guard, actuator: dual, encoder: encoder_preset, homing: {travel: 180 deg, time: 3 ms}}",
        uses={
            "actuator": use("dual", "dual.bridge.duty"),
            "encoder": use("encoder_preset", "encoder_preset.position", "encoder_preset.resets"),
        },
    ),
    Component("probe_model", "{kind: timing_probe, at: model}", {"pin": claim({"value": 31})}),
    Component("probe_topic", "{kind: timing_probe, topic: subscriber}", {"pin": claim({"value": 32})}),
    Component(
        "servo",
        "{kind: pwm, frequency: 20 kHz, max_duty: 0.9, safe_duty: 0.08}",
        {"pwm": claim({"value": 0}, 0, 5, **PWM)},
    ),
    Component("lamp", "{kind: pwm, frequency: 20 kHz, invert: true}", {"pwm": claim({"value": 1}, 0, 7, **PWM)}),
    Component("button", "{kind: digital_input, pull: up}", {"level": claim({"value": 16})}),
    Component("gate", "{kind: digital_input, invert: true}", {"level": claim({"value": 22})}),
    Component("valve", "{kind: digital_output}", {"level": claim({"value": 17})}),
    Component("brake", "{kind: digital_output, invert: true, safe: true}", {"level": claim({"value": 18})}),
    Component("subscriber", "{kind: ros_subscriber, topic: a}", first_index=3),
    Component("publisher", "{kind: ros_publisher, topic: b}", first_index=2),
    Component("flag", "{kind: ros_publisher, topic: b2, type: bool, on_change: true}", first_index=3),
    Component("array_in", "{kind: ros_array_subscriber, topic: c, values: [first, second]}", first_index=4),
    Component("array_out", "{kind: ros_array_publisher, topic: d, values: [first, second], every: 4}", first_index=4),
    Component("joints_in", "{kind: ros_joint_state_subscriber, topic: e, joints: [pan, tilt]}", first_index=6),
    Component(
        "joints_out", "{kind: ros_joint_state_publisher, topic: f, joints: [pan, tilt], frame: base}", first_index=6
    ),
    Component("twist_in", "{kind: ros_twist_subscriber, topic: g}", first_index=12),
    Component("twist_out", "{kind: ros_twist_publisher, topic: h, stamped: true, frame: base}", first_index=12),
    Component("range_in", "{kind: ros_message_subscriber, topic: i, message: sensor_msgs/Range}", first_index=18),
    Component(
        "range_out",
        "{kind: ros_message_publisher, topic: j, message: sensor_msgs/Range, constants: {header.frame_id: bumper}}",
        first_index=18,
    ),
    Component("answer", "{kind: ros_echo, from: ping, to: pong, type: int32}"),
    Component(
        "number",
        "{kind: constant, value: 0.1}",
    ),
]


@pytest.fixture(scope="session")
def catalog() -> Catalog:
    diagnostics = Diagnostics()
    loaded = load_catalog([TARGETS], diagnostics)
    assert diagnostics.error_count == 0
    return loaded


class Renderer:
    """The macros of a kind for one component, as :mod:`epg.generator.emit.application` calls them."""

    def __init__(self, catalog: Catalog, component: Component) -> None:
        diagnostics = Diagnostics()
        node = parse_yaml(component.text, "component.yaml", diagnostics)
        assert node is not None
        kind = catalog.find_kind(str(node["kind"].value))
        assert kind is not None
        parameters = typed_parameters(kind, node, diagnostics)
        parameters = with_messages(kind, parameters, node, [], diagnostics) or {}
        assert diagnostics.error_count == 0
        self.kind = kind = kind.of_component(parameters)
        value_index = {port.name: number for number, port in enumerate(kind.topic_ports, component.first_index or 0)}
        values = [SimpleNamespace(element=p.element, part=p.part, index=value_index[p.name]) for p in kind.topic_ports]
        self.view = SimpleNamespace(
            name=component.name,
            symbol=identifier(component.name),
            parameters=parameters,
            claims=component.claims,
            first_index=component.first_index,
            value_index=value_index,
            values=values,
            value_names={port: Code(str(index)) for port, index in value_index.items()},
            application=Code("app"),
            period=Fraction(1, 1000),
            write_period=Fraction(1, 1000),
            uses=component.uses,
            faults={fault.name: Code(str(fault.number)) for fault in kind.faults},
        )
        env = environment([TARGETS])
        template = env.get_template(f"components/{kind.name}/code.c.j2")
        self.module = template.make_module({"pi": env.globals["pi"]})

    def has(self, macro: str) -> bool:
        return hasattr(self.module, macro)

    def render(self, macro: str, *arguments: object) -> str:
        return str(getattr(self.module, macro)(self.view, *arguments)).strip()

    def functions(self) -> str:
        """All its macros as C functions."""
        name = self.view.name
        lines = [self.render("globals")] if self.has("globals") else []
        for macro in ("start", "sample", "safe"):
            body = self.render(macro) if self.has(macro) else ""
            lines.append(f"static inline void {name}_{macro}(void)\n{{\n{body}\n}}")
        if self.has("check"):
            lines.append(f"static inline epg_fault_t {name}_check(void)\n{{\nreturn {self.render('check')};\n}}")
        for point in ("cycle", "inputs", "model", "outputs", "topic"):
            body = self.render("probe", point) if self.has("probe") else ""
            lines.append(f"static inline void {name}_probe_{point}(void)\n{{\n{body}\n}}")
        if self.has("message"):
            layout = self.render("layout") if self.has("layout") else "NULL"
            lines.append(
                f"static const epg_topic_t {name}_topic = {{.message = &{self.render('message')}, .layout = {layout},"
                f" .size = {self.render('message_size')}, .count = {len(self.view.values)}}};"
            )
        value = Code("value")
        for port in self.kind.ports:
            port_name = port.name.replace(".", "_")
            published = self.kind.communication == "publish"
            write = "monitor" if published else "write"
            argument = "double *values, double value" if published else "double value"
            if port.direction == "source":
                text = self.render("read", port.name)
                lines.append(f"static inline double {name}_read_{port_name}(void)\n{{\nreturn {text};\n}}")
            else:
                if port.drive:
                    text = self.render("applied", port.name)
                    lines.append(f"static inline double {name}_applied_{port_name}(void)\n{{\nreturn {text};\n}}")
                prepare = self.render("prepare", port.name, value) if self.has("prepare") else ""
                text = self.render("write", port.name, value) if self.has("write") else ""
                if prepare:
                    lines.append(f"static inline void {name}_prepare_{port_name}(double value)\n{{\n{prepare}\n}}")
                    text = f"{name}_prepare_{port_name}(value);\n{text}"
                lines.append(f"static inline void {name}_{write}_{port_name}({argument})\n{{\n{text}\n}}")
            if port.direction == "source" and self.has("plant_write"):
                text = self.render("plant_write", port.name, value)
                lines.append(f"static inline void {name}_plant_write_{port_name}(double value)\n{{\n{text}\n}}")
            if port.direction == "sink" and port.actuator and self.has("plant_read"):
                text = self.render("plant_read", port.name)
                lines.append(f"static inline double {name}_plant_read_{port_name}(void)\n{{\nreturn 1.0 * {text};\n}}")
        return "\n".join(lines)


def header(renderers: list[Renderer]) -> str:
    """``generated.h``: drivers, all components, and functions that start all of them and make all of them safe."""
    includes = sorted({header for renderer in renderers for header in renderer.kind.headers})
    lines = [f'#include "{include}"' for include in includes]
    lines += [renderer.functions() for renderer in renderers]
    for macro in ("start", "safe"):
        calls = "\n".join(f"{renderer.view.name}_{macro}();" for renderer in renderers)
        lines.append(f"static void {macro}_all(void)\n{{\n{calls}\n}}")
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="session")
def program(catalog: Catalog, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("templates")
    renderers = [Renderer(catalog, component) for component in COMPONENTS_TRIED]
    (folder / "generated.h").write_text(header(renderers))
    port = [HOST / "src" / "port" / f"{name}.c" for name in PORT]
    sources = [HARNESS, *port, *runtime_sources(), *(s for s in component_sources() if s.stem != "uart")]
    return compile_program(folder / "templates", sources, includes=[folder, HOST / "include", HOST / "src"])


@pytest.mark.parametrize("name", names_in(HARNESS))
def test_generated_code(program: Path, name: str) -> None:
    done = run_program([program, name])
    assert done.returncode == 0, done.stderr


def test_every_kind_is_tried(catalog: Catalog) -> None:
    """Every kind that the host can simulate."""
    classes = {"digital_input", "digital_output", "pwm", "quadrature"}
    kinds = [catalog.find_kind(path.parent.name) for path in COMPONENTS.glob("*/component.yaml")]
    tried = {kind.name for kind in kinds if kind and {claim.resource_class for claim in kind.claims} <= classes}
    assert {Renderer(catalog, component).kind.name for component in COMPONENTS_TRIED} == tried


def test_generated_code_reads_well(catalog: Catalog) -> None:
    """The generated block of an encoder, as the user reads it."""
    assert Renderer(catalog, COMPONENTS_TRIED[2]).render("globals") == (
        "static const epg_quadrature_encoder_config_t encoder_gear_config = {\n"
        "    .decoder = {.pin_a = 14,\n"
        "                .pin_b = 15,\n"
        "                .instance = 1,\n"
        "                .slot = 2,\n"
        "                .pull_up = true},\n"
        "    .rad_per_count = 9.844747812030515e-05,"
        " /* one revolution: 4096.0 counts of the motor, gear 5625/361 */\n"
        "    .preset = 0.0,\n"
        "};\n"
        "static epg_quadrature_encoder_t encoder_gear;"
    )
