"""``epg exported``: what follows an export by EPG's target for 20-sim, which starts this command."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from epg.diagnostics import Diagnostics


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder of the export")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.cli import ports

    folder: Path = options.folder
    if _forget_people(folder / "ModelConfiguration.xml") and not options.json:
        print("ModelConfiguration.xml: the path of the model file and the license were taken out.\n")
    options.model = folder
    status = ports.run(options, diagnostics)
    if not options.json:
        print("\nNext: choose a target ('epg targets' lists them) and start a project with this model:")
        print(f'  epg new --target NAME --model "{folder.resolve()}" PROJECT')
        print("or copy this folder into a project that you have, and run 'epg bind' there for its new ports.")
    return status


def _forget_people(configuration: Path) -> bool:
    """Takes the path of the model file and the license out of a file, at once or not at all; whether they were in."""
    from epg.load.models.personal import without_personal_data

    try:
        before = configuration.read_bytes()
    except FileNotFoundError:
        return False
    after = without_personal_data(before)
    if after != before:
        temporary = configuration.with_name(configuration.name + ".new")
        temporary.write_bytes(after)
        os.replace(temporary, configuration)
    return after != before
