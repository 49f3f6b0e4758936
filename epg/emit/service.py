# SPDX-License-Identifier: Apache-2.0
"""What the generator makes for a middleware: the model's ports by name, parameters, recordings, actuators by hand.

A middleware's ``uses`` says which of them; ``templates/service.c.j2`` lays them out.  Its own ``code.c.j2``, if it has
one, has a macro ``globals(m)``, of which ``m`` is a :class:`MiddlewareView`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from epg.catalog.middleware import Middleware
from epg.check.names import absolute_topic
from epg.emit.text import Code, identifier
from epg.emit.topics import Macro
from epg.resolve.application import Application, ResolvedComponent


@dataclass(frozen=True)
class SignalView:
    """A port of the model; ``index`` is its place among the monitoring values."""

    name: str
    unit: str
    struct: Code
    member: Code
    index: int


@dataclass(frozen=True)
class ParameterView:
    """A parameter of the model with the value it is generated with."""

    name: str
    unit: str
    value: float


@dataclass(frozen=True)
class ActuatorView:
    """A port that can be driven by hand; ``statement`` drives it with ``duty``."""

    name: str
    function: Code
    statement: Code


@dataclass(frozen=True)
class EncoderView:
    """A sensor that counts; ``count`` and ``position`` are expressions."""

    name: str
    symbol: Code
    count: Code
    position: Code
    unit: str


@dataclass(frozen=True)
class MiddlewareView:
    """The middleware as its own template sees it; ``monitor_count`` numbers are monitored in each cycle.

    ``publications`` and ``subscriptions`` are how many topics there are, diagnostics and enabling among them.

    ``longest_topic`` and ``longest_node`` are characters of the longest full name of a topic, and of the node with its
    namespace, with a serial number in the place of ``$serial``.

    ``prefix`` begins the names that the template makes: "middleware", or "console" for one beside a middleware.
    """

    name: str
    symbol: Code
    prefix: Code
    options: Mapping[str, object]
    monitor_count: int
    publications: int
    subscriptions: int
    longest_topic: int
    longest_node: int


@dataclass(frozen=True)
class Service:
    """All of it; empty lists and zeros for what the middleware does not use."""

    middleware: MiddlewareView | None  # None when nothing runs
    console: MiddlewareView | None  # beside it
    signals: tuple[SignalView, ...]
    time_index: int | None
    monitor_count: int
    node: bool
    store: bool
    parameters: tuple[ParameterView, ...]
    capture: int
    actuators: tuple[ActuatorView, ...]
    encoders: tuple[EncoderView, ...]


def service_of(app: Application, macro: Macro) -> Service:
    """What the middleware of ``app``, and a console beside it, use."""
    communication = app.communication
    middleware, options, console = communication.middleware, communication.options, communication.console
    uses = {*middleware.uses, *(console.uses if console else ())}
    published = sum(len(topic.values) for topic in app.publications)
    signals = tuple(_signals(app, published)) if "signals" in uses else ()
    node = "node" in uses
    time_index = published + len(signals) if "signals" in uses or node else None
    monitor_count = published if time_index is None else time_index + 1
    jog = "jog" in uses
    captures = [options.get("capture")] if "capture" in middleware.uses else []
    captures += [communication.console_options.get("capture")] if console and "capture" in console.uses else []
    return Service(
        middleware=_view(app, middleware, "middleware", options, monitor_count),
        console=_view(app, console, "console", communication.console_options, monitor_count) if console else None,
        signals=signals,
        time_index=time_index,
        monitor_count=monitor_count,
        node=node,
        store=node or "parameters" in uses,
        parameters=tuple(_parameters(app)) if "parameters" in uses else (),
        capture=max((size for size in captures if isinstance(size, int)), default=0),
        actuators=tuple(a for c in app.components for a in _actuators(c, macro)) if jog else (),
        encoders=tuple(e for c in app.components for e in _encoders(c, macro)) if jog else (),
    )


def _view(
    app: Application, middleware: Middleware, prefix: str, options: Mapping[str, object], monitor_count: int
) -> MiddlewareView | None:
    if not middleware.symbol:
        return None
    topics = (*app.publications, *app.subscriptions)
    return MiddlewareView(
        name=middleware.name,
        symbol=identifier(middleware.symbol),
        prefix=Code(prefix),
        options=options,
        monitor_count=monitor_count,
        publications=len(app.publications),
        subscriptions=len(app.subscriptions),
        longest_topic=max((len(_full(app, topic.name)) for topic in topics), default=0),
        longest_node=len(_full(app, "~/")) - (1 if app.namespace else 2),
    )


def _full(app: Application, topic: str) -> str:
    """The name of a topic on the network."""
    return absolute_topic(topic, app.namespace, app.node)


def _signals(app: Application, first: int) -> Iterable[SignalView]:
    index = first
    names: set[str] = set()
    for struct, ports in (("inputs", app.model.inputs), ("outputs", app.model.outputs)):
        for port in ports:
            name = _word(f"{struct}.{port.name}", names)
            yield SignalView(name, _word(port.unit), Code(struct), identifier(port.identifier), index)
            index += 1


def _parameters(app: Application) -> Iterable[ParameterView]:
    names: set[str] = set()
    for parameter in app.model.parameters:
        if not parameter.tunable:  # they come last: positions here are those of the model's enumeration
            continue
        value = app.parameters.get(parameter.name, parameter.value)
        yield ParameterView(_word(parameter.name, names), _word(parameter.unit), value)


def _actuators(component: ResolvedComponent, macro: Macro) -> Iterable[ActuatorView]:
    ports = [p for p in component.kind.ports if p.actuator and p.direction == "sink" and p.type == "real"]
    for port in ports:
        name = component.name if len(ports) == 1 else f"{component.name}.{port.name}"
        function = Code(f"{identifier(component.symbol)}_jog_{identifier(port.name)}")
        yield ActuatorView(name, function, macro(component, "write", port.name, Code("duty")))


def _encoders(component: ResolvedComponent, macro: Macro) -> Iterable[EncoderView]:
    count, port = macro(component, "count"), component.kind.main_port("source")
    if count and port is not None:
        position = macro(component, "read", port.name)
        yield EncoderView(component.name, identifier(component.symbol), count.strip(), position.strip(), port.unit)


def _word(text: str, taken: set[str] | None = None) -> str:
    """``text`` as one word that a line of text can hold and name: no blanks, and none of ``=<>,``."""
    word = re.sub(r"[\s=<>,]|[^\x21-\x7e]", "_", text)
    if taken is not None:
        number = 2
        start = word
        while word in taken:
            word, number = f"{start}_{number}", number + 1
        taken.add(word)
    return word
