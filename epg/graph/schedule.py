# SPDX-License-Identifier: Apache-2.0
"""Draws the schedule of one control cycle, in the order of the generated code, with the communication beside it.

The boxes are in the order of time.  Their widths do not show durations, because EPG cannot know these.
"""

from __future__ import annotations

from epg.generator.dataclass import dataclass
from epg.generator.quantity import show
from epg.generator.resolve.application import Application, ResolvedComponent, Topic, Wire
from epg.graph.svg import Picture, width

_SMALL = 10.5
_LINE = 15.0
_GAP = 30.0
_PAD = 10.0


@dataclass(frozen=True)
class Stage:
    """One stage of a cycle: its name, and lines of text that describe its actions."""

    name: str
    lines: tuple[str, ...]
    style: str = "box"


def control_stages(app: Application) -> tuple[Stage, ...]:
    """The stages of the control loop between two ticks, in the order of the generated loop."""
    wait = (f"until {show(app.control.output_delay, 'time')}", "after the tick") if app.control.output_delay else ()
    sampled = tuple(c.name for c in app.components if _is_sampled(c))
    written = [f"{_source(wire)} = {wire.port.name}" for wire in app.outputs if not wire.component.kind.communication]
    told = [wire.port.name for wire in app.outputs if wire.component.kind.communication]
    stages = (
        Stage("sample", sampled),
        Stage("commands", (*_commands(app), "enable, faults")),
        Stage("inputs", (*(f"{wire.port.name} = {_source(wire)}" for wire in app.inputs), *_checks(app))),
        Stage("model", _step(app), "model"),
        Stage("wait", wait, "plain"),
        Stage("outputs", (*written, "disabled: safe outputs")),
        Stage("hand over", (*told, "statistics")),
    )
    return tuple(stage for stage in stages if stage.lines)


def _is_sampled(component: ResolvedComponent) -> bool:
    return not component.kind.communication and any(port.direction == "source" for port in component.kind.ports)


def _commands(app: Application) -> list[str]:
    """The lines about the setpoints and the fail-safe input, which can stop the robot."""
    topics = [topic for topic in app.subscriptions if topic.role == "values"]
    lines = [line for topic in topics for line in (f"newest {topic.name}", *_timeout(topic))]
    return lines if app.fail_safe is None else [*lines, f"fail-safe {app.fail_safe.name}"]


def _checks(app: Application) -> list[str]:
    """The lines about the guards."""
    guards = [component for component in app.components if component.uses and not component.kind.communication]
    return [line for guard in guards for line in (f"check {guard.name}", *_thresholds(guard))]


def _step(app: Application) -> tuple[str, ...]:
    """The lines about the step of the model."""
    each = f"every {app.step_divider} cycles" if app.step_divider > 1 else "one step"
    method = (app.model.method,) if app.model.method else ()
    return app.model.name, each, *method, "finite, else disable"


def _timeout(topic: Topic) -> list[str]:
    """The line about the timeout of a setpoint; none if it has none."""
    setpoint = next((value.setpoint for value in topic.values if value.setpoint and value.setpoint.timeout), None)
    return [f"older than {show(setpoint.timeout, 'time')}: {setpoint.on_timeout}"] if setpoint is not None else []


def _thresholds(component: ResolvedComponent) -> list[str]:
    """The lines about the limits that a guard checks, as its ``.tcf`` states them."""
    stated = [(key, node) for key, node in component.node.items() if node.is_mapping]
    return [f"{key}: {', '.join(f'{name} {value.value}' for name, value in node.items())}" for key, node in stated]


def _source(wire: Wire) -> str:
    return wire.component.kind.reference(wire.component.name, wire.component_port)


def draw_schedule(app: Application, title: str) -> str:
    """The picture as the text of an SVG file."""
    stages = control_stages(app)
    period = show(app.period, "time")
    words = "; then ".join(f"{stage.name}: {', '.join(stage.lines)}" for stage in stages)
    receive, send = (tuple(topic.name for topic in topics) for topics in (app.subscriptions, app.publications))
    communication = show(app.communication.period, "time")
    description = (
        f"Every {period}: {words}. Beside it, every {communication}: receive {', '.join(receive) or 'nothing'}; "
        f"send {', '.join(send) or 'nothing'}."
    )
    picture = Picture(f"{title}: one control cycle", description)
    high = 34 + _LINE * max(len(stage.lines) for stage in stages)
    x = 0.0
    centres: dict[str, float] = {}
    for number, stage in enumerate(stages):
        centre = x + _wide(stage) / 2
        _box(picture, centre, 0, high, stage)
        if number:
            picture.arrow([(x - _GAP, high / 2), (x, high / 2)])
        centres[stage.name] = centre
        x += _wide(stage) + _GAP
    timer = app.tick.resource if app.tick else "the system's timer"
    _axis(picture, x, period, timer)
    what = f"communication: {app.communication.middleware.name}, every {communication}"
    boxes = Stage("receive", receive or ("nothing",)), Stage("send", send or ("nothing",))
    _communication(picture, *boxes, what, centres, high)
    picture.text(x / 2, -76, title, "middle", 15, "bold")
    picture.text(x / 2, -58, "one control cycle; widths do not show durations", "middle", 11, "faint")
    return picture.render()


def _wide(stage: Stage) -> float:
    return 2 * _PAD + max(width(stage.name, 12), *(width(line, _SMALL) for line in stage.lines))


def _box(picture: Picture, centre: float, top: float, high: float, stage: Stage) -> None:
    picture.box(centre - _wide(stage) / 2, top, _wide(stage), high, stage.style)
    picture.text(centre, top + 18, stage.name, "middle", 12, "bold")
    for index, line in enumerate(stage.lines):
        picture.text(centre, top + 36 + index * _LINE, line, "middle", _SMALL)


def _axis(picture: Picture, end: float, period: str, timer: str) -> None:
    picture.arrow([(-10, -16), (end, -16)])
    picture.line([(0, -22), (0, -10)])
    picture.text(0, -28, "tick", "start", 11, "bold")
    picture.line([(end - 12, -22), (end - 12, -10)])
    picture.text(end, -28, f"next tick, {period} later", "end", 11, "bold")
    picture.text(width("tick", 11) + 10, -28, f"by {timer}", "start", _SMALL, "faint")


def _communication(
    picture: Picture, receive: Stage, send: Stage, title: str, centres: dict[str, float], high: float
) -> None:
    """Draws the communication side, which runs on the other core or in a context of lower priority.

    The two sides exchange complete sets of values.  Neither side waits for the other.
    """
    top = high + 60
    left, right = centres["commands"], centres["hand over"]
    for stage, centre, ends, side, anchor in (
        (receive, left, (top, high), 8, "start"),
        (send, right, (high, top), -8, "end"),
    ):
        _box(picture, centre, top, 34 + _LINE * len(stage.lines), stage)
        picture.arrow([(centre, end) for end in ends], "line", "the newest values, all at once")
        picture.text(centre + side, high + 28, "newest values,", anchor, _SMALL, "faint")
        picture.text(centre + side, high + 42, "without waiting", anchor, _SMALL, "faint")
    picture.text((left + right) / 2, top + 18, title, "middle", 12, "bold")
