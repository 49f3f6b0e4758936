# SPDX-License-Identifier: Apache-2.0
"""A target configuration, complete and typed: the merged ``.tcf`` after every check that needs no model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType

from epg.catalog.catalog import Catalog, Kind, Target
from epg.catalog.middleware import Middleware
from epg.check.bindings import Conversion, conversion_of
from epg.check.compose import (
    communication_schema,
    component_schema,
    options_schema,
    typed_options,
    typed_parameters,
)
from epg.check.devicetree import check_node
from epg.check.fail_safe import check_fail_safe
from epg.check.merge import apply_settings, merge_chain
from epg.check.middleware import check_lack, check_offer, offered, unoffered_hint
from epg.check.names import identifier_problem, normal_namespace
from epg.check.topics import Use, check_names
from epg.check.uses import Used, used_components
from epg.diagnostics import Diagnostics, Note, did_you_mean
from epg.documents.schema import extended_from, load_schema, validate
from epg.documents.tcf import TcfFile
from epg.documents.yaml_file import newer_version
from epg.quantity import QuantityError, parse_quantity
from epg.source import Span, YamlNode

CONSOLE = "console"
"""The middleware that can run beside another one."""
ENABLE_TOPIC, DIAGNOSTICS_TOPIC = "~/enable", "/diagnostics"
"""Topics of ROS 2 middlewares, whatever the components are."""
COMMON_PARAMETERS = ("kind", "scale", "offset", "unit", "limits")


@dataclass(frozen=True)
class Control:
    """The control loop; times in seconds: ``period`` None follows the model's step, ``output_delay`` None is none."""

    period: Fraction | None
    period_span: Span
    output_delay: Fraction | None
    output_delay_span: Span
    enable_at_start: bool
    overrun_limit: int
    enable_topic: str | None  # None: there is none
    enable_topic_span: Span
    fail_safe: str | None


@dataclass(frozen=True)
class Communication:
    """How topics travel; ``period`` in seconds, ``options`` those of the middleware.

    ``transport`` is one of the platform's, or the name of a component whose kind is a transport.
    """

    middleware: Middleware
    transport: str | None
    period: Fraction
    domain: int | None  # None: the agent's, or the environment's
    diagnostics: Fraction  # seconds between two messages; 0: none
    console: Middleware | None  # that runs beside it
    console_options: Mapping[str, object]
    options: Mapping[str, object]
    usb: Mapping[str, object]  # what is written of vendor_id, product_id, manufacturer, product, serial
    span: Span  # of the middleware's name, if it is written

    @property
    def middlewares(self) -> tuple[Middleware, ...]:
        """The middleware, and a console beside it."""
        return (self.middleware,) if self.console is None else (self.middleware, self.console)


@dataclass(frozen=True)
class Component:
    """A component with typed parameters (numbers in SI units), the components it uses, and its conversion."""

    name: str
    kind: Kind
    parameters: Mapping[str, object]
    uses: Mapping[str, Used]
    conversion: Conversion
    node: YamlNode
    span: Span  # of its name


@dataclass(frozen=True)
class Configuration:
    """All a ``.tcf`` says.  ``files`` are those it was read from, ``absent`` those that would have been read
    if they existed, ``root`` is the merged tree with positions."""

    target: Target
    node: str
    namespace: str
    control: Control
    communication: Communication
    components: Mapping[str, Component]
    files: tuple[Path, ...]
    absent: tuple[Path, ...]
    root: YamlNode


def check_configuration(
    chain: Sequence[TcfFile],
    settings: Sequence[tuple[tuple[str, ...], YamlNode]],
    catalog: Catalog,
    diagnostics: Diagnostics,
) -> Configuration | None:
    """The configuration that ``chain`` and the settings made on top of it mean, or None after reporting why not."""
    errors = diagnostics.error_count
    schema = load_schema("tcf")
    for file in chain:
        newer_version(file.node, "version", diagnostics)
    if diagnostics.error_count > errors:
        return None
    for file in chain[1:]:
        validate(file.node, schema, diagnostics, partial=True)
    if len(chain) > 1:
        validate(chain[0].node, schema, diagnostics, partial=True)
    if diagnostics.error_count > errors:
        return None
    root = apply_settings(merge_chain(chain), settings)
    if not validate(root, schema, diagnostics):
        return None
    target_node = root["target"]
    target = catalog.target(str(target_node.value), target_node.span, diagnostics)
    components = _components(root, target, catalog, diagnostics)
    communication = _communication(root, target, components, catalog, diagnostics)
    control = _control(root, components, communication, diagnostics)
    check_names(root["node"], root.get("namespace"), _topics(components, control, communication), diagnostics)
    if target is None or communication is None or diagnostics.error_count > errors:
        return None
    namespace = root.get("namespace")
    return Configuration(
        target=target,
        node=str(root["node"].value),
        namespace=normal_namespace(str(namespace.value)) if namespace else "",
        control=control,
        communication=communication,
        components=components,
        files=tuple(file.path for file in chain),
        absent=tuple(path for file in chain for path in file.absent),
        root=root,
    )


