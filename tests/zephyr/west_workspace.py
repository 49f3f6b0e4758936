# SPDX-License-Identifier: Apache-2.0
"""Workspaces that west has made from a manifest, and builds in them, as on a user's first day.

>>> # place = fresh_workspace("examples/zephyr_jiwy", tmp_path / "ws")      # west init, west update
>>> # west(place, "build", "-b", "rpi_pico", "jiwy/app")
"""

from __future__ import annotations

import subprocess
from pathlib import Path

from tests.doubles.toolchain import ROOT

from .mirror import mirror
from .workspace import HALS, BuildError, workspace

BOARDS = ("rpi_pico", "nucleo_h743zi")
assert set(BOARDS) <= set(HALS)


def west(folder: Path, *words: str, check: bool = True) -> str:
    """The output of west in a folder.  It finds only the workspace's Zephyr.  Raises :class:`BuildError`."""
    here = workspace(*BOARDS)
    environment = {**here.environment(), **mirror(here).variables}
    del environment["ZEPHYR_BASE"]
    command = [str(here.python), "-m", "west", *words]
    done = subprocess.run(
        command, cwd=folder, env=environment, text=True, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    )
    if check and done.returncode != 0:
        raise BuildError(f"west {' '.join(words)}\n{done.stdout}")
    return done.stdout


def fresh_workspace(repository: str, folder: Path) -> Path:
    """A workspace made by ``west init`` and ``west update``; its manifest is in a folder of this repository."""
    address = f"https://example.org/{Path(repository).name}"
    mirror(workspace(*BOARDS)).add(address, ROOT / repository)
    west(folder.parent, "init", "-m", address, str(folder))
    west(folder, "update")
    return folder
