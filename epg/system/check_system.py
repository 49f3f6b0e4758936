# SPDX-License-Identifier: Apache-2.0
"""Checks a system as a whole: whether the two ends of each connection fit, and whether each input has a sender."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from epg.generator.check.middleware import offered
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.emit.macros import Macros
from epg.generator.emit.symbols import TEMPLATES
from epg.generator.emit.template import environment
from epg.generator.emit.topics import TopicView, topics_of
from epg.generator.quantity import conversion_factor, dimension_of, show
from epg.generator.resolve.application import Application, Plant, Topic, Wire
from epg.system.loader import Loader
from epg.system.loops import loops_of
from epg.system.plant import check_plant, load_plant
from epg.system.ranges import Range, received_range, sent_range
from epg.system.system import Connection, End, System

_BY_NAME = ("sensor_msgs/msg/JointState",)
"""Messages that name their elements, so that a receiver finds the elements that it needs in any order."""


@dataclass(frozen=True)
class Link:
    """A connection whose two ends are known.

    ``period`` is the time in seconds between two messages.  ``age`` is the longest time from the sender's cycle to the
    cycle of the receiver that uses its value, without the transport.
    """

    connection: Connection
    message: str
    unit: str
    on_change: bool
    period: Fraction
    age: Fraction

    @property
    def sent(self) -> str:
        """The times at which a message is sent, for the user."""
        return "on change" if self.on_change else f"every {show(self.period, 'time')}"


@dataclass(frozen=True)
class Loop:
    """A loop with the delay in seconds that its connections add at most, without the transport."""

    targets: tuple[str, ...]
    age: Fraction

    def __str__(self) -> str:
        way = " -> ".join((*self.targets, self.targets[0]))
        return f"loop {way}: a value is up to {show(self.age, 'time')} old when it comes back, and the transport's time"


@dataclass(frozen=True)
class CheckedSystem:
    """A system with the applications of all targets, and the loader that has read them."""

    system: System
    loader: Loader
    applications: Mapping[str, Application]
    links: Sequence[Link]
    loops: Sequence[Loop]
    plant: Plant | None = None

    @property
    def plant_wires(self) -> Mapping[str, int]:
        """The number of wires between the plant of the system and each of its targets."""
        wires = () if self.plant is None else (*self.plant.inputs, *self.plant.outputs)
        return Counter(wire.component.name.partition("/")[0] for wire in wires)


def check_system(system: System, user_roots: Sequence[Path], diagnostics: Diagnostics) -> CheckedSystem | None:
    """The system with all of its targets, or None after reporting the mistakes in all files."""
    loader = Loader(user_roots, diagnostics)
    requests = ((name, system.request(target, user_roots)) for name, target in system.targets.items())
    return check_whole(system, loader, loader.applications(requests), diagnostics)


def check_whole(
    system: System, loader: Loader, applications: Mapping[str, Application], diagnostics: Diagnostics
) -> CheckedSystem | None:
    """The system with the ``applications`` of its targets, which have been checked one by one.

    None if a target has no application, because of its mistakes, or after reporting mistakes of the plant.
    """
    errors = diagnostics.error_count
    files = None if system.plant is None else load_plant(system.plant, loader.model, diagnostics)
    if len(applications) < len(system.targets) or diagnostics.error_count > errors:
        return None
    templates = environment([TEMPLATES, *loader.roots])
    ends: dict[str, _Target] = {}
    for name, application in applications.items():
        views = topics_of(application, Macros(application, templates).macro)
        ends[name] = _Target(application, views.subscriptions, views.publications)
    checked = _Checker(system, loader, ends, diagnostics).checked()
    return checked if files is None else replace(checked, plant=check_plant(files, system, applications, diagnostics))


@dataclass(frozen=True)
class _Target:
    application: Application
    subscriptions: tuple[TopicView, ...]
    publications: tuple[TopicView, ...]

    def wires(self, receives: bool) -> tuple[Wire, ...]:
        return self.application.inputs if receives else self.application.outputs

    def view(self, component: str, receives: bool) -> TopicView:
        """The topic of a component.  The component exists: the application was made with it."""
        views = self.subscriptions if receives else self.publications
        return next(view for view in views if view.topic.component and view.topic.component.name == component)


@dataclass(frozen=True)
class _Checker:
    system: System
    loader: Loader
    targets: Mapping[str, _Target]
    diagnostics: Diagnostics

    def checked(self) -> CheckedSystem:
        links = []
        for connection in self.system.connections:
            if self.are_nodes(connection) and (link := self.link(connection)) is not None:
                links.append(link)
        self.check_domains(links)
        self.check_inputs()
        self.check_world()
        self.check_participants()
        ages: dict[tuple[str, str], Fraction] = {}
        for link in links:
            pair = (link.connection.sender.target, link.connection.receiver.target)
            ages[pair] = max(link.age, ages.get(pair, Fraction(0)))
        loops = [
            Loop(way, sum((ages[pair] for pair in zip(way, (*way[1:], way[0]))), Fraction(0))) for way in loops_of(ages)
        ]
        applications = {name: target.application for name, target in self.targets.items()}
        return CheckedSystem(self.system, self.loader, applications, links, loops)

    # One connection ------------------------------------------------------------------------------------------------

    def are_nodes(self, connection: Connection) -> bool:
        """True if both targets are ROS 2 nodes.  Else False after reporting it."""
        for end in (connection.sender, connection.receiver):
            application = self.targets[end.target].application
            middleware = application.communication.middleware
            if not middleware.is_node:
                possible = map(
                    self.loader.catalog.find_middleware, sorted(offered(application.target, self.loader.catalog))
                )
                nodes = [each.name for each in possible if each is not None and each.is_node]
                message = f"'{end.target}' has no topics: its middleware is '{middleware.name}'"
                hint = f"set 'communication.middleware' to {' or '.join(nodes)}" if nodes else ""
                notes = [Note("the middleware", application.communication.span)]
                self.diagnostics.error("not-a-node", end.span, message, hint=hint, notes=notes)
                return False
        return True

    def link(self, connection: Connection) -> Link | None:
        """The connection with what its ends tell, or None after reporting that its messages differ."""
        sender, receiver = (self.targets[end.target] for end in _ends(connection))
        sent = sender.view(connection.sender.component, receives=False)
        received = receiver.view(connection.receiver.component, receives=True)
        if not self.same_message(connection, sent, received):
            return None
        self.check_quality(connection, sent.topic, received.topic)
        self.check_timeout(connection, sent.topic, received.topic, sender.application)
        unit = self.check_values(connection, sender, receiver)
        period = _period(sent.topic, sender.application)
        return Link(
            connection=connection,
            message=sent.ros_type,
            unit=unit,
            on_change=sent.topic.trigger == "change",
            period=period,
            age=period + receiver.application.period,
        )

    def same_message(self, connection: Connection, sent: TopicView, received: TopicView) -> bool:
        if sent.ros_type != received.ros_type:
            message = f"{_both(connection)}: {sent.ros_type} is sent, but {received.ros_type} is expected"
            hint = "state the same 'type', here or in both components"
            self.diagnostics.error("message-mismatch", connection.receiver.span, message, hint=hint)
            return False
        given, wanted = _fields(sent), _fields(received)
        fits = set(wanted) <= set(given) if sent.ros_type in _BY_NAME else wanted == given
        if not fits:
            message = f"{_both(connection)}: the message has {', '.join(given)}, but {', '.join(wanted)} are expected"
            hint = "give the elements the same names, in the same order"
            self.diagnostics.error("message-mismatch", connection.receiver.span, message, hint=hint)
            return False
        return self.same_field(connection, given, wanted)

    def same_field(self, connection: Connection, given: Sequence[str], wanted: Sequence[str]) -> bool:
        """True if the connection names no fields, or the same field at both ends."""
        ends = _ends(connection)
        ports = [end.port.partition(".")[2] for end in ends]
        for end, port, known in zip(ends, ports, (given, wanted)):
            if port and port not in known:
                message = f"'{end.target}/{end.component}' has no field '{port}'"
                self.diagnostics.error("unknown-port", end.span, message, hint=did_you_mean(port, known, "fields"))
                return False
        if all(ports) and ports[0] != ports[1]:
            message = f"the field '{ports[0]}' of the message cannot arrive as '{ports[1]}'"
            hint = "a connection carries the whole message: bind the field to another port of the model"
            self.diagnostics.error("message-mismatch", connection.receiver.span, message, hint=hint)
            return False
        return True

    def check_quality(self, connection: Connection, sent: Topic, received: Topic) -> None:
        """Reports a quality of service for which DDS does not connect the two ends."""
        problems = []
        if (sent.qos, received.qos) == ("best_effort", "reliable"):
            problems.append("the sender is best_effort, but the receiver is reliable")
        if (sent.durability, received.durability) == ("volatile", "transient_local"):
            problems.append("the sender is volatile, but the receiver is transient_local")
        if received.deadline and (not sent.deadline or sent.deadline > received.deadline):
            offered = show(sent.deadline, "time") if sent.deadline else "none"
            problems.append(f"the sender's deadline is {offered}, the receiver's {show(received.deadline, 'time')}")
        for problem in problems:
            hint = "DDS does not connect them: state the same quality of service in both components"
            self.diagnostics.error(
                "qos-mismatch", connection.receiver.span, f"{_both(connection)}: {problem}", hint=hint
            )

    def check_timeout(self, connection: Connection, sent: Topic, received: Topic, sender: Application) -> None:
        """Reports a receiver that gives up before the next message can come."""
        period = _period(sent, sender)
        timeouts = [value.setpoint.timeout for value in received.values if value.setpoint and value.setpoint.timeout]
        timeout = min(timeouts, default=None)
        if timeout is None:
            return
        span, ends = connection.receiver.span, _both(connection)
        if sent.trigger == "change":
            message = f"{ends}: the timeout is {show(timeout, 'time')}, but messages are only sent on changes"
            hint = "set 'timeout: 0 s' in the receiver, or send at a period"
            self.diagnostics.error("timeout-too-short", span, message, hint=hint)
        elif timeout <= period:
            message = f"{ends}: messages are sent every {show(period, 'time')}, "
            message += f"but the timeout is {show(timeout, 'time')}"
            hint = f"set 'timeout' to {show(2 * period, 'time')} or more, so that one lost message is not a timeout"
            self.diagnostics.error("timeout-too-short", span, message, hint=hint)

    def check_values(self, connection: Connection, sender: _Target, receiver: _Target) -> str:
        """Compares units and ranges of the values.  Returns the unit of the first value, or an empty text."""
        given = _wires(connection.sender, sender.wires(receives=False))
        wanted = _wires(connection.receiver, receiver.wires(receives=True))
        for port, wire in given.items():
            for other in (wanted[port],) if port in wanted else ():
                self.check_unit(connection, wire.unit, other.unit)
                self.check_range(connection, sent_range(wire.steps), received_range(other.steps))
        return next((wire.unit for wire in (*given.values(), *wanted.values()) if wire.unit), "")

    def check_unit(self, connection: Connection, given: str, wanted: str) -> None:
        if not given or not wanted or given == wanted:
            return
        if dimension_of(given) is not None and dimension_of(given) == dimension_of(wanted):
            if conversion_factor(given, wanted) == 1:
                return
            hint = f"state 'unit: {given}' in this connection: the receiver then converts it"
        else:
            hint = "connect other ports, or correct a unit"
        message = f"{_both(connection)}: the unit {given} is sent, but {wanted} is expected"
        self.diagnostics.error("unit-mismatch", connection.receiver.span, message, hint=hint)

    def check_range(self, connection: Connection, given: Range, wanted: Range) -> None:
        """Warns if the receiver refuses values that the sender can send.  Compares limits that both ends state."""
        low = -math.inf < given[0] < wanted[0]
        high = wanted[1] < given[1] < math.inf
        for exceeded, end in ((low, 0), (high, 1)):
            if exceeded:
                message = f"{_both(connection)}: values to {given[end]:g} are sent, "
                message += f"but the receiver refuses values beyond {wanted[end]:g}"
                hint = "state the same 'limits' in the bindings of both"
                self.diagnostics.warning("range-mismatch", connection.receiver.span, message, hint=hint)

    # The whole -----------------------------------------------------------------------------------------------------

    def check_domains(self, links: Sequence[Link]) -> None:
        """Reports targets that are connected, but state different domains of ROS 2: once for each pair."""
        pairs = {tuple(end.target for end in _ends(link.connection)): link.connection for link in reversed(links)}
        for connection in pairs.values():
            domains = [self.targets[end.target].application.communication.domain for end in _ends(connection)]
            if None not in domains and domains[0] != domains[1]:
                message = f"{_both(connection)}: the domains {domains[0]} and {domains[1]} do not see each other"
                hint = "set the same 'communication.domain'"
                self.diagnostics.error("domain-mismatch", connection.receiver.span, message, hint=hint)

    def check_inputs(self) -> None:
        """Reports topics that a target receives, but that neither a target nor the world sends."""
        connected = [(connection.receiver, connection) for connection in self.system.connections]
        fed = {(end.target, end.component) for end, _ in connected} | {
            (end.target, end.component) for end in self.system.world
        }
        for name, target in self.targets.items():
            for view in target.subscriptions:
                component = view.topic.component
                if view.topic.role == "values" and component is not None and (name, component.name) not in fed:
                    message = f"nothing sends to '{name}/{component.name}'"
                    hint = f"connect it, or add 'world: {{sends: [{name}/{component.name}]}}'"
                    span = self.system.targets[name].span
                    notes = [Note("the topic component", component.span)]
                    self.diagnostics.error("input-without-sender", span, message, hint=hint, notes=notes)

    def check_world(self) -> None:
        """Reports receivers of a topic of the world that expect other messages or units than the first one."""
        first: dict[str, End] = {}
        for end in self.system.world:
            other = first.setdefault(end.topic, end)
            if end.topic and other is not end:
                self.check_same(other, end)

    def check_same(self, first: End, second: End) -> None:
        ends = (first, second)
        views = [self.targets[end.target].view(end.component, receives=True) for end in ends]
        wires = [_wires(end, self.targets[end.target].wires(receives=True)) for end in ends]
        topic, hint = f"'{self.system.topic(first)}'", "use two topics, or change a component"
        by_name = views[0].ros_type in _BY_NAME  # then each finds its own elements
        fields = ["" if by_name else ", ".join(_fields(view)) for view in views]
        types = [view.ros_type for view in views]
        if types[0] != types[1] or fields[0] != fields[1]:
            told = fields if types[0] == types[1] else types
            message = f"{topic} cannot be two messages: {first} expects {told[0]}, {second} expects {told[1]}"
            self.diagnostics.error("message-mismatch", second.span, message, hint=hint)
        for port, wire in wires[0].items():
            units = (wire.unit, wires[1][port].unit) if port in wires[1] else ("", "")
            if all(units) and units[0] != units[1]:
                message = f"{topic} cannot have two units: {first} expects {units[0]}, {second} expects {units[1]}"
                self.diagnostics.error("unit-mismatch", second.span, message, hint=hint)

    def check_participants(self) -> None:
        """Reports more programs on one computer than their middleware finds."""
        programs: dict[str, list[str]] = {}
        for name, target in self.targets.items():
            if target.application.target.platform.simulates_plant:
                programs.setdefault(target.application.communication.middleware.name, []).append(name)
        for middleware, names in programs.items():
            most = self.targets[names[0]].application.communication.middleware.programs
            if most is not None and len(names) > most:
                what = f"{len(names)} targets are programs with the middleware '{middleware}'"
                span, message = self.system.targets[names[most]].span, f"{what}: one computer can have {most}"
                hint = "use other middlewares or domains, or several computers"
                self.diagnostics.error("too-many-participants", span, message, hint=hint)


def _ends(connection: Connection) -> tuple[End, End]:
    return connection.sender, connection.receiver


def _both(connection: Connection) -> str:
    return f"{connection.sender} -> {connection.receiver}"


def _fields(view: TopicView) -> tuple[str, ...]:
    """The names of the values of a message; one name without an element is left out."""
    component = view.topic.component
    assert component is not None
    names = tuple(port.name for port in component.kind.topic_ports)
    return names if len(names) > 1 or names != ("value",) else ()


def _wires(end: End, wires: Sequence[Wire]) -> dict[str, Wire]:
    """The wires of a topic component by the names of its ports; the one of the field if the end names a field."""
    field = end.port.partition(".")[2]
    return {
        wire.component_port.name: wire
        for wire in wires
        if wire.component.name == end.component and field in ("", wire.component_port.name)
    }


def _period(topic: Topic, application: Application) -> Fraction:
    """The time in seconds between two messages."""
    if topic.trigger == "cycles":
        return topic.cycles * application.period
    return application.communication.period