def _components(
    root: YamlNode, target: Target | None, catalog: Catalog, diagnostics: Diagnostics
) -> dict[str, Component]:
    section = root["components"]
    result: dict[str, Component] = {}
    folded: dict[str, str] = {}
    for name, node in section.items():
        span = section.key_span(name)
        problem = identifier_problem(name)
        if problem:
            diagnostics.error("invalid-name", span, f"'{name}' {problem}", notes=extended_from(node))
        other = folded.setdefault(name.casefold(), name)
        if other != name:
            first = Note("the other one", section.key_span(other))
            diagnostics.error(
                "invalid-name", span, f"'{name}' and '{other}' differ in upper and lower case only", notes=[first]
            )
        kind_node = node.get("kind")
        if kind_node is None:
            hint = did_you_mean("", catalog.kind_names(), "kinds")
            diagnostics.error("missing-key", span, f"'kind' is missing in 'components.{name}'", hint=hint)
            continue
        kind = catalog.kind(str(kind_node.value), kind_node.span, diagnostics)
        if kind is None:
            continue
        named = node.get("node")
        if named is not None:
            check_node(kind, node, named, target, diagnostics)
        with_pins = target is not None and target.has_pins and named is None
        if not validate(node, component_schema(kind, with_pins=with_pins), diagnostics):
            continue
        parameters = typed_parameters(kind, node, diagnostics)
        kind = kind.of_component(parameters)
        result[name] = Component(name, kind, parameters, {}, conversion_of(node, diagnostics), node, span)
    kinds = {name: result[name].kind if name in result else None for name, _ in section.items()}
    return {
        name: replace(component, uses=used_components(component.kind, component.node, kinds, diagnostics))
        for name, component in result.items()
    }


def _control(
    root: YamlNode, components: Mapping[str, Component], communication: Communication | None, diagnostics: Diagnostics
) -> Control:
    """The control loop; all of it may be left out, and then the target starts disabled."""
    node = root.get("control") or YamlNode(MappingProxyType({}), root.span)
    period, at_start = node.get("period"), node.get("enable_at_start")
    seconds = _time(period, diagnostics)
    if period is not None and seconds is not None and seconds <= 0:
        diagnostics.error("out-of-range", period.span, "the control period must be more than 0")
    topic, fail_safe, delay = node.get("enable_topic"), node.get("fail_safe"), node.get("output_delay")
    limit = node.get("overrun_limit")
    default_topic = ENABLE_TOPIC if communication is not None and communication.middleware.is_node else None
    if fail_safe is not None:
        check_fail_safe(fail_safe, root["components"], components, diagnostics)
    return Control(
        period=seconds,
        period_span=period.span if period else node.span,
        output_delay=_time(delay, diagnostics),
        output_delay_span=delay.span if delay else node.span,
        enable_at_start=at_start is not None and at_start.value is True,
        overrun_limit=limit.value if limit is not None and isinstance(limit.value, int) else 10,
        enable_topic=(str(topic.value) if topic.value is not False else None) if topic else default_topic,
        enable_topic_span=topic.span if topic else node.span,
        fail_safe=str(fail_safe.value) if fail_safe else None,
    )


def _communication(
    root: YamlNode,
    target: Target | None,
    components: Mapping[str, Component],
    catalog: Catalog,
    diagnostics: Diagnostics,
) -> Communication | None:
    """How topics travel, or None after reporting why not, or when there is no target."""
    node = root.get("communication")
    middleware = root.get("communication", "middleware")
    transport = root.get("communication", "transport")
    period = root.get("communication", "period")
    possible = dict(target.platform.middlewares) if target else {}
    name = str(middleware.value) if middleware else next(iter(possible), "none")
    if target and name not in possible:
        possible = offered(target, catalog)
    if target and name not in possible:
        assert middleware is not None
        message = f"{target.platform.name} has no middleware '{name}'"
        hint = unoffered_hint(name, possible, catalog)
        diagnostics.error("unknown-middleware", middleware.span, message, hint=hint, notes=extended_from(middleware))
    elif target and transport is not None and not _is_reported(str(transport.value), root, components):
        known = _transports(name, possible, components)
        if str(transport.value) not in known:
            message = f"'{name}' on {target.platform.name} has no transport '{transport.value}'"
            hint = did_you_mean(str(transport.value), known, "it has")
            if not known:
                hint = "remove it: there is nothing to choose"
            diagnostics.error("unknown-transport", transport.span, message, hint=hint, notes=extended_from(transport))
    seconds = _time(period, diagnostics) if period is not None else Fraction(33, 1000)
    if period is not None and seconds is not None and not Fraction(1, 1000) <= seconds <= 3600:
        diagnostics.error("out-of-range", period.span, "must be from 1 ms to 3600 s")
    found = catalog.find_middleware(name) if name in possible else None
    if target is not None and found is not None:
        check_offer(target, found, diagnostics)
    if found is None or (node is not None and not validate(node, communication_schema(found), diagnostics)):
        return None
    domain, console = node.get("domain") if node else None, node.get("console") if node else None
    options = typed_options(found, node, diagnostics)
    written = middleware or node or root
    chosen = str(transport.value) if transport else next(iter(possible[name]), None)
    check_lack(target, chosen, transport or middleware or node or root["target"], diagnostics)
    beside = _console(console, found, possible, target, catalog, diagnostics)
    if beside is not None and console is not None:
        own = target.platform.middlewares.get(beside.name, ()) if target else ()
        check_lack(target, next(iter(own), None), console, diagnostics)
    beside_node = console if beside is not None and console is not None and console.is_mapping else None
    return Communication(
        middleware=found,
        transport=chosen,
        period=seconds or Fraction(33, 1000),
        domain=domain.value if domain is not None and isinstance(domain.value, int) else None,
        diagnostics=_diagnostics(node, found, diagnostics),
        console=beside,
        console_options=typed_options(beside, beside_node, diagnostics) if beside is not None else {},
        options=options,
        usb=_usb(node.get("usb") if node else None, target, diagnostics),
        span=written.span,
    )


