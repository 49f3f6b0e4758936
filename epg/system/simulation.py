# SPDX-License-Identifier: Apache-2.0
"""The program that simulates a system: its tables in C, and the names of its parts for CMake."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from epg.check.simulated import PLATFORM
from epg.diagnostics import Diagnostics
from epg.emit.cmake import PathNames, images_cmake, system_cmake
from epg.emit.licence import with_licence
from epg.emit.symbols import TEMPLATES
from epg.emit.template import environment
from epg.resolve.application import Application, Topic
from epg.system.check_system import CheckedSystem
from epg.system.images import images_of
from epg.system.system import Connection, End


@dataclass(frozen=True)
class TargetView:
    """A target in the tables.  ``symbol`` is the beginning of the names of its shared objects."""

    name: str
    symbol: str
    has_plant: bool
    start_ns: int
    drift_ppb: int


@dataclass(frozen=True)
class ConnectionView:
    """A connection of two topic components in the tables: indices of targets, publication and subscription."""

    name: str
    sender: int
    publication: int
    receiver: int
    subscription: int
    delay_ns: int
    jitter_ns: int
    loss_ppm: int
    reliable: bool


def part_name(program: str, target: str) -> str:
    """The beginning of the C symbols of a target in the simulation ``program``."""
    return f"{program}_{target}"


def simulation_outputs(
    checked: CheckedSystem, program: str, names: PathNames, diagnostics: Diagnostics
) -> dict[str, str]:
    """The generated files of the program, without those of its targets.  Stops after reporting mistakes."""
    system, loader = checked.system, checked.loader
    applications = loader.applications(
        (name, system.simulated(target, part_name(program, name), loader.user_roots))
        for name, target in system.targets.items()
    )
    diagnostics.stop_if_errors()
    order = {name: number for number, name in enumerate(applications)}
    targets = [
        TargetView(
            name=name,
            symbol=part_name(program, name),
            has_plant=applications[name].plant is not None,
            start_ns=round(target.clock.start * 10**9),
            drift_ppb=target.clock.drift,
        )
        for name, target in system.targets.items()
    ]
    joined: dict[tuple[str, str], Connection] = {}
    for connection in system.connections:  # several values of one message are one connection
        joined.setdefault((_component(connection.sender), _component(connection.receiver)), connection)
    connections = [_connection(connection, applications, order) for connection in joined.values()]
    env = environment([TEMPLATES, *loader.roots])
    template = env.get_template(f"platforms/{PLATFORM}/system.c.j2")
    files = {f"{program}_system.c": template.render(system=system, targets=targets, connections=connections)}
    files[f"{program}_images.cmake"] = images_cmake(images_of(checked), names)
    used = {path for application in applications.values() for path in application.files}
    cmake = system_cmake(program, sorted(used), [target.name for target in targets], files, names)
    return with_licence({**files, f"{program}.cmake": cmake})


def _connection(
    connection: Connection, applications: Mapping[str, Application], order: Mapping[str, int]
) -> ConnectionView:
    sender, receiver = applications[connection.sender.target], applications[connection.receiver.target]
    number, sent = _topic(sender.publications, connection.sender.component)
    subscription, _ = _topic(receiver.subscriptions, connection.receiver.component)
    transport = connection.transport
    return ConnectionView(
        name=f"{_component(connection.sender)} -> {_component(connection.receiver)}",
        sender=order[connection.sender.target],
        publication=number,
        receiver=order[connection.receiver.target],
        subscription=subscription,
        delay_ns=round(transport.delay * 10**9),
        jitter_ns=round(transport.jitter * 10**9),
        loss_ppm=round(transport.loss * 10**6),
        reliable=sent.qos == "reliable",
    )


def _component(end: End) -> str:
    return f"{end.target}/{end.component}"


def _topic(topics: Sequence[Topic], component: str) -> tuple[int, Topic]:
    """The index of the topic of a component, and the topic.  It exists: the application was made with it."""
    return next(
        (number, topic)
        for number, topic in enumerate(topics)
        if topic.component is not None and topic.component.name == component
    )
