# SPDX-License-Identifier: Apache-2.0
"""Lists the drives of boards whose boot program takes UF2 files, and copies a file to such a drive.

The boot program describes itself in the file INFO_UF2.TXT of its drive (https://github.com/microsoft/uf2).
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.system import here

INFO = "INFO_UF2.TXT"
PATIENCE = 10.0
"""The longest time in seconds in which a board must restart after the last block of a file."""
_PART = 1 << 16


@dataclass(frozen=True)
class Uf2Drive:
    """A drive.  ``board`` is the Board-ID that its boot program states, such as RPI-RP2."""

    folder: Path
    board: str


def uf2_drives() -> list[Uf2Drive]:
    """The drives that are there now."""
    found = []
    for folder in here.drives():
        try:
            text = (folder / INFO).read_text(encoding="ascii", errors="replace")
        except OSError:
            continue
        board = re.search(r"^Board-ID: *(\S+)", text, re.MULTILINE)
        if board is not None:
            found.append(Uf2Drive(folder, board[1]))
    return found


def copy_to_drive(file: Path, drive: Uf2Drive, progress: Callable[[int, int], None]) -> str:
    """Copies ``file`` to ``drive``, and waits until its board restarts.  Returns a problem; empty if there is none.

    ``progress`` gets the number of bytes that were written, and that of all.
    """
    data = file.read_bytes()
    try:
        with (drive.folder / file.name).open("wb", buffering=0) as copy:
            for start in range(0, len(data), _PART):
                copy.write(data[start : start + _PART])
                os.fsync(copy.fileno())
                progress(min(start + _PART, len(data)), len(data))
    except OSError as error:
        if (drive.folder / INFO).exists():
            return f"cannot write to {drive.folder}: {error.strerror}"
        return ""  # the board has restarted at the last block, before this computer has closed the file
    until = time.monotonic() + PATIENCE
    while (drive.folder / INFO).exists():
        if time.monotonic() > until:
            return f"the board has not restarted: {drive.folder} is still there after {PATIENCE:g} s"
        time.sleep(0.1)
    return ""
