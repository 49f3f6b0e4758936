# SPDX-License-Identifier: Apache-2.0
"""``epg exported``: checks an export and names the next steps.  EPG's target for 20-sim starts it after an export."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from epg.generator.diagnostics import Diagnostics


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder of the export")
    then = "then run 'epg connect' with it until the page is closed"
    parser.add_argument("--connect", action="store_true", help=then)


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.cli import ports

    folder = Path(os.path.abspath(options.folder))
    if _forget_people(folder / "ModelConfiguration.xml") and not options.json:
        print("ModelConfiguration.xml: the path of the model file and the license were removed.\n")
    options.model = folder
    status = ports.run(options, diagnostics)  # raises UserError if the model cannot be used: then nothing can follow
    if options.connect and not options.json:
        return _connect(folder, diagnostics)
    if not options.json:
        print("\nNext: connect its ports in the browser:")
        print(f'  epg connect "{folder}"')
        print("or choose a target ('epg targets' lists them) and start a project with this model:")
        print(f'  epg new --target NAME --model "{folder}" PROJECT')
        print("or copy this folder into an existing project, and run 'epg bind' there to add the new ports.")
    return status


def _connect(folder: Path, diagnostics: Diagnostics) -> int:
    """Runs ``epg connect`` for the project that uses the model in ``folder``, or for a new project with this model."""
    from epg.cli import connect

    print("\nNext: connect its ports in the page that the browser opens, or at this address:", flush=True)
    parser = argparse.ArgumentParser()
    parser.add_argument("--json", action="store_true")  # epg.cli.main adds this option to all commands
    connect.add_arguments(parser)
    return connect.run(parser.parse_args(["--until-closed", "--", str(folder)]), diagnostics)


def _forget_people(configuration: Path) -> bool:
    """Removes personal data, such as the path of the model file and the license, from a file.

    The file is replaced atomically.  Returns True if it contained such data.
    """
    from epg.generator.emit.leftovers import replace_file
    from epg.generator.models.personal import without_personal_data

    try:
        before = configuration.read_bytes()
    except FileNotFoundError:
        return False
    after = without_personal_data(before)
    if after != before:
        replace_file(configuration, after)
    return after != before
