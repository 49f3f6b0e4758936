# SPDX-License-Identifier: Apache-2.0
"""EPG's own C sources in the build of an image, compiled again with warnings as errors."""

from __future__ import annotations

import json
import shlex
import subprocess
from pathlib import Path

from tests.doubles.toolchain import ROOT

STRICT = ("-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror")
NOT_OURS = "_export"
"""Parts of the names of generated files that contain the user's model."""


def own_sources(build: Path) -> dict[Path, list[str]]:
    """EPG's C files and the generated ones, each with a command that compiles it."""
    found = {}
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        file = Path(entry["file"])
        ours = file.is_relative_to(ROOT / "targets") or file.is_relative_to(build / "epg")
        if ours and NOT_OURS not in file.name:
            found[file] = shlex.split(entry["command"])
    return found


def problems(command: list[str]) -> str:
    """The compiler's messages with all of :data:`STRICT`; it writes no file."""
    output = command.index("-o")
    arguments = command[:output] + command[output + 2 :]
    done = subprocess.run([*arguments, *STRICT, "-fsyntax-only"], capture_output=True, text=True, check=False)
    return done.stderr
