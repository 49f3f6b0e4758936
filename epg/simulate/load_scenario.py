# SPDX-License-Identifier: Apache-2.0
"""Reads scenario files, with all checks that do not need the executable."""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.documents.items import map_of
from epg.generator.documents.schema import load_schema, validate
from epg.generator.documents.text_file import is_file
from epg.generator.documents.yaml_file import load_yaml
from epg.generator.quantity import QuantityError, dimension_of, normal_unit, parse_quantity
from epg.generator.source import Span, YamlNode
from epg.runs.scenario import Axis, Event, Homing, Profile, ProfilePart, Scenario, Window

#: the keys that each shape needs, beside ``shape`` and ``start``
_SHAPES = {
    "raised_cosine": ("duration", "height"),
    "move": ("duration", "to"),
    "ramp": ("duration", "to"),
    "step": ("to",),
    "sine": ("duration", "height", "frequency"),
}
_ACTIONS = ("enable", "setpoint", "lost", "stall", "component", "failure")
_NEEDED = {"setpoint": "topic", "component": "level", "failure": "target"}
_POSSIBLE = {"enable": ("target",), "lost": ("topic", "target"), "stall": ("target",)}
_SIGNAL = re.compile(r"([^/]+/)?(plant\.)?(inputs|outputs)\.[^/]+")
MAX_SETPOINTS = 2_000_000


def load_scenario(path: Path, diagnostics: Diagnostics) -> Scenario | None:
    """The scenario in ``path``.  None if it has mistakes; all of them are reported."""
    before = diagnostics.error_count
    root = load_yaml(path, diagnostics)
    if root is None or not validate(root, load_schema("scenario"), diagnostics):
        return None
    scenario = _Reader(diagnostics).scenario(path, root)
    return scenario if diagnostics.error_count == before else None


