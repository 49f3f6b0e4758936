# SPDX-License-Identifier: Apache-2.0
"""Checks the section ``communication`` of a ``.tcf``: the target must offer the middleware and the transport."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from types import MappingProxyType
from typing import NamedTuple

from epg.generator.catalog.catalog import Catalog, Computer
from epg.generator.catalog.middleware import Middleware
from epg.generator.check.compose import communication_schema, console_schema, typed_options
from epg.generator.check.middleware import check_lack, check_offer, needs_component, offered, unoffered_hint
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.documents.items import integer_of
from epg.generator.documents.schema import extended_from, validate
from epg.generator.quantity import QuantityError, parse_quantity
from epg.generator.source import Span, YamlNode

CONSOLE = "console"
"""The only middleware that can run beside another one."""
PERIOD = Fraction(33, 1000)
"""The default time between two runs of the communication side, in seconds."""


class _Offer(NamedTuple):
    """The ``middlewares`` that a target can have, each with its transports, and the components with their bytes.

    ``carries`` maps each component without mistakes to True if it can carry the bytes of a middleware.
    """

    target: Computer
    middlewares: Mapping[str, tuple[str, ...]]
    components: YamlNode
    carries: Mapping[str, bool]

    def transports(self, middleware: Middleware) -> tuple[str, ...]:
        """The transports of the port layer for ``middleware``."""
        return self.middlewares.get(middleware.name, ())

    def needs_component(self, middleware: Middleware) -> bool:
        """True if only a component can carry the bytes of ``middleware``."""
        return needs_component(middleware, self.target, self.transports(middleware))

    def has_mistakes(self, component: object) -> bool:
        """True for a component with mistakes, which are reported already."""
        return component in self.components and component not in self.carries


class _Range(NamedTuple):
    """A range of times in seconds.  With ``zero``, 0 s is possible, too, and switches the function off."""

    low: Fraction
    high: Fraction
    zero: bool
    words: str


_PERIODS = _Range(Fraction(1, 1000), Fraction(3600), False, "1 ms to 3600 s")
_DIAGNOSTICS = _Range(Fraction(1, 100), Fraction(3600), True, "10 ms to 3600 s, or 0 s to send none")


@dataclass(frozen=True)
class Communication:
    """The checked section ``communication``; ``options`` are those of the middleware.

    ``transport`` is a transport of the platform, or the name of a component whose kind is a transport.  ``period`` is
    the time in seconds between two runs of the communication side.
    """

    middleware: Middleware
    transport: str | None
    period: Fraction
    domain: int | None  # None: the domain of the agent or of the environment
    diagnostics: Fraction  # seconds between two messages; 0: no messages
    parameters: bool | None  # the model's parameters are those of a ROS 2 node; None: if memory permits
    keep_cycles: int  # control cycles that wait for publications with `every`; 0: only the newest one is published
    parameter_request: int | None  # bytes of the buffer for requests; None: as many as the parameters need
    console: Middleware | None  # the console that runs beside the middleware
    console_transport: str | None  # the component with its bytes; None: the platform has a transport for it
    console_options: Mapping[str, object]
    options: Mapping[str, object]
    usb: Mapping[str, object]  # vendor_id, product_id, manufacturer, product, serial: stated, or the family's
    span: Span  # position of the middleware's name, else of the section

    @property
    def middlewares(self) -> tuple[Middleware, ...]:
        """The middleware, and the console if one runs beside it."""
        return (self.middleware,) if self.console is None else (self.middleware, self.console)


def tools_for(target: Computer, communication: Communication) -> set[str]:
    """The names of the tools that a build needs: for the target, its middlewares, and its USB device."""
    family = target.platform.family
    usb = family.usb_needs if family is not None and communication.usb else ()
    return {*target.needs, *usb, *(name for used in communication.middlewares for name in used.needs)}


def check_communication(
    root: YamlNode, target: Computer | None, carries: Mapping[str, bool], catalog: Catalog, diagnostics: Diagnostics
) -> Communication | None:
    """The communication of a target, or None after reporting mistakes; also None if ``target`` is None.

    ``carries`` maps each component without mistakes to True if it can carry the bytes of a middleware.
    """
    node = root.get("communication")
    middleware = root.get("communication", "middleware")
    transport = root.get("communication", "transport")
    period, parameters = root.get("communication", "period"), root.get("communication", "parameters")
    if target is None:
        _seconds(period, PERIOD, _PERIODS, diagnostics)
        return None
    chosen_middleware, possible = _choice(middleware, target, catalog, diagnostics)
    offer = _Offer(target, possible, root["components"], carries)
    if chosen_middleware is not None and transport is not None and not offer.has_mistakes(transport.value):
        _check_transport(transport, chosen_middleware, offer, offer.transports(chosen_middleware), diagnostics)
    seconds = _seconds(period, PERIOD, _PERIODS, diagnostics)
    if chosen_middleware is None:
        return None
    check_offer(target, chosen_middleware, diagnostics)
    if node is not None and not validate(node, communication_schema(chosen_middleware), diagnostics):
        return None
    named = middleware or node
    where = transport or named or root["target"]
    chosen = str(transport.value) if transport else _default_transport(chosen_middleware, offer, where, diagnostics)
    check_lack(target, chosen, where, diagnostics)
    console = _console(root.get("communication", "console"), chosen_middleware, chosen, offer, catalog, diagnostics)
    return Communication(
        middleware=chosen_middleware,
        transport=chosen,
        period=seconds,
        domain=integer_of(root, "communication", "domain"),
        diagnostics=_diagnostics(root.get("communication", "diagnostics"), chosen_middleware, diagnostics),
        parameters=None if parameters is None else parameters.value is not False,
        keep_cycles=integer_of(root, "communication", "keep_cycles") or 0,
        parameter_request=integer_of(root, "communication", "parameters", "request"),
        console=console.middleware,
        console_transport=console.transport,
        console_options=console.options,
        options=typed_options(chosen_middleware, node, diagnostics),
        usb=_usb(root.get("communication", "usb"), target, _uses_usb(target, chosen, console), diagnostics),
        span=(named or root).span,
    )


def _choice(
    node: YamlNode | None, target: Computer, catalog: Catalog, diagnostics: Diagnostics
) -> tuple[Middleware | None, Mapping[str, tuple[str, ...]]]:
    """The middleware, and all possible ones.  Reports a middleware that the target does not have."""
    possible = dict(target.platform.middlewares)
    name = str(node.value) if node else next(iter(possible), "none")
    if name not in possible:
        possible = offered(target, catalog)
    if name in possible:
        return catalog.find_middleware(name), possible
    if node is not None:
        message = f"{target.name} has no middleware '{name}'"
        hint = unoffered_hint(name, possible, catalog)
        diagnostics.error("unknown-middleware", node.span, message, hint=hint, notes=extended_from(node))
    return None, possible


def _default_transport(middleware: Middleware, offer: _Offer, where: YamlNode, diagnostics: Diagnostics) -> str | None:
    """The transport of a middleware if the section names none: the first of the port layer, or the only component.

    None for a middleware without a transport, and after reporting that it needs one.
    """
    if offer.needs_component(middleware):
        return _only_carrier(middleware.name, offer.carries, set(), "communication.transport", where, diagnostics)
    return next(iter(offer.transports(middleware)), None)


_COMPONENT_HINT = "add a component that carries bytes, such as a uart, and name it in 'transport'"


def _check_transport(
    node: YamlNode, middleware: Middleware, offer: _Offer, own: Sequence[str], diagnostics: Diagnostics
) -> None:
    """Reports a transport that is neither one of the platform's ``own`` nor a component that carries bytes."""
    target = offer.target
    component = needs_component(middleware, target, own)
    carriers = [name for name, able in offer.carries.items() if able]
    known = [*own, *carriers] if own or component else []
    if node.value not in known:
        message = f"'{middleware.name}' on {target.platform.name} has no transport '{node.value}'"
        hint = _COMPONENT_HINT if component else "remove it: this middleware has no transport"
        if known:
            hint = did_you_mean(str(node.value), known, "it has")
        diagnostics.error("unknown-transport", node.span, message, hint=hint, notes=extended_from(node))


