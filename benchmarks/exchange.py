# SPDX-License-Identifier: Apache-2.0
"""Measures the time to write a value into the exchange and to read it, for several sizes of the value."""

from __future__ import annotations

import tempfile
from pathlib import Path

from measure import run
from report import Table, arguments, command_line, show
from runtime import RUNTIME, WARNINGS, compile_c, link

SOURCE = Path(__file__).resolve().parent / "exchange.c"


def main() -> None:
    options = arguments(__doc__, thousands=2000)
    with tempfile.TemporaryDirectory() as name:
        sources = [SOURCE, RUNTIME / "src" / "exchange.c"]
        folders = [Path(name) / str(number) for number in range(len(sources))]
        objects = [compile_c(s, folder, [RUNTIME / "include"], WARNINGS) for s, folder in zip(sources, folders)]
        lines = run([link(objects, Path(name) / "exchange"), str(options.thousands)]).splitlines()
    head = ["bytes", "write", "read", "take, nothing new", "write against a reader", "read against a writer"]
    note = "The best of five series. The other thread does nothing else, so the words change caches all the time."
    show("exchange", [Table("Exchange, ns", head, [line.split() for line in lines], [note])], options.write, PROGRAM)


PROGRAM = command_line("exchange")

if __name__ == "__main__":
    main()
