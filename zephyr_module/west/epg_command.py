# Copyright (c) The EPG contributors
# SPDX-License-Identifier: Apache-2.0

"""``west epg ...``: runs the command line of the EPG in the west workspace.

It runs with the same Python interpreter as west.  EPG installs packages that this interpreter lacks into its own cache
(``epg/generator/bootstrap.py``).
"""

import argparse
import subprocess
import sys
from pathlib import Path

from west.commands import WestCommand

PROGRAM = Path(__file__).resolve().parents[2] / "epg" / "__main__.py"


class Epg(WestCommand):
    """Passes all its arguments to EPG, and ends with EPG's exit status."""

    def __init__(self):
        super().__init__(
            "epg",
            "check, explain and create targets of EPG",
            "Runs the command line of EPG: 'west epg --help' lists its commands.",
        )

    def do_add_parser(self, parser_adder):
        # No argument begins with this prefix.  So west takes none of them as its own option, not even --help or --.
        parser = parser_adder.add_parser(self.name, add_help=False, prefix_chars="\0", description=self.description)
        parser.add_argument("arguments", nargs=argparse.REMAINDER)
        return parser

    def do_run(self, args, unknown):
        with subprocess.Popen([sys.executable, str(PROGRAM), *args.arguments]) as epg:
            while True:
                try:
                    status = epg.wait()
                    break
                except KeyboardInterrupt:  # Ctrl-C reaches EPG, too: wait until `record` has completed its file
                    pass
        sys.exit(status if status >= 0 else 128 - status)
