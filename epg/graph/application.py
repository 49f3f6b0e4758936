# SPDX-License-Identifier: Apache-2.0
"""Draws the application: the inputs from topics and pins to the model, and the outputs from the model.

Each port of the model has one line: topic or pins, component, conversion, port.  Components that are not bound to a
port are below, with the components that they use.
"""

from __future__ import annotations

from collections.abc import Sequence

from epg.generator.dataclass import dataclass
from epg.generator.emit.topics import Topics
from epg.generator.models.model import Port
from epg.generator.quantity import show
from epg.generator.resolve.application import Application, ConversionStep, ResolvedComponent, Wire
from epg.graph.svg import Picture, width
from epg.graph.terminals import wire_texts

_ROW = 40.0
_HIGH = 30.0
_GAP = 34.0  # the width between two columns, for an arrow
_SMALL = 10.0


@dataclass(frozen=True)
class _Line:
    """One port of the model, with the boxes of its component and of its topic or pins.

    ``component`` and ``outside`` are the first and the second row of text in these boxes.
    """

    port: Port
    wire: Wire | None
    component: tuple[str, str]
    outside: tuple[str, str]
    conversion: str


def draw_application(app: Application, topics: Topics, title: str) -> str:
    """The picture as the text of an SVG file."""
    views = {
        view.topic.component.name: view.ros_type
        for view in (*topics.subscriptions, *topics.publications)
        if view.topic.component
    }
    inputs = [_line(wire.port, wire, views, app) for wire in app.inputs]
    outputs = [_line(wire.port, wire, views, app) for wire in app.outputs]
    bound = {wire.port.name for wire in app.outputs}
    outputs += [_line(port, None, views, app) for port in app.model.outputs if port.name not in bound]
    picture = Picture(f"{title}: the application", _description(inputs, outputs, app))
    model_wide = (
        2 * 12
        + 24
        + max(
            _widest([_told(line.port) for line in inputs]) + _widest([_told(line.port) for line in outputs]),
            width(app.model.name, 13),
        )
    )
    rows = max(len(inputs), len(outputs), 1)
    picture.box(0, 0, model_wide, rows * _ROW + 34, "model", app.model.origin)
    picture.text(model_wide / 2, 16, app.model.name, "middle", 13, "bold")
    picture.text(model_wide / 2, 30, _model_facts(app), "middle", _SMALL, "faint")
    _side(picture, inputs, -1, 0)
    _side(picture, outputs, 1, model_wide)
    _others(picture, app, rows * _ROW + 34 + 30)
    _heading(picture, app, title, model_wide)
    return picture.render()


def _line(port: Port, wire: Wire | None, types: dict[str, str], app: Application) -> _Line:
    if wire is None:
        return _Line(port, None, ("", ""), ("", ""), "unconnected")
    component = wire.component
    name = component.kind.reference(component.name, wire.component_port)
    reaches = port.direction == "input" or not any(p.direction == "source" for p in component.kind.ports)
    beyond = outside(component, types, app) if reaches else ("", "")  # an output that resets a sensor does not use pins
    return _Line(port, wire, (name, component.kind.name), beyond, conversion(wire.steps))


def outside(component: ResolvedComponent, types: dict[str, str], app: Application) -> tuple[str, str]:
    """The connection of a component to the outside: its topic and message, or its pins and peripherals."""
    for topic in (*app.subscriptions, *app.publications):
        if topic.component is not None and topic.component.name == component.name:
            return topic.name, types.get(component.name, "")
    pins = pin_texts(component, app)
    resources = dict.fromkeys(found.resource for found in component.claims.values() if found.pins_are_real or not pins)
    peripherals = [name for name in resources if not name.startswith("pin ")]
    return (", ".join(pins), ", ".join(peripherals)) if pins else (", ".join(peripherals), "")


def pin_texts(component: ResolvedComponent, app: Application) -> list[str]:
    """The pin of each signal of a component, such as ``a GP10``.  Empty if the target has no pins."""
    return wire_texts(component.kind, component.claims, app.target)


def conversion(steps: Sequence[ConversionStep]) -> str:
    """The conversion of a wire as text, in the order of its steps: ``×0.5 +1 in -1…1``.  Empty if there is none."""
    parts = []
    for step in steps:
        scale, offset = float(step.scale), step.offset
        parts += [f"×{scale:.6g}"] if scale != 1 else []
        parts += [f"{offset:+.6g}"] if offset != 0 else []
        parts += [f"in {step.limits[0]:.6g}…{step.limits[1]:.6g}"] if step.limits else []
    return " ".join(parts)


