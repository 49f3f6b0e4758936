# SPDX-License-Identifier: Apache-2.0
"""``<name>.json``: the description of an application, for ``epg explain`` and other programs.

No other generated file has line numbers of the user's files.  An edit that only moves lines therefore changes no file
that is compiled.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from epg import __version__
from epg.generator.emit.cmake import PathNames
from epg.generator.emit.topics import TopicView
from epg.generator.messages.byte_layout import MessageType
from epg.generator.models.model import Model
from epg.generator.resolve.allocation import Assignment
from epg.generator.resolve.application import Application, ConversionStep, Plant, ResolvedComponent, TopicValue, Wire
from epg.generator.source import Span

if TYPE_CHECKING:
    from epg.generator.emit.application import Emitter


def describe(emitter: Emitter, names: PathNames, hash: str = "") -> str:
    """The description of an application as JSON text.  ``hash`` is empty if no files are generated."""
    app, topics, symbols = emitter.app, emitter.topics(), emitter.macros.symbols
    data: dict[str, Any] = {
        "name": app.name,
        "epg": __version__,
        "hash": hash,
        "target": {"name": app.target.name, "board": app.target.board.name, "platform": app.target.platform.name},
        "node": app.node,
        "namespace": app.namespace,
        "control": {
            "period": float(app.period),
            "output_delay": None if app.control.output_delay is None else float(app.control.output_delay),
            "step_divider": app.step_divider,
            "enable_at_start": app.control.enable_at_start,
            "overrun_limit": app.control.overrun_limit,
            "enable_topic": app.control.enable_topic,
            "fail_safe": app.control.fail_safe,
            "timer": app.tick.resource if app.tick else None,
        },
        "communication": {
            "middleware": app.communication.middleware.name,
            "agent": app.communication.middleware.agent,
            "transport": app.communication.transport,
            "period": float(app.communication.period),
            "domain": app.communication.domain,
            "diagnostics": float(app.communication.diagnostics),
            "console": app.communication.console is not None,
            **({"usb": usb} if (usb := _usb(app)) else {}),
        },
        "model": _model(app.model, names),
        "parameters": dict(sorted(app.parameters.items())),
        "components": {
            component.name: _component(component, symbols[component.name], names) for component in app.components
        },
        "inputs": [_wire(wire, "inputs", app, names) for wire in app.inputs],
        "outputs": [_wire(wire, "outputs", app, names) for wire in app.outputs],
        "unconnected": sorted({p.name for p in app.model.outputs} - {wire.port.name for wire in app.outputs}),
        "subscriptions": [_topic(view) for view in topics.subscriptions],
        "publications": [_topic(view) for view in topics.publications],
    }
    if messages := _messages(app):
        data["messages"] = messages
    if app.plant is not None:
        data["plant"] = _plant(app.plant, app, names)
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"


def _plant(plant: Plant, app: Application, names: PathNames) -> dict[str, Any]:
    return {
        "model": _model(plant.model, names),
        "steps_per_period": plant.steps_per_period,
        "inputs": [_wire(wire, "inputs", app, names) for wire in plant.inputs],
        "outputs": [_wire(wire, "outputs", app, names) for wire in plant.outputs],
    }


def _usb(app: Application) -> dict[str, Any]:
    """The names and numbers of the USB device, and the digits of its serial number; empty if it is not used.

    The target configuration states them; the others are those of the family, or of the chip, if a port layer in C has
    them.
    """
    stated, family = app.communication.usb, app.target.platform.family
    if not stated and app.communication.transport != "usb":
        return {}
    return dict(sorted({**app.target.soc.usb_device, **(family.usb if family else {}), **stated}.items()))


def _model(model: Model, names: PathNames) -> dict[str, Any]:
    return {
        "name": model.name,
        "origin": model.origin,
        "version": model.version,
        "method": model.method,
        "step": float(model.step),
        "folder": names.shown(model.directory),
    }


def _component(component: ResolvedComponent, symbol: str, names: PathNames) -> dict[str, Any]:
    starts = {claim: assignment.start for claim, assignment in component.claims.items() if assignment.start}
    return {
        "kind": component.kind.name,
        "symbol": symbol,
        "written": _span(component.span, names),
        "resources": {claim: assignment.resource for claim, assignment in component.claims.items()},
        "pins": {
            pin: component.claims[claim.name].pin_names[signal]
            for claim in component.kind.claims
            for signal, pin in sorted(claim.signals.items())
            if signal in component.claims[claim.name].pin_names
        },
        "dividers": {
            claim: divider
            for claim, assignment in component.claims.items()
            if (divider := describe_divider(assignment))
        },
        **({"starts": starts} if starts else {}),
        "uses": {use: used.component for use, used in component.uses.items()},
    }


def describe_divider(assignment: Assignment) -> dict[str, Any] | None:
    """The requested frequency and the frequency that the divider reaches, in Hz, and the steps in one period.

    ``error`` is the relative error of the frequency.  Returns None if the assignment has no frequency.
    """
    if assignment.frequency is None or assignment.asked is None:
        return None
    return {
        "asked": float(assignment.asked),
        "reached": float(assignment.frequency),
        "error": float(assignment.frequency / assignment.asked - 1),
        "steps": assignment.settings["top"] + 1,
    }


def _topic(view: TopicView) -> dict[str, Any]:
    """The description of one topic.

    ``values`` are the names of its values in the CSV files of topics and setpoints.  ``elements`` are the names of all
    elements of the message, also of those that are not bound.  ``timeout`` is in seconds; 0 means that setpoints do not
    become too old.
    """
    topic = view.topic
    setpoint = topic.values[0].setpoint if topic.values else None
    return {
        "topic": topic.name,
        "component": topic.component.name if topic.component else None,
        "type": view.ros_type,
        "qos": topic.qos,
        "depth": topic.depth,
        "role": topic.role,
        "values": [value.name for value in topic.values],
        "elements": [port.name for port in topic.component.kind.topic_ports] if topic.component else [],
        **({"timeout": float(setpoint.timeout), "on_timeout": setpoint.on_timeout} if setpoint else {}),
        **({"setpoints": [_setpoint(value) for value in topic.values]} if setpoint else {}),
    }


def _setpoint(value: TopicValue) -> dict[str, Any]:
    """The rules of one setpoint.  ``follows`` is the model input that it follows."""
    setpoint = value.setpoint
    assert setpoint is not None
    return {
        "name": value.name,
        "unit": setpoint.unit,
        "limits": list(setpoint.limits) if setpoint.limits else None,
        "follows": setpoint.followed.measured.port.name if setpoint.followed else None,
        "initial": setpoint.initial,
        "rate_limit": setpoint.rate_limit,
        "timeout": float(setpoint.timeout),
        "on_timeout": setpoint.on_timeout,
        "fresh": setpoint.fresh,
    }


def _messages(app: Application) -> dict[str, str]:
    """The complete definitions of messages of any type, by type, for programs that record them."""
    values = (value for component in app.components for value in component.parameters.values())
    return {v.ros_type: v.definition for v in values if isinstance(v, MessageType)}


def _wire(wire: Wire, section: str, app: Application, names: PathNames) -> dict[str, Any]:
    return {
        "port": wire.port.name,
        "unit": wire.port.unit,
        "index": wire.port.index,
        "type": wire.port.type,
        "symbol": f"{app.name}_{section}.{wire.port.identifier}",
        "component": wire.component.name,
        "component_port": wire.component_port.name,
        "component_unit": wire.component_port.unit,
        "steps": [_step(step) for step in wire.steps],
        "written": _span(wire.span, names),
        "model_file": _span(wire.port.span, names),
    }


def _step(step: ConversionStep) -> dict[str, Any]:
    limits = list(step.limits) if step.limits else None
    return {"reason": step.reason, "scale": float(step.scale), "offset": step.offset, "limits": limits}


def _span(span: Span, names: PathNames) -> str:
    return f"{names.shown(Path(span.file))}:{span.line}:{span.column}"