def _only_carrier(
    user: str, carries: Mapping[str, bool], taken: set[str | None], key: str, where: YamlNode, diagnostics: Diagnostics
) -> str | None:
    """The only component that can carry the bytes of ``user``.  Reports that there is none, or more than one."""
    able = [name for name, carrying in carries.items() if carrying and name not in taken]
    if len(able) == 1:
        return able[0]
    message = f"'{user}' needs a component that carries its bytes"
    hint = f"name one of them in '{key}': {', '.join(able)}" if able else _COMPONENT_HINT
    diagnostics.error("missing-transport", where.span, message, hint=hint, notes=extended_from(where))
    return None


def _console_transport(
    node: YamlNode, console: Middleware, taken: str | None, offer: _Offer, diagnostics: Diagnostics
) -> str | None:
    """The component that carries the bytes of a console beside the middleware.

    None if it uses a transport of the platform, and after reporting a mistake.
    """
    stated = node.get("transport")
    platform = offer.target.platform
    if not offer.needs_component(console):
        if stated is None or (platform.has_console_on_components and stated.value in offer.transports(console)):
            return None
        if not platform.has_console_on_components:
            message = f"the console on {platform.name} has a transport of its own"
            diagnostics.error("not-on-platform", stated.span, message, hint="remove it", notes=extended_from(stated))
            return None
    if stated is None:
        key = "communication.console.transport"
        return _only_carrier("console", offer.carries, {taken}, key, node, diagnostics)
    _check_transport(stated, console, offer, (), diagnostics)
    if stated.value == taken:
        message = f"'{taken}' cannot carry the bytes of two middlewares"
        hint = "name another component"
        diagnostics.error("transport-twice", stated.span, message, hint=hint, notes=extended_from(stated))
    return str(stated.value)


