# SPDX-License-Identifier: Apache-2.0
"""``epg generate``: writes the sources of one target into a build folder.  CMake calls it while it configures."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from epg.cli.arguments import add_target_arguments, request_of, user_roots
from epg.cli.output import add_output_arguments, update_folder, write_warnings
from epg.generator.diagnostics import Diagnostics, UserError

if TYPE_CHECKING:
    from epg.generator.project import Request


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", help="name of the target: prefix of its C symbols")
    add_output_arguments(parser)
    parser.add_argument(
        "--system", type=Path, metavar="FILE", help="the system that has this target, instead of --tcf and the others"
    )
    add_target_arguments(parser, required=False)


@contextmanager
def mistakes_in_templates(user_roots: Sequence[Path], diagnostics: Diagnostics) -> Iterator[None]:
    """Reports a mistake in a template of the user's own kinds and platforms.  Any other exception is a bug in EPG."""
    from epg.generator.emit.template import NOT_UTF_8, mistake_in_template
    from epg.generator.source import Span

    try:
        yield
    except UserError:
        raise
    except Exception as error:
        file, line, message = mistake_in_template(error) or ("", 0, "")
        if any(Path(file).is_relative_to(root) for root in user_roots):
            hint = "docs/adding-a-component-kind.md describes the values that a template can print"
            hint = "save it as UTF-8" if message == NOT_UTF_8 else hint
            told = f"this template does not work: {message}"
            diagnostics.error("template-wrong", Span(file, line, 1), told, hint=hint)
            diagnostics.stop_if_errors()
        raise


def _request(options: argparse.Namespace, diagnostics: Diagnostics) -> Request:
    """The request of the target: from a system, or from the files that the options name."""
    if options.system is None:
        missing = [f"--{key}" for key in ("tcf", "model", "bindings") if getattr(options, key) is None]
        if missing:
            options.parser.error(f"the following arguments are required: {', '.join(missing)}")
        return request_of(options, options.name)
    from epg.cli.system import system_of, target_of

    system, caller = system_of(options, diagnostics)
    return system.request(target_of(system, options.name, caller, diagnostics), user_roots(), options.ioc)


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.generator.emit.cmake import PathNames
    from epg.generator.emit.outputs import application_outputs
    from epg.generator.project import load_application

    request = _request(options, diagnostics)
    app = diagnostics.checked(load_application(request, diagnostics))
    if not app.target.platform.builds:
        span = app.target_span
        message = f"{app.target.name} can be checked, but this EPG has no port layer for {app.target.platform.name}"
        diagnostics.error("platform-not-built", span, message, hint="choose another target: 'epg targets' lists them")
        diagnostics.stop_if_errors()
    communication = app.communication
    if not communication.middleware.builds:
        name = communication.middleware.name
        others = ", ".join(other for other in app.target.platform.middlewares if other != name)
        message = f"middleware '{name}' can be checked, but this EPG has no code for it"
        diagnostics.error("middleware-not-built", communication.span, message, hint=f"choose another one: {others}")
        diagnostics.stop_if_errors()
    with mistakes_in_templates(request.user_roots, diagnostics):
        files = application_outputs(app, request.roots, PathNames(options.source_dir))
    update_folder(options.output, files, sys.stdout if options.json else None)
    write_warnings(options.warnings, diagnostics)
    return 0
