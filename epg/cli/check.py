# SPDX-License-Identifier: Apache-2.0
"""``epg check``: everything that can be checked of the files that are given."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from epg.cli.arguments import add_target_arguments, request_of
from epg.diagnostics import Diagnostics

if TYPE_CHECKING:
    from epg.project import Hardware


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", nargs="*", metavar="FILE", help=".tcf files to check by themselves")
    parser.add_argument(
        "--format", choices=("text", "json", "sarif"), help="what is printed; sarif: SARIF 2.1.0, for CI and editors"
    )
    parser.add_argument(
        "--hardware", action="store_true", help="also list peripherals, pins, and the frequencies that are reached"
    )
    add_target_arguments(parser, required=False)


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from dataclasses import replace

    from epg.catalog.catalog import load_catalog
    from epg.check.bindings import load_bindings
    from epg.models import load_model
    from epg.project import hardware_of, load_application, load_hardware

    options.json = options.json or options.format == "json"
    request = request_of(options, "target")
    hardware: dict[str, Hardware] = {}
    if options.tcf and options.model and options.bindings:
        application = load_application(request, diagnostics)
        hardware = {options.tcf: hardware_of(application)} if application is not None else {}
    else:
        catalog = load_catalog(request.roots, diagnostics)
        for name in [*options.files, *([options.tcf] if options.tcf else [])]:
            found = load_hardware(replace(request, tcf=name), catalog, diagnostics)
            hardware |= {name: found} if found is not None else {}
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
        _print_hardware(hardware if options.hardware else {})
        print("no errors")
    else:
        from epg.cli.report import diagnostics_json, to_json
        from epg.emit.hardware import hardware_data

        data: dict[str, Any] = {"diagnostics": diagnostics_json(diagnostics)}
        if options.hardware:
            data["hardware"] = {name: hardware_data(found) for name, found in hardware.items()}
        sys.stdout.write(to_json(data))
    return 0


def _print_hardware(hardware: Mapping[str, Hardware]) -> None:
    from epg.cli.hardware import hardware_table

    for name, found in hardware.items():
        print(f"{name}\n\n{hardware_table(found)}\n")