def _usb(node: YamlNode | None, target: Target | None, diagnostics: Diagnostics) -> Mapping[str, object]:
    """What the target is called as a USB device; platforms without USB leave it to others of the same robot."""
    if node is None or target is None:
        return {}
    platform = target.platform
    if not platform.has_usb_names and any("usb" in transports for transports in platform.middlewares.values()):
        message = f"on {platform.name} a target configuration cannot say what the USB device is called"
        hint = f"remove 'usb'; the documentation of {platform.name} says which settings of its build do that"
        diagnostics.error("not-on-platform", node.span, message, hint=hint, notes=extended_from(node))
    return {key: node[key].value for key in sorted(node.keys)}


def _diagnostics(node: YamlNode | None, middleware: Middleware, diagnostics: Diagnostics) -> Fraction:
    """Seconds between two messages of state and statistics; 0 for none, as with middlewares that are no ROS 2 node."""
    written = node.get("diagnostics") if node is not None else None
    seconds = _time(written, diagnostics) if written is not None else Fraction(1)
    if written is not None and seconds is not None and seconds != 0 and not Fraction(1, 100) <= seconds <= 3600:
        diagnostics.error("out-of-range", written.span, "must be from 10 ms to 3600 s, or 0 s for none")
    return (seconds or Fraction(0)) if middleware.is_node else Fraction(0)


def _console(
    node: YamlNode | None,
    middleware: Middleware,
    possible: Mapping[str, tuple[str, ...]],
    target: Target | None,
    catalog: Catalog,
    diagnostics: Diagnostics,
) -> Middleware | None:
    """The console beside ``middleware``; None if there is to be none, or if that is the console already."""
    if node is None or node.value is False or middleware.name == CONSOLE or target is None:
        return None
    found = catalog.find_middleware(CONSOLE) if CONSOLE in possible or CONSOLE in offered(target, catalog) else None
    if found is None:
        message = f"{target.platform.name} has no middleware '{CONSOLE}'"
        diagnostics.error("unknown-middleware", node.span, message, hint="remove it", notes=extended_from(node))
    elif node.is_mapping and not validate(node, options_schema(found), diagnostics):
        return None
    return found


def _transports(
    middleware: str, possible: Mapping[str, tuple[str, ...]], components: Mapping[str, Component]
) -> tuple[str, ...]:
    """What ``communication.transport`` may name: transports of the platform, and components that carry bytes."""
    own = possible[middleware]
    return (*own, *(c.name for c in components.values() if c.kind.transport)) if own else ()


def _is_reported(name: str, root: YamlNode, components: Mapping[str, Component]) -> bool:
    """Whether ``name`` is that of a component with which something else is wrong."""
    return name in root["components"] and name not in components


def _topics(components: Mapping[str, Component], control: Control, communication: Communication | None) -> list[Use]:
    """All topics with who uses them."""
    topics: list[Use] = [
        (c.name, str(c.node[key].value), c.node[key].span, c.node[key])
        for c in components.values()
        for key in c.kind.topic_parameters
    ]
    if control.enable_topic is not None:
        topics.append(("control.enable_topic", control.enable_topic, control.enable_topic_span, None))
    if communication is not None and communication.diagnostics:
        topics.append(("communication.diagnostics", DIAGNOSTICS_TOPIC, communication.span, None))
    return topics


def _time(node: YamlNode | None, diagnostics: Diagnostics) -> Fraction | None:
    if node is None:
        return None
    try:
        return Fraction(parse_quantity(node.value, "time"))
    except QuantityError as problem:
        diagnostics.error("wrong-unit", node.span, str(problem), hint=problem.hint)
        return None
