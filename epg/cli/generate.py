"""``epg generate``: the sources of one target into a build folder; CMake calls this while it configures."""

from __future__ import annotations

import argparse
import sys

from epg.cli.arguments import add_target_arguments, request_of
from epg.cli.output import add_output_arguments, update_folder, write_warnings
from epg.diagnostics import Diagnostics


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", help="name of the target: prefix of its C symbols")
    add_output_arguments(parser)
    add_target_arguments(parser, required=True)


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.emit.cmake import PathNames
    from epg.emit.outputs import application_outputs
    from epg.project import load_application

    request = request_of(options, options.name)
    app = load_application(request, diagnostics)
    diagnostics.stop_if_errors()
    assert app is not None
    if not app.target.platform.builds:
        span = app.target_span
        message = f"{app.target.name} can be checked, but this EPG has no port layer for {app.target.platform.name}"
        diagnostics.error("platform-not-built", span, message, hint="choose another target: 'epg targets' lists them")
        diagnostics.stop_if_errors()
    names = PathNames(options.source_dir)
    update_folder(
        options.output,
        application_outputs(app, request.roots, names),
        sys.stdout if options.json else None,
    )
    write_warnings(options.warnings, diagnostics)
    return 0
