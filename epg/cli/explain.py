# SPDX-License-Identifier: Apache-2.0
"""``epg explain``: shows the wire of a port: model, conversion, component, peripheral, pins, C symbols.

It also explains the messages of EPG by their ids.  These have hyphens, which names of ports and components do not have.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import textwrap
from pathlib import Path
from typing import Any

from epg.cli.arguments import add_target_arguments, request_of
from epg.cli.messages import Entry, find_entry, read_page
from epg.cli.report import to_json
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.emit.hardware import divider_text
from epg.generator.source import Span


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("port", help="port of the model, component, or id of a message")
    parser.add_argument(
        "--build",
        type=Path,
        metavar="PATH",
        help="a <name>.json, or a folder to search for one; default: the current folder",
    )
    parser.add_argument("--name", default="target", help="name of the target, if --tcf is given")
    add_target_arguments(parser, required=False)


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    id = options.port.strip("[]")
    if "-" in id:
        entry = find_entry(id)
        if entry is not None:
            data = _data(id, entry)
            sys.stdout.write(to_json(data) if options.json else f"{textwrap.fill(data['text'], 100)}\n")
            return 0
        if not (options.tcf or options.build):
            hint = did_you_mean(id, (entry.id for entry in read_page()), "ids of messages")
            diagnostics.error("unknown-port", Span.of_argument(options.port), f"EPG has no message '{id}'", hint=hint)
            return 1
    if options.tcf and options.model and options.bindings:
        descriptions = [_from_files(options, diagnostics)]
    else:
        descriptions = _from_build(options.build or Path(), diagnostics)
    return _explain_port(options, descriptions, diagnostics)


def _explain_port(options: argparse.Namespace, descriptions: list[dict[str, Any]], diagnostics: Diagnostics) -> int:
    """Shows the wires of a port or component in all targets that have it.  Returns the exit status."""
    found = [(d, wire) for d in descriptions for wire in _wires(d, options.port)]
    if not found:
        return _without_wire(options.port, descriptions, diagnostics)
    if options.json:
        sys.stdout.write(to_json([{"target": d["name"], **wire, "resources": _hardware(d, wire)} for d, wire in found]))
    else:
        print("\n\n".join(_text(description, wire) for description, wire in found))
    return 0


def _without_wire(port: str, descriptions: list[dict[str, Any]], diagnostics: Diagnostics) -> int:
    """Says that an output is unconnected, or reports that there is no such port.  Returns the exit status."""
    model = next((d["model"]["name"] for d in descriptions if port in d["unconnected"]), None)
    if model is not None:
        print(f"{port}: output of {model}, unconnected")
        return 0
    names = {w["port"] for d in descriptions for w in _all(d)} | {c for d in descriptions for c in d["components"]}
    hint = did_you_mean(port, names, "ports and components")
    diagnostics.error("unknown-port", Span.of_argument(port), f"there is no port or component '{port}'", hint=hint)
    return 1


def _data(id: str, entry: Entry) -> dict[str, str]:
    """An entry of the page of errors, without the links of the page, which lead nowhere in a terminal."""
    return {"id": id, "text": re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", entry.text)}


def _from_files(options: argparse.Namespace, diagnostics: Diagnostics) -> dict[str, Any]:
    """The description of a target that is made from its files, without a build."""
    from epg.cli.generate import mistakes_in_templates
    from epg.generator.emit.application import Emitter
    from epg.generator.emit.cmake import PathNames
    from epg.generator.emit.description import describe
    from epg.generator.project import load_application

    request = request_of(options, options.name)
    app = diagnostics.checked(load_application(request, diagnostics))
    with mistakes_in_templates(request.user_roots, diagnostics):
        data: dict[str, Any] = json.loads(describe(Emitter(app, request.roots), PathNames(Path.cwd())))
    return data


def _from_build(path: Path, diagnostics: Diagnostics) -> list[dict[str, Any]]:
    """The descriptions of the generated targets below ``path``, or the one in the file ``path``."""
    from epg.runs.robot import description_files

    result = []
    for file in [path] if path.is_file() else description_files(path):
        try:
            data = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            continue
        if isinstance(data, dict) and "components" in data and "inputs" in data:
            result.append(data)
    if not result:
        span = Span(str(path))
        hint = "configure a build first, name its folder with --build, or give --tcf, --model and --bindings"
        diagnostics.error("no-description", span, "there is no generated target here", hint=hint)
        diagnostics.stop_if_errors()
    return result


def _all(description: dict[str, Any]) -> list[dict[str, Any]]:
    wires = [{**wire, "direction": "input"} for wire in description["inputs"]]
    wires += [{**wire, "direction": "output"} for wire in description["outputs"]]
    return wires


def _wires(description: dict[str, Any], name: str) -> list[dict[str, Any]]:
    return [wire for wire in _all(description) if name in (wire["port"], wire["component"])]


def _hardware(description: dict[str, Any], wire: dict[str, Any]) -> dict[str, Any]:
    component = description["components"][wire["component"]]
    return {key: component[key] for key in ("resources", "pins", "dividers", "starts") if key in component}


def _text(description: dict[str, Any], wire: dict[str, Any]) -> str:
    """The wire of one port as a table for the user."""
    model, component = description["model"], description["components"][wire["component"]]
    unit = f" [{wire['unit']}]" if wire["unit"] else ""
    component_unit = f" [{wire['component_unit']}]" if wire["component_unit"] else ""
    array = "u" if wire["direction"] == "input" else "y"
    rows = [
        (
            f"model {wire['direction']}",
            f"{wire['port']}{unit}, {wire['type']}",
            f"{model['name']}: {array}[{wire['index']}]",
        ),
        ("C symbol", wire["symbol"], wire["model_file"]),
        ("bound", f"{wire['component']}.{wire['component_port']}", wire["written"]),
    ]
    rows += [("conversion", _step_text(step), step["reason"]) for step in wire["steps"]]
    rows.append(
        (
            "component",
            f"{wire['component']}.{wire['component_port']}{component_unit}",
            f"{component['kind']}, {component['written']}",
        )
    )
    rows.append(("C symbol", component["symbol"], ""))
    rows += [("hardware", resource, claim) for claim, resource in component["resources"].items()]
    rows += [
        ("pin", f"GPIO {pin}" if isinstance(pin, int) else pin, signal) for signal, pin in component["pins"].items()
    ]
    for claim, divider in component["dividers"].items():
        frequency, remark = divider_text(divider)
        rows.append(("frequency", frequency, f"{claim}: {remark}"))
    rows += [
        ("start", start, f"{claim}: with the timer of the control loop")
        for claim, start in component.get("starts", {}).items()
    ]
    width = max(len(row[0]) for row in rows)
    second = max(len(row[1]) for row in rows)
    lines = [f"{a.ljust(width)}  {b.ljust(second)}  {c}".rstrip() for a, b, c in rows]
    return f"{description['name']} ({description['target']['name']})\n  " + "\n  ".join(lines)


def _step_text(step: dict[str, Any]) -> str:
    text = "value"
    if step["scale"] != 1:
        text += f" * {step['scale']!r}"
    if step["offset"]:
        text += f" + {step['offset']!r}"
    if step["limits"]:
        text += f", limited to {step['limits']}"
    return text
