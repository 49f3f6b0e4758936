# SPDX-License-Identifier: Apache-2.0
"""Reports components whose pins nobody has written.

A wiring is written down and never invented: a program whose pins change with the version of EPG, or when a component is
added, would drive the wrong wires.  Therefore free pins are only proposed, as an edit of the user's file.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from epg.generator.check.configuration import Component, Configuration
from epg.generator.correction import KeyValue
from epg.generator.data import is_own_target_file
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.items import map_of
from epg.generator.documents.schema import extended_from
from epg.generator.resolve.first_fit import first_fit, signals_of


def report_unwired(configuration: Configuration, diagnostics: Diagnostics) -> None:
    """Reports each component without all of its pins, with free pins that fit together."""
    written = signals_of(configuration)
    found = first_fit(configuration, configuration.control.period)
    for component in configuration.components.values():
        own = {name: pin for (owner, name), pin in written.items() if owner == component.name}
        missing = [name for name, pin in own.items() if not pin]
        if missing:
            node = component.node.get("pins") or component.node
            message = f"'{component.name}' has no pin{'s' if missing[1:] else ''} for {', '.join(map(repr, missing))}"
            hint = "no free pins fit: move or remove a component"
            if found:
                hint = _hint(
                    component, {name: found.get((component.name, name), own[name]) for name in own}, configuration
                )
            span, notes = node.span, extended_from(component.node)
            if notes and is_own_target_file(span.file) and not is_own_target_file(configuration.tcf):
                span, notes = notes[-1].span, []  # the line that the user can change
            diagnostics.error("unwired", span, message, hint=hint, notes=notes, about="pins")


def _hint(component: Component, pins: Mapping[str, str], configuration: Configuration) -> str:
    """The hint to write ``pins``.  They are numbers if the user has written a number."""
    names = map_of(component.node, "pins")
    if any(isinstance(node.value, int) for node in names.values()):
        pins = {name: pin if name in names else configuration.target.board.pin_name(pin) for name, pin in pins.items()}
    text = ", ".join(f"{name}: {pin}" for name, pin in pins.items())
    file = Path(configuration.tcf).name
    of_file = f" of {file}" if component.node.origins and not is_own_target_file(configuration.tcf) else ""
    sentence = f"write 'pins: {{{text}}}' in '{component.name}'{of_file}, or the pins to which it is wired"
    if is_own_target_file(configuration.tcf):
        return f"{sentence}, in a .tcf of your own that extends {file}"
    path = ("components", component.name, "pins")
    return KeyValue(
        sentence, configuration.tcf, path, {name: int(pin) if pin.isdigit() else pin for name, pin in pins.items()}
    )
