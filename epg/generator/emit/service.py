# SPDX-License-Identifier: Apache-2.0
"""The services that the generated code offers to a middleware.

They are: ports of the model by name, parameters that can be changed, recordings, and actuators that can be moved by
hand.  The list ``uses`` of a middleware names those that it needs; ``templates/service.c.j2`` writes their C.

A middleware can have a ``code.c.j2`` with a macro ``globals(m)``.  Its argument is a :class:`MiddlewareView`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping

from epg.generator.catalog.middleware import Middleware
from epg.generator.check.communication import Communication
from epg.generator.check.names import absolute_topic, ros_parameter_name
from epg.generator.dataclass import dataclass
from epg.generator.emit.text import Code, double, identifier
from epg.generator.emit.topics import MacroText
from epg.generator.resolve.application import Application, ResolvedComponent
from epg.generator.resolve.parameters import is_limited

CAPTURE, CAPTURE_ON_COMPUTER = 224, 16384
"""The default of the option ``capture``: a chip's memory is small."""


@dataclass(frozen=True)
class SignalView:
    """A port of the model.  ``index`` is its value index among the monitoring values."""

    name: str
    unit: str
    struct: Code
    member: Code
    index: int


@dataclass(frozen=True)
class ParameterView:
    """A parameter of the model, with its generated value.

    ``limits`` are C expressions for its lowest and highest value.  ``ros_name`` is its name in ROS 2, where the
    ``description`` contains the unit.
    """

    name: str
    unit: str
    value: float
    limits: tuple[Code, Code]
    ros_name: str
    description: str


@dataclass(frozen=True)
class ActuatorView:
    """An actuator port that the user can drive by hand.

    ``statement`` is C that drives it with ``duty``; ``applied`` is a C expression for its present duty;
    it is empty if the kind does not tell it.
    """

    name: str
    function: Code
    statement: Code
    applied: Code


@dataclass(frozen=True)
class EncoderView:
    """A sensor that counts.  ``count`` and ``position`` are C expressions; ``unit`` is the unit of the position."""

    name: str
    symbol: Code
    count: Code
    position: Code
    unit: str


@dataclass(frozen=True)
class MiddlewareView:
    """The middleware as its own template sees it.

    ``monitor_count`` is the number of monitoring values in each cycle.  ``publications`` and ``subscriptions`` are
    numbers of topics, including the topics for diagnostics and for enabling.

    ``longest_topic`` is the length in characters of the longest full name of a topic.  ``longest_node`` is the length
    of the node's name with its namespace.  Both count a serial number in the place of ``$serial``.

    ``transport_rate`` is the number of bytes per second that a UART carries; 0 for faster transports.

    ``prefix`` is the beginning of the C names in the template's code: "middleware", or "console" for a console that
    runs beside another middleware.
    """

    name: str
    symbol: Code
    prefix: Code
    transport_rate: int
    options: Mapping[str, object]
    monitor_count: int
    publications: int
    subscriptions: int
    longest_topic: int
    longest_node: int


@dataclass(frozen=True)
class Service:
    """All services of an application.  Services that no middleware uses are empty, zero, False or None.

    ``time_index`` is the value index of the cycle's time among the monitoring values.  ``keep_cycles`` is the number of
    cycles that wait for publications in each n-th cycle.  ``capture`` is the number of
    values that a recording can hold.
    """

    middleware: MiddlewareView | None  # None if the middleware has no code, as "none"
    console: MiddlewareView | None  # a console that runs beside the middleware
    signals: tuple[SignalView, ...]
    time_index: int | None
    monitor_count: int
    keep_cycles: int
    node: bool
    store: bool
    parameters: tuple[ParameterView, ...]
    has_limits: bool  # at least one parameter has a limit
    capture: int
    actuators: tuple[ActuatorView, ...]
    encoders: tuple[EncoderView, ...]


def service_of(app: Application, macro: MacroText, symbols: Mapping[str, Code]) -> Service:
    """The services that the middleware of ``app``, and the console beside it, use."""
    communication = app.communication
    middleware, options = communication.middleware, communication.options
    console, console_options = communication.console, communication.console_options
    uses = _uses(communication)
    published = sum(len(topic.values) for topic in app.publications)
    signals = tuple(_signals(app, published)) if "signals" in uses else ()
    node = "node" in uses
    time_index = published + len(signals) if "signals" in uses or node else None
    monitor_count = published if time_index is None else time_index + 1
    moved = app.components if "jog" in uses else ()
    return Service(
        middleware=_view(app, middleware, "middleware", options, communication.transport, monitor_count),
        console=_view(app, console, "console", console_options, communication.console_transport, monitor_count),
        signals=signals,
        time_index=time_index,
        monitor_count=monitor_count,
        keep_cycles=communication.keep_cycles if node and any(t.cycles for t in app.publications) else 0,
        node=node,
        store=node or "parameters" in uses,
        parameters=tuple(parameter_views(app)) if "parameters" in uses or app.ros_parameters else (),
        has_limits=any(is_limited(setting) for setting in app.parameter_settings.values()),
        capture=max(_capture(app, middleware, options), _capture(app, console, console_options)),
        actuators=tuple(_actuators(moved, macro, symbols)),
        encoders=tuple(_encoders(moved, macro, symbols)),
    )


