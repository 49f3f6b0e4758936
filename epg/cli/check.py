"""``epg check``: everything that can be checked of the files that are given."""

from __future__ import annotations

import argparse
import sys

from epg.cli.arguments import add_target_arguments, request_of
from epg.diagnostics import Diagnostics


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", nargs="*", metavar="FILE", help=".tcf files to check by themselves")
    parser.add_argument(
        "--format", choices=("text", "json", "sarif"), help="what is printed; sarif: SARIF 2.1.0, for CI and editors"
    )
    add_target_arguments(parser, required=False)


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from dataclasses import replace

    from epg.check.bindings import load_bindings
    from epg.load.models import load_model
    from epg.project import check_target, load_application, make_catalog

    options.json = options.json or options.format == "json"
    request = request_of(options, "target")
    if options.tcf and options.model and options.bindings:
        load_application(request, diagnostics)
    else:
        catalog = make_catalog(request.roots, diagnostics)
        for name in [*options.files, *([options.tcf] if options.tcf else [])]:
            check_target(replace(request, tcf=name), catalog, diagnostics)
        if options.model:
            load_model(options.model, diagnostics)
        if options.bindings:
            load_bindings(options.bindings, diagnostics)
    if not (options.files or options.tcf or options.model or options.bindings):
        sys.stderr.write("epg check: name a .tcf, or give --tcf, --model and --bindings\n")
        return 2
    if diagnostics.has_errors or options.format == "sarif":
        return 0  # the caller prints what there is
    if not options.json:
        print("no errors")
    else:
        from epg.cli.report import diagnostics_json, to_json

        sys.stdout.write(to_json({"diagnostics": diagnostics_json(diagnostics)}))
    return 0
