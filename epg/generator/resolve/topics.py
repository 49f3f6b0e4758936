# SPDX-License-Identifier: Apache-2.0
"""The topics of an application: those of its components, and those that every ROS 2 node of EPG has.

Each value has an index in the exchange between the control side and the communication side of a target.  Setpoints are
numbered in the order of the subscriptions, monitoring values in the order of the publications.  The values of one
message have consecutive indices.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from epg.generator.check.bindings import Binding, Bindings
from epg.generator.check.configuration import DIAGNOSTICS_TOPIC, Component, Configuration
from epg.generator.resolve.application import ResolvedComponent, Topic, TopicValue
from epg.generator.resolve.setpoints import Setpoints

HISTORY = 10
"""The number of messages that a publication keeps, if ``depth`` is not stated: the default of rclcpp and rclpy."""


PARAMETER_EVENTS = "/parameter_events"
PARAMETER_EVENTS_DEPTH = 1000
"""The topic of changed parameters, and its depth in ROS 2 (rmw_qos_profile_parameter_events)."""


def value_indices_of(components: Mapping[str, Component], bindings: Bindings) -> dict[str, dict[str, int]]:
    """The value indices of each component, by its ports, counted per direction in the order of the components.

    If a component has several ports, only the ports that are bound have an index, in the order of the message.  If none
    of them is bound, all have one.
    """
    bound = _bound_ports(components, bindings)
    result: dict[str, dict[str, int]] = {}
    next_index = {"subscribe": 0, "publish": 0, "echo": 0}
    for name, component in components.items():
        direction, ports = component.kind.communication, component.kind.topic_ports
        if direction is None:
            continue
        used = [port for port in ports if port.name in bound.get(name, ())] if len(ports) > 1 else ports
        first = next_index[direction]
        result[name] = {port.name: first + number for number, port in enumerate(used or ports)}
        next_index[direction] += len(result[name])
    return result


def _bound_ports(components: Mapping[str, Component], bindings: Bindings) -> dict[str, set[str]]:
    result: dict[str, set[str]] = {}
    ends: list[tuple[Binding, str]] = [(binding, "source") for _, binding in bindings.inputs.values()]
    ends += [(binding, "sink") for _, several in bindings.outputs.values() for binding in several]
    for binding, direction in ends:
        kind = components[binding.component].kind if binding.component in components else None
        main = kind.main_port(direction) if kind else None
        port = binding.port or (main.name if main else None)
        if port is not None:
            result.setdefault(binding.component, set()).add(port)
    return result


def subscriptions_of(
    components: Mapping[str, ResolvedComponent], configuration: Configuration, setpoints: Setpoints
) -> tuple[Topic, ...]:
    """The topics that a target subscribes to: setpoints, then echoes, then the topic that enables the target."""
    result = []
    for component in components.values():
        if component.kind.communication == "subscribe":
            values = _values(component, setpoints)
            result.append(_topic(component, "topic", "values", values, index=values[0].index, depth=1))
    echoes = [c for c in components.values() if c.kind.communication == "echo"]
    first = sum(c.kind.communication == "publish" for c in components.values())
    for number, component in enumerate(echoes, first):
        result.append(_topic(component, "from", "echo", (), index=number, qos="qos_from"))
    enable = configuration.control.enable_topic
    if enable is not None:
        result.append(Topic(enable, "control.enable_topic", "enable", "reliable", 1, None, (), 0))
    return tuple(result)


def publications_of(
    components: Mapping[str, ResolvedComponent], configuration: Configuration, *, parameters: bool
) -> tuple[Topic, ...]:
    """The topics that a target publishes: monitoring values, then echoes, then state and statistics.

    With ``parameters``, changes of parameters follow.
    """
    communication = configuration.communication
    result = []
    for component in components.values():
        if component.kind.communication == "publish":
            values = _values(component, {})
            cycles = component.parameters.get("every")
            on_change = component.parameters.get("on_change") is True
            topic = _topic(component, "topic", "values", values, index=values[0].index)
            trigger = "cycles" if cycles is not None else "change" if on_change else "period"
            cycles = cycles if isinstance(cycles, int) else 0
            result.append(replace(topic, trigger=trigger, cycles=cycles, period=communication.period))
    for component in components.values():
        if component.kind.communication == "echo":
            result.append(_topic(component, "to", "echo", (), index=0, qos="qos_to"))
    every = communication.diagnostics
    if every:
        key = "communication.diagnostics"
        result.append(Topic(DIAGNOSTICS_TOPIC, key, "diagnostics", "reliable", 1, None, (), 0, period=every))
    if parameters:
        result.append(
            Topic(
                PARAMETER_EVENTS,
                "communication.parameters",
                "parameters",
                "reliable",
                PARAMETER_EVENTS_DEPTH,
                None,
                (),
                0,
                period=communication.period,
            )
        )
    return tuple(result)


def _topic(
    component: ResolvedComponent,
    parameter: str,
    role: str,
    values: tuple[TopicValue, ...],
    *,
    index: int,
    depth: int = HISTORY,
    qos: str = "qos",
) -> Topic:
    """The topic whose name is in ``parameter``."""
    stated = component.parameters.get("depth")
    return Topic(
        name=str(component.parameters[parameter]),
        key=f"components.{component.name}",
        role=role,
        qos=str(component.parameters.get(qos) or component.parameters["qos"]),
        depth=stated if isinstance(stated, int) else depth,
        component=component,
        values=values,
        index=index,
        durability=str(component.parameters.get("durability") or "volatile"),
        deadline=_time(component.parameters.get("deadline")),
        lifespan=_time(component.parameters.get("lifespan")),
    )


def _time(value: object) -> Fraction:
    """A time in seconds; 0 if it is not stated."""
    return Fraction(value) if isinstance(value, (int, Fraction)) else Fraction(0)


def _values(component: ResolvedComponent, setpoints: Setpoints) -> tuple[TopicValue, ...]:
    """The values of a component's topic.

    A value has the name of the topic in messages, or ``joint_states/pan.position`` if it is one of several values.
    """
    topic, ports = str(component.parameters["topic"]), component.kind.topic_ports
    alone = len(ports) == 1 and not ports[0].element
    return tuple(
        TopicValue(topic if alone else f"{topic}/{port}", port, index, setpoints.get((component.name, port)))
        for port, index in component.value_index.items()
    )
