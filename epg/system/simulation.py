# SPDX-License-Identifier: Apache-2.0
"""The program that simulates a system: its tables in C, and the names of its parts for CMake."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from epg.generator.check.simulated import PLATFORM
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.emit.cmake import PathNames, Reads, images_cmake, reads_of, system_cmake
from epg.generator.emit.licence import with_licence
from epg.generator.emit.model import emit_model, model_build
from epg.generator.emit.outputs import application_outputs
from epg.generator.emit.symbols import TEMPLATES
from epg.generator.emit.template import environment
from epg.generator.emit.text import Code, identifier
from epg.generator.importers import load_model
from epg.generator.models.model import Model
from epg.generator.project import load_application
from epg.generator.resolve.application import Application, Topic
from epg.system.check_system import CheckedSystem
from epg.system.images import images_of
from epg.system.plant import load_plant, with_plant
from epg.system.system import Connection, End, System, SystemTarget


@dataclass(frozen=True)
class TargetView:
    """A target in the tables.  ``symbol`` is the beginning of the names of its shared objects."""

    name: str
    symbol: str
    has_plant: bool
    in_plant: bool
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


@dataclass(frozen=True)
class PlantView:
    """The plant of the system in the tables.  ``library`` is the beginning of the names of its C symbols."""

    model: Model
    library: Code
    file: str
    step_ns: int
    divisor: int
    starts_by_step: bool


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
    plant, moved = _plant(checked, program)
    order = {name: number for number, name in enumerate(applications)}
    targets = [
        TargetView(
            name=name,
            symbol=part_name(program, name),
            has_plant=applications[name].plant is not None,
            in_plant=name in moved,
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
    files = {
        f"{program}_system.c": template.render(system=system, targets=targets, connections=connections, plant=plant)
    }
    files[f"{program}_images.cmake"] = images_cmake(images_of(checked), names)
    reads = Reads()
    for application in (*checked.applications.values(), *applications.values()):
        reads |= reads_of(application)
    library = None
    if plant is not None and checked.plant is not None and system.plant is not None:
        model, parameters = checked.plant.model, checked.plant.parameters
        name = plant_library(program)
        library = name, model, model_build(model, name, parameters)
        files |= emit_model(model, name, parameters, terminate=False)
        reads |= Reads(frozenset({system.plant.bindings}))
    cmake = system_cmake(program, reads, [target.name for target in targets], library, files, names)
    return with_licence({**files, f"{program}.cmake": cmake})


def plant_library(program: str) -> str:
    """The name of the library of the system's plant in the simulation ``program``."""
    return part_name(program, "plant")


def _plant(checked: CheckedSystem, program: str) -> tuple[PlantView | None, frozenset[str]]:
    """The plant of the system, and the targets that are bound to it."""
    plant = checked.plant
    if plant is None:
        return None, frozenset()
    step = plant.model.step * 10**9
    view = PlantView(
        model=plant.model,
        library=identifier(plant_library(program)),
        file=f"{plant_library(program)}_unit.so",
        step_ns=step.numerator,
        divisor=step.denominator,
        starts_by_step=plant.model.code.starts_by_step,
    )
    wires = (*plant.inputs, *plant.outputs)
    return view, frozenset(wire.component.name.partition("/")[0] for wire in wires)


def part_outputs(
    system: System,
    target: SystemTarget,
    program: str,
    user_roots: Sequence[Path],
    names: PathNames,
    diagnostics: Diagnostics,
) -> dict[str, str]:
    """The generated files of one target as a part of the program.  Stops after reporting mistakes."""
    request = system.simulated(target, part_name(program, target.name), user_roots)
    application = diagnostics.checked(load_application(request, diagnostics))
    if system.plant is not None:
        of_plant = Diagnostics()  # its warnings belong to the program, not to each target
        files = of_plant.checked(load_plant(system.plant, load_model, of_plant))
        application = with_plant(application, target.name, files, plant_library(program), of_plant)
        of_plant.stop_if_errors()
    return application_outputs(application, request.roots, names)


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