def _uses_usb(target: Computer, transport: str | None, console: _Console) -> bool:
    on_platform = console.middleware is not None and console.transport is None
    return transport == "usb" or (on_platform and "usb" in target.platform.middlewares.get(CONSOLE, ()))


def _usb(node: YamlNode | None, target: Computer, used: bool, diagnostics: Diagnostics) -> Mapping[str, object]:
    """The stated names and numbers of the target as a USB device; if it is ``used``, also the family's defaults.

    Reports them on a platform that sets the names in another way.  A platform without USB ignores them: another target
    of the same robot may use them.
    """
    platform = target.platform
    defaults = platform.family.usb if used and platform.family is not None else {}
    names = {key: value for key, value in defaults.items() if key != "serial_digits"}
    if node is None:
        return names
    if not platform.has_usb_names and any("usb" in transports for transports in platform.middlewares.values()):
        message = f"a target configuration cannot set the names of the USB device on {platform.name}"
        hint = f"remove 'usb', and set the names in the build: the documentation of {platform.name} lists the settings"
        diagnostics.error("not-on-platform", node.span, message, hint=hint, notes=extended_from(node))
    return dict(sorted({**names, **{key: node[key].value for key in node.keys}}.items()))


def _diagnostics(node: YamlNode | None, middleware: Middleware, diagnostics: Diagnostics) -> Fraction:
    """Seconds between two messages of state and statistics.

    0 means no messages, as for all middlewares that are not a ROS 2 node.
    """
    seconds = _seconds(node, Fraction(1), _DIAGNOSTICS, diagnostics)
    return seconds if middleware.is_node else Fraction(0)


class _Console(NamedTuple):
    """The console beside a middleware.  ``transport`` is the component with its bytes; None: one of the platform."""

    middleware: Middleware | None = None
    transport: str | None = None
    options: Mapping[str, object] = MappingProxyType({})


def _console(
    node: YamlNode | None,
    middleware: Middleware,
    taken: str | None,
    offer: _Offer,
    catalog: Catalog,
    diagnostics: Diagnostics,
) -> _Console:
    """The console that runs beside ``middleware``, whose bytes ``taken`` carries.

    None without one, and if ``middleware`` is the console itself.
    """
    if node is None or node.value is False or middleware.name == CONSOLE:
        return _Console()
    target = offer.target
    possible = CONSOLE in offer.middlewares or CONSOLE in offered(target, catalog)
    console = catalog.find_middleware(CONSOLE) if possible else None
    if console is None:
        message = f"{target.name} has no middleware '{CONSOLE}'"
        diagnostics.error("unknown-middleware", node.span, message, hint="remove it", notes=extended_from(node))
        return _Console()
    if node.is_mapping and not validate(node, console_schema(console), diagnostics):
        return _Console()
    check_lack(target, next(iter(target.platform.middlewares.get(CONSOLE, ())), None), node, diagnostics)
    options = typed_options(console, node if node.is_mapping else None, diagnostics)
    if taken is None and offer.needs_component(middleware):  # reported already
        return _Console(console, None, options)
    return _Console(console, _console_transport(node, console, taken, offer, diagnostics), options)


def _seconds(node: YamlNode | None, default: Fraction, allowed: _Range, diagnostics: Diagnostics) -> Fraction:
    """The time of ``node`` in seconds; ``default`` if there is no time.  Reports a time outside of ``allowed``."""
    seconds = time_of(node, diagnostics)
    if node is not None and seconds is not None:
        possible = allowed.low <= seconds <= allowed.high or (allowed.zero and seconds == 0)
        if not possible:
            diagnostics.error("out-of-range", node.span, f"this time must be from {allowed.words}")
    return default if seconds is None else seconds


def time_of(node: YamlNode | None, diagnostics: Diagnostics) -> Fraction | None:
    """The time of ``node`` in seconds; None if ``node`` is None, or after reporting that it is not a time."""
    if node is None:
        return None
    try:
        return Fraction(parse_quantity(node.value, "time"))
    except QuantityError as problem:
        diagnostics.error("wrong-unit", node.span, str(problem), hint=problem.hint)
        return None
