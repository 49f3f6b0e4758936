# SPDX-License-Identifier: Apache-2.0
"""``epg check``: checks the given files as far as possible, without generating files."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from epg.cli.arguments import add_target_arguments, request_of
from epg.cli.system import is_system, read_system, system_data, system_text
from epg.generator.diagnostics import Diagnostics
from epg.system import SYSTEM_FILES

if TYPE_CHECKING:
    from epg.generator.project import Request
    from epg.generator.resolve.allocation import Assignments
    from epg.system.check_system import CheckedSystem


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


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    options.json = options.json or options.format == "json"
    missing = _missing(options)
    systems, hardware = _check(options, together=bool(options.model) and not missing, diagnostics=diagnostics)
    if not (options.files or options.tcf or missing):
        sys.stderr.write("epg check: name a .tcf or a system, or give --tcf, --model and --bindings\n")
        return 2
    if diagnostics.has_errors or options.format == "sarif":
        return 0  # main.py prints the diagnostics
    shown = hardware if options.hardware else None
    if options.json:
        _print_json(systems, shown, diagnostics)
    else:
        _print_text(systems, shown or {}, missing)
    return 0


def _check(
    options: argparse.Namespace, *, together: bool, diagnostics: Diagnostics
) -> tuple[list[CheckedSystem], dict[str, Assignments]]:
    """The systems that could be read, and the hardware of all targets without an error.

    ``together`` means that a target is checked together with its model.
    """
    from epg.generator.project import hardware_of, load_application

    request = request_of(options, "target")
    read = (read_system(Path(name), request.user_roots, diagnostics) for name in options.files)
    systems = [checked for checked in read if checked is not None]
    hardware = {name: hardware_of(app) for checked in systems for name, app in checked.applications.items()}
    if together:
        application = load_application(request, diagnostics)
        hardware |= {request.tcf: hardware_of(application)} if application is not None else {}
    else:
        hardware |= _check_separately(options, request, diagnostics)
    return systems, hardware


def _check_separately(
    options: argparse.Namespace, request: Request, diagnostics: Diagnostics
) -> dict[str, Assignments]:
    """Checks each file by itself.  Returns the hardware of each .tcf without an error."""
    from dataclasses import replace

    from epg.generator.catalog.catalog import load_catalog
    from epg.generator.check.bindings import load_bindings
    from epg.generator.importers import load_model
    from epg.generator.project import load_hardware

    catalog = load_catalog(request.roots, diagnostics)
    configurations = [name for name in options.files if not is_system(Path(name))]
    configurations += [options.tcf] if options.tcf else []
    hardware = {name: load_hardware(replace(request, tcf=name), catalog, diagnostics) for name in configurations}
    for model in filter(None, (options.model, options.plant)):
        load_model(model, diagnostics)
    for bindings in filter(None, (options.bindings, options.plant_bindings)):
        load_bindings(bindings, diagnostics)
    return {name: found for name, found in hardware.items() if found is not None}


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


def _print_text(systems: Sequence[CheckedSystem], hardware: Mapping[str, Assignments], missing: str) -> None:
    from epg.cli.table import table
    from epg.generator.emit.hardware import hardware_rows

    for checked in systems:
        print(f"{system_text(checked)}\n")
    for name, found in hardware.items():
        rows = table(("used by", "hardware", "pins", "frequency", "resolution"), hardware_rows(found))
        print(f"{name}\n\n{rows}\n")
    together = f" in each file separately; to check them together, add {missing}" if missing else ""
    print(f"no errors{together}")


def _print_json(
    systems: Sequence[CheckedSystem], hardware: Mapping[str, Assignments] | None, diagnostics: Diagnostics
) -> None:
    """Prints the result for programs.  ``hardware`` is None if the user has not asked for it."""
    from epg.cli.report import diagnostics_data, to_json
    from epg.generator.emit.hardware import hardware_data

    data: dict[str, Any] = {"diagnostics": diagnostics_data(diagnostics)}
    if systems:
        data["systems"] = [system_data(checked) for checked in systems]
    if hardware is not None:
        data["hardware"] = {name: hardware_data(found) for name, found in hardware.items()}
    sys.stdout.write(to_json(data))
