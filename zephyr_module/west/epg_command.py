# Copyright (c) The EPG contributors
# SPDX-License-Identifier: Apache-2.0

"""``west epg ...``: the command line of the EPG that the workspace has.

It runs in the Python that west runs in.  Packages that this Python lacks, EPG installs into its own cache
(``epg/bootstrap.py``).
"""

import argparse
import subprocess
import sys
from pathlib import Path

from west.commands import WestCommand

PROGRAM = Path(__file__).resolve().parents[2] / "epg" / "__main__.py"


class Epg(WestCommand):
    """Hands all its words to EPG, whose exit status becomes west's."""

    def __init__(self):
        super().__init__(
            "epg",
            "check and explain targets of EPG, write new ones",
            "The command line of EPG: 'west epg --help' lists its commands.",
        )

    def do_add_parser(self, parser_adder):
        # No word begins with this prefix: so none is an option of west's, --help and -- included.
        parser = parser_adder.add_parser(self.name, add_help=False, prefix_chars="\0", description=self.description)
        parser.add_argument("arguments", nargs=argparse.REMAINDER)
        return parser

    def do_run(self, args, unknown):
        with subprocess.Popen([sys.executable, str(PROGRAM), *args.arguments]) as epg:
            while True:
                try:
                    status = epg.wait()
                    break
                except KeyboardInterrupt:  # EPG was interrupted too: `record` ends its file then
                    pass
        sys.exit(status if status >= 0 else 128 - status)
