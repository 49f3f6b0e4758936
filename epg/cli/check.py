# SPDX-License-Identifier: Apache-2.0
"""``epg check``: checks the given files as far as possible, without generating files."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from epg.cli.arguments import add_target_arguments, request_of
from epg.cli.system import is_system, read_system, system_data, system_text
from epg.diagnostics import Diagnostics
from epg.system import SYSTEM_FILES

if TYPE_CHECKING:
    from epg.resolve.allocation import Hardware


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "files",
        nargs="*",
        metavar="FILE",
        help=f".tcf files to check separately, and systems (*{SYSTEM_FILES}) to check with all of their targets",
    )
    parser.add_argument(
        "--format", choices=("text", "json", "sarif"), help="form of the output; sarif: SARIF 2.1.0, for CI and editors"
    )
    parser.add_argument(
        "--hardware", action="store_true", help="also list the peripherals, pins and actual frequencies"
    )
    add_target_arguments(parser, required=False)


# One function, because it is the course of the command: load, check, report and choose the exit status.
def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from dataclasses import replace

    from epg.catalog.catalog import load_catalog
    from epg.check.bindings import load_bindings
    from epg.models import load_model
    from epg.project import hardware_of, load_application, load_hardware

    options.json = options.json or options.format == "json"
    request = request_of(options, "target")
    hardware: dict[str, Hardware] = {}
    read = (read_system(Path(name), request.user_roots, diagnostics) for name in options.files)
    systems = [checked for checked in read if checked is not None]
    for checked in systems:
        hardware |= {name: hardware_of(application) for name, application in checked.applications.items()}
    missing = _missing(options)
    if options.model and not missing:
        application = load_application(request, diagnostics)
        hardware |= {options.tcf: hardware_of(application)} if application is not None else {}
    else:
        catalog = load_catalog(request.roots, diagnostics)
        alone = [name for name in options.files if not is_system(Path(name))]
        for name in [*alone, *([options.tcf] if options.tcf else [])]:
            found = load_hardware(replace(request, tcf=name), catalog, diagnostics)
            hardware |= {name: found} if found is not None else {}
        for model in filter(None, (options.model, options.plant)):
            load_model(model, diagnostics)
        for bindings in filter(None, (options.bindings, options.plant_bindings)):
            load_bindings(bindings, diagnostics)
    if not (options.files or options.tcf or missing):
        sys.stderr.write("epg check: name a .tcf or a system, or give --tcf, --model and --bindings\n")
        return 2
    if diagnostics.has_errors or options.format == "sarif":
        return 0  # main.py prints the diagnostics
    if not options.json:
        for checked in systems:
            print(f"{system_text(checked)}\n")
        _print_hardware(hardware if options.hardware else {})
        together = f" in each file separately; to check them together, add {missing}" if missing else ""
        print(f"no errors{together}")
    else:
        from epg.cli.report import to_json
        from epg.emit.hardware import hardware_data

        data: dict[str, Any] = {"diagnostics": [item.data() for item in diagnostics]}
        if systems:
            data["systems"] = [system_data(checked) for checked in systems]
        if options.hardware:
            data["hardware"] = {name: hardware_data(found) for name, found in hardware.items()}
        sys.stdout.write(to_json(data))
    return 0


def _missing(options: argparse.Namespace) -> str:
    """The options that are missing to check a model, bindings or a plant together with their target.

    Empty if no such file is given, or if all options are given.
    """
    target = {"--tcf": options.tcf, "--model": options.model, "--bindings": options.bindings}
    plant = {"--plant": options.plant, "--plant-bindings": options.plant_bindings}
    if not any((options.model, options.bindings, *plant.values())):
        return ""
    needed = {**target, **plant} if any(plant.values()) else target
    return ", ".join(name for name, value in needed.items() if not value)


def _print_hardware(hardware: Mapping[str, Hardware]) -> None:
    from epg.cli.table import table
    from epg.emit.hardware import hardware_rows

    for name, found in hardware.items():
        rows = table(("used by", "hardware", "pins", "frequency", "resolution"), hardware_rows(found))
        print(f"{name}\n\n{rows}\n")