def _told(port: Port) -> str:
    return f"{port.name} {{{port.unit}}}" if port.unit else port.name


def _widest(texts: Sequence[str], size: float = 11) -> float:
    return max((width(text, size) for text in texts), default=0)


def _side(picture: Picture, lines: Sequence[_Line], sign: int, x: float) -> None:
    """Draws the lines of one side.  ``x`` is the edge of the model; ``sign`` is -1 on the left and 1 on the right."""
    wide = 16 + max(
        _widest([line.component[0] for line in lines]), _widest([line.component[1] for line in lines], _SMALL)
    )
    out = 16 + max(_widest([line.outside[0] for line in lines]), _widest([line.outside[1] for line in lines], _SMALL))
    gap = _GAP + _widest([line.conversion for line in lines], _SMALL)
    anchor = "start" if sign < 0 else "end"
    for index, line in enumerate(lines):
        y = 34 + index * _ROW + _ROW / 2 - 2
        picture.text(x - sign * 12, y + 4, _told(line.port), anchor, 11)
        near, far = x + sign * gap, x + sign * (gap + wide)
        picture.text(x + sign * gap / 2, y - 4, line.conversion, "middle", _SMALL, "faint")
        if line.wire is None:
            picture.line([(x, y), (near, y)], "plain")
            continue
        _arrow(picture, near, x, y, sign, line)
        _box(picture, near, sign, wide, y, line.component, "box", line.wire.component.kind.summary)
        if line.outside[0] or line.outside[1]:
            beyond = far + sign * _GAP
            _arrow(picture, beyond, far, y, sign, line)
            _box(picture, beyond, sign, out, y, line.outside, "plain")


def _arrow(picture: Picture, outer: float, inner: float, y: float, sign: int, line: _Line) -> None:
    assert line.wire is not None
    title = f"{line.port.name}: {line.wire.component.name}"
    picture.arrow([(outer, y), (inner, y)] if sign < 0 else [(inner, y), (outer, y)], "line", title)


def _box(
    picture: Picture, x: float, sign: int, wide: float, y: float, rows: tuple[str, str], style: str, title: str = ""
) -> None:
    left = x if sign > 0 else x - wide
    picture.box(left, y - _HIGH / 2, wide, _HIGH, style, title)
    first = y - 2 if rows[1] else y + 4
    picture.text(left + wide / 2, first, rows[0], "middle", 11, "bold" if style == "box" else "")
    picture.text(left + wide / 2, y + 10, rows[1], "middle", _SMALL, "faint")


def _others(picture: Picture, app: Application, y: float) -> None:
    """Draws the components that are not bound to a port, with the components and pins that they use."""
    bound = {wire.component.name for wire in (*app.inputs, *app.outputs)}
    x = 0.0
    for component in app.components:
        if component.name in bound:
            continue
        uses = ", ".join(f"{use} {used.component}" for use, used in component.uses.items())
        second = ", ".join(part for part in (component.kind.name, uses, *pin_texts(component, app)) if part)
        wide = 16 + max(width(component.name, 11), width(second, _SMALL))
        _box(picture, x, 1, wide, y + _HIGH / 2, (component.name, second), "box", component.kind.summary)
        y += _ROW


def _model_facts(app: Application) -> str:
    each = f", every {app.step_divider} cycles" if app.step_divider > 1 else ""
    return f"step {show(app.model.step, 'time')}{each}"


def _heading(picture: Picture, app: Application, title: str, model_wide: float) -> None:
    communication = app.communication
    words = [f"node {app.namespace.rstrip('/')}/{app.node}" if app.namespace else f"node {app.node}"]
    words.append(app.target.name)
    words.append(
        communication.middleware.name + (f" over {communication.transport}" if communication.transport else "")
    )
    words.append(f"control period {show(app.period, 'time')}")
    picture.text(model_wide / 2, -34, title, "middle", 15, "bold")
    picture.text(model_wide / 2, -16, ", ".join(words), "middle", 11, "faint")


def _description(inputs: Sequence[_Line], outputs: Sequence[_Line], app: Application) -> str:
    def way(line: _Line, words: list[str]) -> str:
        return " to ".join(word for word in words if word) + (f" ({line.conversion})" if line.conversion else "")

    told = [
        way(line, [" ".join(line.outside).strip(), line.component[0], f"input {line.port.name}"]) for line in inputs
    ]
    told += [
        way(line, [f"output {line.port.name}", line.component[0], " ".join(line.outside).strip()]) for line in outputs
    ]
    return f"The model {app.model.name}. " + "; ".join(told) + "."
