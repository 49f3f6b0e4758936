# SPDX-License-Identifier: Apache-2.0
"""Converts a corpus of libFuzzer to lines for the tests: ``python samples.py corpus >> xrce_fuzz.txt``.

Short inputs come first.  Long inputs are omitted, because they rarely reach other code.
"""

from __future__ import annotations

import sys
from pathlib import Path

LONGEST = 150


def main(folder: str) -> None:
    inputs = {path.read_bytes() for path in Path(folder).iterdir()}
    for data in sorted(inputs, key=lambda data: (len(data), data)):
        if 0 < len(data) <= LONGEST:
            print(data.hex())


if __name__ == "__main__":
    main(sys.argv[1])
