# SPDX-License-Identifier: Apache-2.0
"""Reads a system file, with all checks that do not need the files of its targets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType

from epg.generator.check.communication import time_of
from epg.generator.check.target_names import check_name
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.documents.items import map_of
from epg.generator.documents.schema import load_schema, validate
from epg.generator.documents.yaml_file import load_yaml, newer_version
from epg.generator.importers.by_hand.model_yaml import step_of
from epg.generator.source import Span, YamlNode
from epg.system.system import Connection, End, SimulatedClock, System, SystemPlant, SystemTarget, Transport

_PARAMETERS = ("type", "unit", "qos")


def load_system(path: Path, diagnostics: Diagnostics, wanted_by: Span | None = None) -> System | None:
    """The system in ``path``, or None after reporting mistakes."""
    errors = diagnostics.error_count
    system = parse_system(path, diagnostics, wanted_by)
    return system if diagnostics.error_count == errors else None


def parse_system(path: Path, diagnostics: Diagnostics, wanted_by: Span | None = None) -> System | None:
    """The system in ``path``, without the connections that have mistakes.

    Reports all mistakes.  None if the file is not a system at all: it cannot be read, or has wrong keys or values.
    """
    root = load_yaml(path, diagnostics, wanted_by)
    if root is None or (root.is_mapping and newer_version(root, "version", diagnostics)):
        return None
    if root.is_mapping and "target" in root and "components" in root and "system" not in root:
        message = "this is a target configuration, not a system"
        hint = "name a *.system.yaml; 'epg connect' and your project's CMake targets take a single target"
        diagnostics.error("system-is-tcf", root.key_span("target"), message, hint=hint)
        return None
    if not validate(root, load_schema("system"), diagnostics):
        return None
    return _Reader(path, diagnostics).system(root)


@dataclass
class _Reader:
    """``groups`` maps each name in the file to the names of its targets: several with ``count``."""

    path: Path
    diagnostics: Diagnostics
    groups: dict[str, tuple[str, ...]] = field(default_factory=dict)
    targets: dict[str, SystemTarget] = field(default_factory=dict)

    def system(self, root: YamlNode) -> System:
        section = root["targets"]
        for name, node in section.items():
            self.add_targets(name, node, section.key_span(name))
        self.check_serials(section)
        listed = root.get("connections")
        connections = [pair for node in (listed.elements() if listed else ()) for pair in self.connections(node)]
        sends = root.get("world", "sends")
        world = [end for node in (sends.elements() if sends else ()) for end in self.world(node)]
        self.check_receivers(connections, world)
        plant = self.plant(root.get("plant"))
        return System(str(root["system"].value), self.path, self.targets, tuple(connections), tuple(world), plant)

    def plant(self, node: YamlNode | None) -> SystemPlant | None:
        if node is None:
            return None
        stated = node.get("period")
        return SystemPlant(
            model=self.path.parent / str(node["model"].value),
            bindings=self.path.parent / str(node["bindings"].value),
            period=None if stated is None else step_of(stated, self.diagnostics),
            span=node.span,
            period_span=node.span if stated is None else stated.span,
        )

    # Targets -------------------------------------------------------------------------------------------------------

    def add_targets(self, name: str, node: YamlNode, span: Span) -> None:
        count = node.get("count")
        number = count.value if count is not None and isinstance(count.value, int) else 0
        names = tuple(f"{name}_{i}" for i in range(1, number + 1)) if number else (name,)
        self.groups[name] = names
        serials, probes = (self.serials(node.get(key), len(names)) for key in ("serial", "probe"))
        for target, serial, probe in zip(names, serials, probes):
            check_name(target, span, self.diagnostics)
            other = self.targets.get(target)
            if other is not None:
                message = f"there are two targets '{target}'"
                self.diagnostics.error("duplicate-target", span, message, notes=[Note("the other one", other.span)])
            settings = node.get("set")
            self.targets[target] = SystemTarget(
                name=target,
                tcf=str(node["tcf"].value),
                model=self.path.parent / str(node["model"].value),
                bindings=self.path.parent / str(node["bindings"].value),
                plant=self.file(node, "plant"),
                plant_bindings=self.file(node, "plant_bindings"),
                settings=settings,
                serial=serial,
                probe=probe,
                project=self.project(node.get("project")),
                clock=self.clock(node.get("clock")),
                span=span,
            )

    def clock(self, node: YamlNode | None) -> SimulatedClock:
        if node is None:
            return SimulatedClock()
        drift = node.get("drift")
        parts = float(drift.value) if drift is not None and isinstance(drift.value, (int, float)) else 0.0
        return SimulatedClock(self.time(node, "start", Fraction(0)), round(1000 * parts))

    def time(self, node: YamlNode, key: str, default: Fraction) -> Fraction:
        seconds = time_of(node.get(key), self.diagnostics)
        return default if seconds is None else seconds

    def file(self, node: YamlNode, key: str) -> Path | None:
        found = node.get(key)
        return None if found is None else self.path.parent / str(found.value)

    def project(self, node: YamlNode | None) -> Path | None:
        """The folder of a firmware project, or None after reporting that there is no project."""
        if node is None:
            return None
        folder = self.path.parent / str(node.value)
        if not (folder / "CMakeLists.txt").is_file():
            hint = "name the folder of the CMakeLists.txt that calls epg_add_target(... SYSTEM ...)"
            self.diagnostics.error(
                "file-not-found", node.span, f"there is no CMakeLists.txt in '{node.value}'", hint=hint
            )
            return None
        return folder

    def serials(self, node: YamlNode | None, count: int) -> Sequence[str | None]:
        if node is None:
            return [None] * count
        serials = [str(element.value) for element in node.elements()] if node.is_sequence else [str(node.value)]
        if len(serials) != count:
            message = f"there are {count} targets and {len(serials)} serial numbers"
            hint = "write one serial number for each target: [..., ...]"
            self.diagnostics.error("wrong-value", node.span, message, hint=hint)
            return [None] * count
        return serials

    def check_serials(self, section: YamlNode) -> None:
        """Reports boards and debug probes that two targets name."""
        seen: dict[str, Span] = {}
        for _, node in section.items():
            stated = [number for key in ("serial", "probe") if (number := node.get(key)) is not None]
            for element in (element for number in stated for element in number.elements() or (number,)):
                first = seen.setdefault(str(element.value), element.span)
                if first != element.span:
                    message = f"serial number '{element.value}' belongs to another target already"
                    notes = [Note("the other one", first)]
                    self.diagnostics.error("duplicate-serial", element.span, message, notes=notes)

    # Connections ---------------------------------------------------------------------------------------------------

    def connections(self, node: YamlNode) -> list[Connection]:
        """The connections of one entry: a sender for each receiver, one by one, or one sender for all."""
        parameters = MappingProxyType({key: value for key, value in map_of(node).items() if key in _PARAMETERS})
        loss = node.get("loss")
        transport = Transport(
            delay=self.time(node, "delay", Transport.delay),
            jitter=self.time(node, "jitter", Transport.jitter),
            loss=float(loss.value) if loss is not None and isinstance(loss.value, (int, float)) else 0.0,
        )
        senders = self.ends(node["from"])
        result = []
        for element in node["to"].elements() or (node["to"],):
            receivers = self.ends(element)
            if not senders or not receivers:
                continue
            if len(senders) not in (1, len(receivers)):
                message = f"{len(senders)} targets cannot send to {self.amount(receivers)}"
                hint = "connect targets with the same 'count', or one target with others"
                self.diagnostics.error("connection-counts", element.span, message, hint=hint)
                continue
            paired = senders * len(receivers) if len(senders) == 1 else senders
            result += [
                Connection(sender, receiver, parameters, transport) for sender, receiver in zip(paired, receivers)
            ]
        for connection in result:
            if connection.sender.target == connection.receiver.target:
                message = f"'{connection.sender.target}' is connected with itself"
                hint = "connect the ports in the model, or name another target"
                self.diagnostics.error("connection-to-itself", connection.receiver.span, message, hint=hint)
        return result

    def world(self, node: YamlNode) -> list[End]:
        """The ends that other programs send to: each with a topic of its own, or all with the same."""
        if not node.is_mapping:
            return self.ends(node)
        topic = str(node["topic"].value)
        ends = [end for element in node["to"].elements() or (node["to"],) for end in self.ends(element)]
        return [replace(end, topic=topic) for end in ends]

    def amount(self, ends: Sequence[End]) -> str:
        return "one target" if len(ends) == 1 else f"{len(ends)} targets"

    def ends(self, node: YamlNode) -> list[End]:
        """The ends that ``target/port`` names: one for each target of a group.  Reports unknown targets."""
        name, _, port = str(node.value).partition("/")
        targets = self.groups.get(name) or ((name,) if name in self.targets else ())
        if not targets:
            hint = did_you_mean(name, {*self.groups, *self.targets}, "targets")
            self.diagnostics.error("unknown-target", node.span, f"this system has no target '{name}'", hint=hint)
        return [End(target, port, node.span) for target in targets]

    def check_receivers(self, connections: Sequence[Connection], world: Sequence[End]) -> None:
        """Reports ports that receive values from two senders.  A topic component receives one topic."""
        ports: dict[tuple[str, str], Span] = {}
        components: dict[tuple[str, str], tuple[str, Span]] = {}
        received = [(c.receiver, f"'{c.sender.target}/{c.sender.component}'") for c in connections]
        received += [(end, "other programs") for end in world]
        for end, sender in received:
            first, span = components.setdefault((end.target, end.component), (sender, end.span))
            written = ports.setdefault((end.target, end.port), end.span)
            if first == sender and written is end.span:
                continue
            message = f"'{end}' receives values from {first} already"
            hint = "remove one of the two, or receive them by two topic components"
            notes = [Note("connected here", written if first == sender else span)]
            self.diagnostics.error("two-senders", end.span, message, hint=hint, notes=notes)
