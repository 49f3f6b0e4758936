# SPDX-License-Identifier: Apache-2.0
"""``epg graph``: draws pictures of a target."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from epg.cli.arguments import add_settings, request_of, user_roots
from epg.cli.report import to_json
from epg.cli.system import is_system, read_system
from epg.generator.catalog.catalog import load_catalog
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import Request

PICTURES = ("application", "schedule", "wiring")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "tcf",
        metavar="TARGET.tcf",
        help="target configuration: a file, or the name of a predefined .tcf; or a system (*.system.yaml)",
    )
    what = "application: topics, pins, components and model; schedule: one control cycle; wiring: the pins of the board"
    parser.add_argument("--what", choices=PICTURES, default="application", help=what)
    parser.add_argument("--model", type=Path, metavar="FOLDER", help="folder of the model; not needed for the wiring")
    parser.add_argument("--bindings", type=Path, metavar="FILE", help="bindings of the model's ports")
    parser.add_argument("--output", "-o", type=Path, metavar="FILE.svg", help="file to write; default: standard output")
    add_settings(parser)
    parser.add_argument("--name", default="", help="name of the target in the picture; default: the .tcf's name")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    system = is_system(Path(options.tcf))
    if not system and options.what != "wiring" and (options.model is None or options.bindings is None):
        sys.stderr.write(f"epg graph: --what {options.what} needs --model FOLDER and --bindings FILE\n")
        return 2
    request = request_of(options, options.name or "target")
    title = options.name or Path(options.tcf).stem
    if system:
        text = _system(Path(options.tcf), diagnostics)
    elif options.what == "wiring":
        text = _wiring(request, title, diagnostics)
    else:
        text = _flow(options, request, title, diagnostics)
    if options.output is not None:
        from epg.generator.emit.writer import write_outputs

        write_outputs(options.output.parent, {options.output.name: text})
    elif options.json:
        sys.stdout.write(to_json({"what": "system" if system else options.what, "svg": text}))
    else:
        sys.stdout.write(text)
    return 0


def _system(path: Path, diagnostics: Diagnostics) -> str:
    from epg.system.picture import draw_system

    return draw_system(diagnostics.checked(read_system(path, user_roots(), diagnostics)))


def _wiring(request: Request, title: str, diagnostics: Diagnostics) -> str:
    """The picture of the wiring.  It depends only on the ``.tcf``, so that no model is needed."""
    from epg.generator.project import load_configuration
    from epg.generator.resolve.resolve import allocate_hardware
    from epg.graph.wiring import draw_wiring

    configuration = load_configuration(request, load_catalog(request.roots, diagnostics), diagnostics)
    configuration = diagnostics.checked(configuration)
    assignments = allocate_hardware(configuration, configuration.control.period, diagnostics)
    target = configuration.target
    if target.board.layout is None:
        message = f"EPG cannot draw the wiring of {target.board.summary}"
        diagnostics.error("no-layout", configuration.root["target"].span, message, hint="it has no pins")
    return draw_wiring(target, configuration.components, diagnostics.checked(assignments), title)


def _flow(options: argparse.Namespace, request: Request, title: str, diagnostics: Diagnostics) -> str:
    from epg.generator.emit.application import Emitter
    from epg.generator.project import load_application
    from epg.graph.application import draw_application
    from epg.graph.schedule import draw_schedule

    app = diagnostics.checked(load_application(request, diagnostics))
    if options.what == "schedule":
        return draw_schedule(app, title)
    return draw_application(app, Emitter(app, request.roots).topics(), title)
