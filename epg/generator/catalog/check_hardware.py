# SPDX-License-Identifier: Apache-2.0
"""Checks that the names in the files of chips, boards, platforms and families fit together.

A schema cannot check this.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from types import MappingProxyType

from epg.generator.catalog.clocks import check_clocks, check_stated
from epg.generator.catalog.hardware import Computer, listed_pins, names_of
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.documents.items import (
    elements_of,
    integer_of,
    integer_range,
    map_of,
    pin_list,
    pin_names,
    text_of,
    texts_of,
)
from epg.generator.source import Span, YamlNode


def check_soc(node: YamlNode, diagnostics: Diagnostics) -> None:
    """Checks a chip alone: all pins, slots, instances and dividers that it names must exist."""
    check_clocks(node, diagnostics)
    known = map_of(node, "clocks")
    for name in map_of(node, "cubemx", "clocks"):
        span = node["cubemx"]["clocks"].key_span(name)
        diagnostics.known_or_error("unknown-name", span, f"unknown clock '{name}'", name, known, "known")
    pins = _pins(node.get("pins"), diagnostics)
    for name, peripheral in map_of(node, "peripherals").items():
        _peripheral(name, peripheral, pins, diagnostics)
        if "divider" in peripheral:
            _divider(peripheral["divider"], map_of(node, "clocks"), names_of(peripheral["instances"]), diagnostics)
    peripherals = map_of(node, "peripherals")
    for name, resource_class in map_of(node, "classes").items():
        _resource_class(name, resource_class, peripherals, diagnostics)


def check_board(node: YamlNode, diagnostics: Diagnostics) -> None:
    """Checks a board alone: each pin must have one meaning only."""
    seen: dict[str, tuple[str, Span]] = {}
    listed = node.get("pins")
    groups = [("pins", name, listed.span) for name in _pins(listed, diagnostics)] if listed else []
    for section in ("onboard", "reserved"):
        groups += [(section, name, node[section].key_span(name)) for name in map_of(node, section)]
    for section, name, span in groups:
        if name in seen:
            first = Note("first written here", seen[name][1])
            message = f"pin {name} is in '{seen[name][0]}' and in '{section}'"
            diagnostics.error("wrong-value", span, message, hint="keep one of the two", notes=[first])
        seen.setdefault(name, (section, span))
    if "layout" in node:
        _layout(node["layout"], {name for _, name, _ in groups}, diagnostics)


def _layout(layout: YamlNode, pins: set[str], diagnostics: Diagnostics) -> None:
    """Checks the layout: each contact must be a supply or a pin of the board.  A pin can have one contact only."""
    supplies = map_of(layout, "supplies")
    for row in layout["rows"].elements():
        count, columns = len(row["contacts"].elements()), integer_of(row, "columns") or 1
        if count % columns:
            message = f"{count} contacts are not pairs, which 'columns: {columns}' has"
            hint = "add the missing contact, for example NC: {role: other, title: not connected} of 'supplies'"
            diagnostics.error("wrong-value", row["contacts"].span, message, hint=hint)
    seen: dict[str, Span] = {}
    for contact in (child for row in layout["rows"].elements() for child in row["contacts"].elements()):
        name = str(contact.value)
        if name not in pins and name not in supplies:
            _unknown("contact", contact, [*supplies, *sorted(pins)], diagnostics)
        elif name in pins and name in seen:
            first = Note("first written here", seen[name])
            diagnostics.error("wrong-value", contact.span, f"pin {name} has two contacts", notes=[first])
        seen.setdefault(name, contact.span)


def check_platform(node: YamlNode, diagnostics: Diagnostics) -> None:
    """Checks a platform alone.

    It must name families of chips, one board, or ``by_family``.  Its tick must be one of its resource classes.
    """
    if sum(key in node for key in ("board", "families", "by_family")) != 1:
        message = "a platform must set exactly one of 'families', 'board', 'by_family'"
        hint = (
            "'families' lists the families of chips that it supports; 'board' is for a port layer with one board; "
            "with 'by_family', the folders in families/ have the port layer"
        )
        diagnostics.error("exactly-one", node["platform"].span, message, hint=hint)
    if "by_family" in node:
        _left_to_families(node, diagnostics)
        return
    for key in ("classes", "middlewares"):
        if key not in node:
            diagnostics.error("missing-key", node["platform"].span, f"'{key}' is missing")
    tick = node.get("tick", "class")
    classes = texts_of(node, "classes")
    if tick is not None and "classes" in node:
        _check_known("class", [tick], classes, diagnostics)


def _left_to_families(node: YamlNode, diagnostics: Diagnostics) -> None:
    """Reports keys of a platform with ``by_family`` that must be in the files of the families instead."""
    of_families = ("classes", "middlewares", "usb_names", "console_on_components", "templates", "shared", "sdk")
    for key in (*of_families, "products"):
        if key in node:
            message = f"a platform with 'by_family' must not set '{key}': it depends on the family of chips"
            diagnostics.error("only-with", node.key_span(key), message, hint="move it to families/<name>/family.yaml")


def check_family(node: YamlNode, platforms: Sequence[str], diagnostics: Diagnostics) -> None:
    """Checks a family alone: all platforms that it names must be among ``platforms``."""
    for platform in node["platforms"].elements():
        name, message = str(platform.value), f"there is no platform '{platform.value}'"
        diagnostics.known_or_error("unknown-name", platform.span, message, name, platforms, "in platforms/")
    started = node.get("tick_starts", "class")
    if started is not None:
        _check_known("class", [started], texts_of(node, "classes"), diagnostics)
    for name in ("chip", "program", "unusable"):
        _check_expression(node.get("flash", name), diagnostics)
    _check_expression(node.get("flash", "otherwise", "chip"), diagnostics)


def _check_expression(node: YamlNode | None, diagnostics: Diagnostics) -> None:
    """Reports a text that is not a regular expression."""
    try:
        re.compile("" if node is None else str(node.value))
    except re.error as error:
        assert node is not None
        hint = "write a backslash before a character that must be taken literally"
        diagnostics.error("wrong-value", node.span, f"this is not a regular expression: {error.msg}", hint=hint)


def check_target(target: Computer, diagnostics: Diagnostics) -> None:
    """Checks that board, chip and platform fit together.

    The chip must have all pins and resource classes that the board names, and a class for the platform's tick.
    """
    board, soc = target.board, target.soc
    node = board.node
    named = [(name, node[key].key_span(name)) for key in ("onboard", "reserved") for name in map_of(node, key)]
    named += [(str(pin.value), pin.span) for pin in map_of(node, "names").values()]
    devices = map_of(node, "devicetree", "nodes").values()
    named += [(str(pin.value), pin.span) for device in devices for pin in device.elements()]
    named += [(name, node["pins"].span) for name in board.pins]
    for name, span in named:
        if name not in soc.numbers:
            hint = f"it has the pins {pin_list(soc.pins)}"
            notes = [Note("the chip", soc.span)]
            diagnostics.error("unknown-name", span, f"{soc.title} has no pin '{name}'", hint=hint, notes=notes)
    for stated in (node.get("clocks"), node.get("devicetree", "clocks")):
        check_stated(stated, soc.clocks, soc.title, diagnostics)
    for child in map_of(node, "onboard").values():
        _check_known("class", child["classes"].elements(), soc.classes, diagnostics)
    _check_tick(target, diagnostics)


def _check_tick(target: Computer, diagnostics: Diagnostics) -> None:
    """Checks that the chip has a timer for the control loop, if the platform needs one."""
    soc = target.soc
    tick = target.platform.node.get("tick", "class")
    if tick is not None and target.tick is not None:
        resource_class = soc.classes.get(str(tick.value))
        if resource_class is None:
            message = f"{soc.title} does not implement a class '{tick.value}'"
            hint = did_you_mean(str(tick.value), soc.classes, "it implements")
            diagnostics.error("unknown-class", tick.span, message, hint=hint, notes=[Note("the chip", soc.span)])
        elif resource_class.divider_from != "period" or resource_class.signals:
            message = f"class '{tick.value}' of {soc.title} is not a timer for the control loop"
            hint = "a class for it has 'divider: {from: period}' and no signals"
            diagnostics.error(
                "wrong-value", tick.span, message, hint=hint, notes=[Note("the class", resource_class.span)]
            )


def _peripheral(name: str, node: YamlNode, pins: Sequence[str], diagnostics: Diagnostics) -> None:
    """Checks a peripheral of a chip with these ``pins``."""
    instances = names_of(node["instances"])
    slots: tuple[str, ...] = ("",)
    if "slots" in node:
        count, names = node.get("slots", "count"), node.get("slots", "names")
        stated = [part for part in (count, names) if part is not None]
        if len(stated) != 1:
            message = f"slots of '{name}' must set either 'count' or 'names'"
            diagnostics.error("exactly-one", node.key_span("slots"), message)
            return
        slots = names_of(stated[0])
    for instance, reached in map_of(node, "pins").items():
        _check_part(name, "instance", instance, instances, node["pins"].key_span(instance), diagnostics)
        for slot, listed in reached.items():
            _check_part(name, "slot", slot, slots, reached.key_span(slot), diagnostics)
            for pin, span in listed_pins(listed):
                if pin not in pins:
                    hint = f"it has the pins {pin_list(pins)}" if pins else ""
                    diagnostics.error("unknown-name", span, f"this chip has no pin '{pin}'", hint=hint)
    for key in ("bits", "triggered_by"):
        for instance, value in map_of(node, key).items():
            named = [(instance, node[key].key_span(instance))]
            named += [(str(other.value), other.span) for other in value.elements()]
            for other, span in named:
                _check_part(name, "instance", other, instances, span, diagnostics)
    if "frequency" in names_of(node.get("agree")) and "divider" not in node:
        diagnostics.error("unknown-name", node.key_span("agree"), f"'{name}' has no divider that sets a frequency")


def _divider(node: YamlNode, clocks: Collection[str], instances: Sequence[str], diagnostics: Diagnostics) -> None:
    """Checks the divider of a peripheral: its ranges, and the clocks of its instances."""
    for key in ("prescaler", "counter"):
        _range(node.get(key), diagnostics)
    _check_known("clock", [node["clock"]], clocks, diagnostics)
    seen: dict[str, Span] = {}
    for name, listed in map_of(node, "others").items():
        span = node["others"].key_span(name)
        diagnostics.known_or_error("unknown-name", span, f"unknown clock '{name}'", name, clocks, "known")
        for element in listed.elements():
            instance = str(element.value)
            if instance not in instances:
                _unknown("instance", element, instances, diagnostics)
            elif instance in seen:
                first = Note("first written here", seen[instance])
                diagnostics.error("wrong-value", element.span, f"'{instance}' has two clocks", notes=[first])
            seen.setdefault(instance, element.span)


def _resource_class(name: str, node: YamlNode, peripherals: dict[str, YamlNode], diagnostics: Diagnostics) -> None:
    """Checks a resource class: its peripheral, instances, slots and signals must exist."""
    stated = node.get("peripheral")
    if stated is not None and stated.value not in peripherals:
        _unknown("peripheral", stated, peripherals, diagnostics)
        return
    nothing = YamlNode(MappingProxyType({}), node.span)
    peripheral = nothing if stated is None else peripherals[str(stated.value)]
    _check_known("instance", elements_of(node, "instances"), names_of(peripheral.get("instances")), diagnostics)
    signals = map_of(node, "signals")
    slots = ("slot",) if text_of(node, "takes") != "instance" else names_of(peripheral.get("slots", "names"))
    _check_known("choice of pins", signals.values(), ("any", *slots) if stated else ("any",), diagnostics)
    if stated is None and not signals:
        diagnostics.error("wrong-value", node.span, f"class '{name}' must have a peripheral or signals")
    _check_known("signal", elements_of(node, "neighbours"), signals, diagnostics)
    if "divider" in node:
        _range(node.get("divider", "counter"), diagnostics)
        if "divider" not in peripheral:
            diagnostics.error("wrong-value", node.key_span("divider"), f"the peripheral of '{name}' has no divider")


def _pins(node: YamlNode | None, diagnostics: Diagnostics) -> tuple[str, ...]:
    """The pins of a list.  Reports a pin that is listed twice, and a wrong range: then the result is empty."""
    try:
        names = pin_names(node)
    except ValueError as problem:
        assert node is not None
        diagnostics.error("wrong-value", node.span, str(problem), hint="write the lower end first, such as 0-22")
        return ()
    counts = Counter(names)
    double = next((name for name in names if counts[name] > 1), None)
    if double is not None and node is not None:
        diagnostics.error("wrong-value", node.span, f"pin {double} is listed twice")
    return names


def _range(node: YamlNode | None, diagnostics: Diagnostics) -> None:
    if node is None:
        return
    first, last = integer_range(node)
    if not 1 <= first <= last <= 0x1_0000:
        message = f"'{node.value}' is not a range within 1-65536"
        diagnostics.error("out-of-range", node.span, message, hint="write the lower end first, such as 2-65536")


def _check_known(what: str, nodes: Iterable[YamlNode], known: Collection[str], diagnostics: Diagnostics) -> None:
    for node in nodes:
        if str(node.value) not in known:
            _unknown(what, node, known, diagnostics)


def _check_part(
    peripheral: str, what: str, name: str, known: Collection[str], span: Span, diagnostics: Diagnostics
) -> None:
    message = f"'{peripheral}' has no {what} '{name}'"
    diagnostics.known_or_error("unknown-name", span, message, name, known, f"{what}s")


def _unknown(what: str, node: YamlNode, known: Iterable[str], diagnostics: Diagnostics) -> None:
    hint = did_you_mean(str(node.value), known, "known")
    diagnostics.error("unknown-name", node.span, f"unknown {what} '{node.value}'", hint=hint)