class _Reader:
    """Turns a validated tree into data.

    After a mistake, it goes on with a harmless value, so that all mistakes are found in one run.
    """

    def __init__(self, diagnostics: Diagnostics) -> None:
        self.diagnostics = diagnostics
        self.names: list[tuple[str, str, Span]] = []
        self.of_systems: list[Span] = []

    def scenario(self, path: Path, root: YamlNode) -> Scenario:
        duration = self.time(root["duration"], positive=True)
        interval = self.time(root["interval"], positive=True) if "interval" in root else Fraction(33, 1000)
        setpoints = map_of(root["setpoints"]) if "setpoints" in root else {}
        if duration / interval * len(setpoints) > MAX_SETPOINTS:
            node = root.get("interval") or root["duration"]
            message = f"this scenario sends more than {MAX_SETPOINTS} setpoints"
            self.error("too-many-setpoints", node, message, "use a longer interval")
        self.names += [("topic", topic, root["setpoints"].key_span(topic)) for topic in setpoints]
        profiles = {topic: self.profile(node, duration) for topic, node in setpoints.items()}
        reference = root.get("reference")
        if reference is not None and not is_file(path.parent / str(reference.value)):
            hint = did_you_mean(str(reference.value), [file.name for file in path.parent.glob("*.py")])
            self.error("file-not-found", reference, f"there is no file '{reference.value}'", hint)
        events = root.get("events")
        ends, ends_of = self.ends(root.get("ends"))
        return Scenario(
            path=path,
            duration=duration,
            interval=interval,
            reference=path.parent / str(reference.value) if reference is not None else None,
            profiles=profiles,
            events=tuple(self.event(node, duration, profiles) for node in (events.elements() if events else ())),
            axes=tuple(self.axis(name, node, duration, profiles) for name, node in root["axes"].items()),
            ends=ends,
            ends_of=ends_of,
            names=tuple(self.names),
            of_systems=tuple(self.of_systems),
        )

    def ends(self, node: YamlNode | None) -> tuple[str, dict[str, str]]:
        """The expected end, and those of single targets of a system."""
        if node is None or not node.is_mapping:
            return "enabled" if node is None else str(node.value), {}
        self.of_systems.append(node.span)
        self.names += [("target", target, node.key_span(target)) for target, _ in node.items()]
        return "enabled", {target: str(end.value) for target, end in node.items()}

    def profile(self, node: YamlNode, duration: Fraction) -> Profile:
        initial = self.value(node["initial"]) if "initial" in node else 0.0
        listed = node.get("profile")
        parts: list[ProfilePart] = []
        for element in listed.elements() if listed else ():
            part = self.part(element)
            if parts and part.start < parts[-1].end:
                self.error(
                    "overlapping-parts",
                    element["start"],
                    f"this part starts before the previous one ends, at {parts[-1].end:g} s",
                )
            if part.end > duration:
                message = f"this part ends at {part.end:g} s, but the run ends at {float(duration):g} s"
                self.error("beyond-duration", element["start"], message)
            parts.append(part)
        return Profile(initial, tuple(parts))

    def part(self, node: YamlNode) -> ProfilePart:
        shape = str(node["shape"].value)
        needed = _SHAPES[shape]
        for key in needed:
            if key not in node:
                self.error("missing-key", node["shape"], f"'{key}' is missing: a {shape} needs {', '.join(needed)}")
        for key, _ in node.items():
            if key not in (*needed, "shape", "start"):
                self.diagnostics.error(
                    "unknown-key", node.key_span(key), f"a {shape} has no '{key}'", hint=f"it needs {', '.join(needed)}"
                )
        target = node.get("to") or node.get("height")
        return ProfilePart(
            shape,
            float(self.time(node["start"])),
            float(self.time(node["duration"], positive=True)) if "duration" in node else 0.0,
            self.value(target) if target else 0.0,
            float(self.quantity(node["frequency"], "frequency")) if "frequency" in node else 0.0,
        )

    def event(self, node: YamlNode, duration: Fraction, profiles: Mapping[str, Profile]) -> Event:
        """One event.  After a mistake, an event that does nothing."""
        at, action = self.time(node["at"]), self.action(node)
        if action is None:
            return Event(at, "none")
        if at >= duration:
            self.error("beyond-duration", node["at"], f"the run ends at {float(duration):g} s")
        topic = self.topic(node["topic"], profiles) if "topic" in node else ""
        target = self.target(node["target"]) if "target" in node else ""
        if action == "enable":
            return Event(at, "enable" if node["enable"].value else "disable", target=target)
        if action == "failure":
            return Event(at, str(node["failure"].value), target=target)
        if action == "setpoint":
            return Event(at, "setpoint", topic, self.value(node["setpoint"], finite=False))
        if action == "component":
            name, level = str(node["component"].value), node["level"].value
            self.names.append(("input", name, node["component"].span))
            return Event(at, action, component=name, level=str(int(level)) if isinstance(level, bool) else str(level))
        return Event(at, action, topic, duration=self.time(node[action], positive=True), target=target)

    def action(self, node: YamlNode) -> str | None:
        """The action of an event.  None after a mistake with which the event means nothing."""
        actions = [key for key, _ in node.items() if key in _ACTIONS]
        if len(actions) != 1:
            message = f"an event must have one action, and this one has {' and '.join(actions)}"
            message = message if actions else "this event has no action"
            self.error("wrong-event", node["at"], message, f"write one of {', '.join(_ACTIONS)}")
            return None
        action = actions[0]
        needed, possible = _NEEDED.get(action), _POSSIBLE.get(action, ())
        if needed and needed not in node:
            self.error("missing-key", node[action], f"'{needed}' is missing beside '{action}'")
            return None
        for key, value in node.items():
            if key not in ("at", action, needed, *possible):
                self.error("unknown-key", value, f"'{key}' has no meaning beside '{action}'")
        if action == "lost" and "topic" in node and "target" in node:
            self.error("unknown-key", node["target"], "'target' has no meaning beside 'topic'")
        return action

    def target(self, node: YamlNode) -> str:
        self.of_systems.append(node.span)
        self.names.append(("target", str(node.value), node.span))
        return str(node.value)

    def axis(self, name: str, node: YamlNode, duration: Fraction, profiles: Mapping[str, Profile]) -> Axis:
        setpoint = node["setpoint"]
        follows_signal = _SIGNAL.fullmatch(str(setpoint.value)) is not None
        topic = str(setpoint.value) if follows_signal else self.topic(setpoint, profiles)
        listed = node.get("windows")
        windows = tuple(self.window(element, duration) for element in (listed.elements() if listed else ()))
        if not windows:
            start, end = (profiles[topic].span if topic in profiles else None) or (0.0, float(duration))
            windows = (Window(start, end),)
        duty, homing, unit = node.get("duty"), node.get("homing"), node.get("unit")
        if homing is not None and "duty" in homing and duty is None:
            message = f"'duty' is missing in 'axes.{name}': it must name the signal that is limited here"
            self.error("missing-key", homing["duty"], message, "write for example 'duty: outputs.pwm_pan'")
        return Axis(
            name=name,
            setpoint=topic,
            position=str(node["position"].value),
            duty=str(duty.value) if duty else None,
            unit=normal_unit(str(unit.value)) if unit else "rad",
            homing=self.homing(homing, duration) if homing else None,
            windows=windows,
            signals=self.signals(node["position"], duty, setpoint if follows_signal else None),
            follows_signal=follows_signal,
        )

    def signals(self, *nodes: YamlNode | None) -> tuple[str, ...]:
        named = tuple((str(node.value), node.span) for node in nodes if node is not None)
        self.names += [("signal", name, span) for name, span in named]
        return tuple(name for name, _ in named)

    def homing(self, node: YamlNode, duration: Fraction) -> Homing:
        duty = node.get("duty")
        return Homing(
            self.within(node["until"], duration),
            float(str(duty.value)) if duty else None,
            self.value(node["position"]) if "position" in node else None,
        )

    def window(self, node: YamlNode, duration: Fraction) -> Window:
        start, end = self.within(node["from"], duration), self.within(node["until"], duration)
        if end <= start:
            self.error("wrong-value", node["until"], "the window ends before it begins")
        limits = (self.value(node[key]) if key in node else None for key in ("rms", "largest"))
        return Window(start, end, *limits)

    def topic(self, node: YamlNode, profiles: Mapping[str, Profile]) -> str:
        topic = str(node.value)
        if topic not in profiles:
            hint = did_you_mean(topic, profiles, "topics")
            self.error("unknown-topic", node, f"the scenario sends no setpoints on '{topic}'", hint)
        return topic

    def within(self, node: YamlNode, duration: Fraction) -> float:
        time = self.time(node)
        if time > duration:
            self.error("beyond-duration", node, f"the run ends at {float(duration):g} s")
        return float(time)

    def time(self, node: YamlNode, *, positive: bool = False) -> Fraction:
        time = self.quantity(node, "time")
        if time < 0 or (positive and time == 0):
            least = "more than" if positive else "at least"
            self.error("out-of-range", node, f"'{node.value}' is out of range: must be {least} 0 s")
            return Fraction(1)
        return Fraction(time)

    def quantity(self, node: YamlNode, dimension: str) -> Fraction | float:
        try:
            return parse_quantity(node.value, dimension)
        except QuantityError as problem:
            self.error("wrong-quantity", node, str(problem), problem.hint)
            return Fraction(1)

    def value(self, node: YamlNode, *, finite: bool = True) -> float:
        """The value of a number, or of a quantity in the base unit of its dimension (rad for deg)."""
        if isinstance(node.value, (int, float)) and not isinstance(node.value, bool):
            value = float(node.value)
            if finite and value - value != 0:
                self.error("wrong-value", node, "the value must be finite here")
                return 0.0
            return value
        text = str(node.value).split(None, 1)
        dimension = dimension_of(text[1]) if len(text) == 2 else None
        return float(self.quantity(node, dimension or "angle"))

    def error(self, id: str, node: YamlNode, message: str, hint: str = "") -> None:
        self.diagnostics.error(id, node.span, message, hint=hint)