def _uses(communication: Communication) -> set[str]:
    """The services that the middleware and the console use.  The target states if a node has parameters."""
    middleware, console = communication.middleware, communication.console
    own = set(middleware.uses) - ({"parameters"} if middleware.is_node else set())
    return own | set(console.uses if console else ())


def _capture(app: Application, middleware: Middleware | None, options: Mapping[str, object]) -> int:
    """The number of values for recordings and streams.  The platforms that simulate a plant run on a computer."""
    if middleware is None or "capture" not in middleware.uses:
        return 0
    stated = options.get("capture")
    if isinstance(stated, int):
        return stated
    return CAPTURE_ON_COMPUTER if app.target.platform.simulates_plant else CAPTURE


def _view(
    app: Application,
    middleware: Middleware | None,
    prefix: str,
    options: Mapping[str, object],
    transport: str | None,
    monitor_count: int,
) -> MiddlewareView | None:
    if middleware is None or not middleware.symbol:
        return None
    topics = (*app.publications, *app.subscriptions)
    return MiddlewareView(
        name=middleware.name,
        symbol=identifier(middleware.symbol),
        prefix=Code(prefix),
        transport_rate=_transport_rate(app, transport),
        options=options,
        monitor_count=monitor_count,
        publications=len(app.publications),
        subscriptions=len(app.subscriptions),
        longest_topic=max((len(_full(app, topic.name)) for topic in topics), default=0),
        longest_node=len(_full(app, "~/")) - (1 if app.namespace else 2),
    )


def _transport_rate(app: Application, transport: str | None) -> int:
    """Bytes per second of a UART: a byte takes ten bits, with its start and stop bit."""
    rates = [c.parameters.get("baud_rate") for c in app.components if c.name == transport]
    return rates[0] // 10 if rates and isinstance(rates[0], int) else 0


def _full(app: Application, topic: str) -> str:
    """The full name of a topic, with namespace and node."""
    return absolute_topic(topic, app.namespace, app.node)


def _signals(app: Application, first: int) -> Iterable[SignalView]:
    index = first
    names: set[str] = set()
    for struct, ports in (("inputs", app.model.inputs), ("outputs", app.model.outputs)):
        for port in ports:
            name = console_word(f"{struct}.{port.name}", names)
            yield SignalView(name, console_word(port.unit), Code(struct), identifier(port.identifier), index)
            index += 1


def parameter_views(app: Application) -> Iterable[ParameterView]:
    """The parameters of the model that can change after the start, in the order of their C enumeration."""
    names: set[str] = set()
    for parameter in app.model.parameters:
        if not parameter.tunable:  # these come last, so that the index of a parameter is that of the C enumeration
            continue
        value = app.parameters.get(parameter.name, parameter.value)
        setting = app.parameter_settings.get(parameter.name)
        text = setting.description if setting else ""
        yield ParameterView(
            name=console_word(parameter.name, names),
            unit=console_word(parameter.unit),
            value=value,
            limits=(
                _limit(setting.minimum if setting else -math.inf),
                _limit(setting.maximum if setting else math.inf),
            ),
            ros_name=ros_parameter_name(parameter.name),
            description=" ".join([*([text] if text else []), *([f"[{parameter.unit}]"] if parameter.unit else [])]),
        )


def _limit(value: float) -> Code:
    """A C expression for a limit, which can be infinite."""
    if math.isinf(value):
        return Code("INFINITY" if value > 0 else "-INFINITY")
    return double(value)


def _actuators(
    components: Iterable[ResolvedComponent], macro: MacroText, symbols: Mapping[str, Code]
) -> Iterable[ActuatorView]:
    for component in components:
        ports = [p for p in component.kind.ports if p.actuator and p.direction == "sink" and p.type == "real"]
        for port in ports:
            name = component.name if len(ports) == 1 else f"{component.name}.{port.name}"
            function = Code(f"{symbols[component.name]}_jog_{identifier(port.name)}")
            applied = macro(component, "applied", port.name).strip()
            yield ActuatorView(name, function, macro(component, "write", port.name, Code("duty")), applied)


def _encoders(
    components: Iterable[ResolvedComponent], macro: MacroText, symbols: Mapping[str, Code]
) -> Iterable[EncoderView]:
    for component in components:
        count, port = macro(component, "count"), component.kind.main_port("source")
        if count and port is not None:
            position = macro(component, "read", port.name).strip()
            yield EncoderView(component.name, symbols[component.name], count.strip(), position, port.unit)


def console_word(text: str, taken: set[str] | None = None) -> str:
    """``text`` as one printable ASCII word for a line of text: blanks and the characters ``=<>,`` become ``_``.

    If ``taken`` is given, the word gets a number at its end if it is in ``taken``, and is added to ``taken``.
    """
    word = re.sub(r"[\s=<>,]|[^\x21-\x7e]", "_", text)
    if taken is not None:
        number = 2
        start = word
        while word in taken:
            word, number = f"{start}_{number}", number + 1
        taken.add(word)
    return word
