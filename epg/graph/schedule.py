# SPDX-License-Identifier: Apache-2.0
"""Draws the schedule of one control cycle, in the order of the generated code, with the communication beside it.

The boxes are in the order of time.  Their widths do not show durations, because EPG cannot know these.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from epg.graph.svg import Picture, width
from epg.quantity import show
from epg.resolve.application import Application, Topic, Wire

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
    """The stages of the control loop between two ticks, in order."""
    sampled = [
        c for c in app.components if any(p.direction == "source" for p in c.kind.ports) and not c.kind.communication
    ]
    setpoints = [topic.name for topic in app.subscriptions if topic.role == "values"]
    guards = [c for c in app.components if c.uses]
    stages = [Stage("sample", tuple(c.name for c in sampled))] if sampled else []
    commands = [f"newest {name}" for name in setpoints]
    if app.fail_safe is not None:
        commands.append(f"fail-safe {app.fail_safe.name}")
    stages.append(Stage("commands", (*commands, "enable, faults")))
    read = [f"{wire.port.name} = {_source(wire)}" for wire in app.inputs]
    stages.append(Stage("inputs", (*read, *(f"check {c.name}" for c in guards if not c.kind.communication))))
    each = f"every {app.step_divider} cycles" if app.step_divider > 1 else "one step"
    method = (app.model.method,) if app.model.method else ()
    stages.append(Stage("model", (app.model.name, each, *method, "finite, else disable"), "model"))
    if app.control.output_delay:
        stages.append(Stage("wait", (f"until {show(app.control.output_delay, 'time')}", "after the tick"), "plain"))
    written = [f"{_source(wire)} = {wire.port.name}" for wire in app.outputs if not wire.component.kind.communication]
    stages.append(Stage("outputs", (*written, "disabled: safe outputs") if written else ("disabled: safe outputs",)))
    told = [wire.port.name for wire in app.outputs if wire.component.kind.communication]
    stages.append(Stage("hand over", (*told, "statistics")))
    return tuple(stages)


def _source(wire: Wire) -> str:
    main = wire.component.kind.main_port(wire.component_port.direction)
    return wire.component.name if wire.component_port == main else f"{wire.component.name}.{wire.component_port.name}"


def draw_schedule(app: Application, title: str) -> str:
    """The picture as the text of an SVG file."""
    stages = control_stages(app)
    period = show(app.period, "time")
    words = "; then ".join(f"{stage.name}: {', '.join(stage.lines)}" for stage in stages)
    receive, send = _topics(app.subscriptions), _topics(app.publications)
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
        wide = 2 * _PAD + max(width(stage.name, 12), *(width(line, _SMALL) for line in stage.lines))
        picture.box(x, 0, wide, high, stage.style)
        picture.text(x + wide / 2, 18, stage.name, "middle", 12, "bold")
        for index, line in enumerate(stage.lines):
            picture.text(x + wide / 2, 36 + index * _LINE, line, "middle", _SMALL)
        if number:
            picture.arrow([(x - _GAP, high / 2), (x, high / 2)])
        centres[stage.name] = x + wide / 2
        x += wide + _GAP
    end = x
    _axis(picture, end, period, app, centres)
    _communication(picture, receive, send, communication, app, centres, high)
    picture.text(end / 2, -76, title, "middle", 15, "bold")
    picture.text(end / 2, -58, "one control cycle; widths do not show durations", "middle", 11, "faint")
    return picture.render()


def _axis(picture: Picture, end: float, period: str, app: Application, centres: dict[str, float]) -> None:
    picture.arrow([(-10, -16), (end, -16)])
    picture.line([(0, -22), (0, -10)])
    picture.text(0, -28, "tick", "start", 11, "bold")
    picture.line([(end - 12, -22), (end - 12, -10)])
    picture.text(end, -28, f"next tick, {period} later", "end", 11, "bold")
    timer = app.tick.resource if app.tick else "the system's timer"
    picture.text(width("tick", 11) + 10, -28, f"by {timer}", "start", _SMALL, "faint")


def _communication(
    picture: Picture,
    receive: Sequence[str],
    send: Sequence[str],
    period: str,
    app: Application,
    centres: dict[str, float],
    high: float,
) -> None:
    """Draws the communication side, which runs on the other core or in a context of lower priority.

    The two sides exchange complete sets of values.  Neither side waits for the other.
    """
    top = high + 60
    middleware = app.communication.middleware.name
    lines = (("receive", receive, "commands", -1), ("send", send, "hand over", 1))
    for name, topics, stage, direction in lines:
        texts = list(topics) or ["nothing"]
        wide = 2 * _PAD + max(width(name, 12), *(width(text, _SMALL) for text in texts))
        centre = centres[stage]
        picture.box(centre - wide / 2, top, wide, 34 + _LINE * len(texts), "box")
        picture.text(centre, top + 18, name, "middle", 12, "bold")
        for index, text in enumerate(texts):
            picture.text(centre, top + 36 + index * _LINE, text, "middle", _SMALL)
        points = [(centre, top), (centre, high)] if direction < 0 else [(centre, high), (centre, top)]
        picture.arrow(points, "line", "the newest values, all at once")
        side = 8 if direction < 0 else -8
        anchor = "start" if direction < 0 else "end"
        picture.text(centre + side, high + 28, "newest values,", anchor, _SMALL, "faint")
        picture.text(centre + side, high + 42, "without waiting", anchor, _SMALL, "faint")
    left, right = centres["commands"], centres["hand over"]
    picture.text((left + right) / 2, top + 18, f"communication: {middleware}, every {period}", "middle", 12, "bold")


def _topics(topics: Sequence[Topic]) -> list[str]:
    return [topic.name for topic in topics]
