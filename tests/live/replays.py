# SPDX-License-Identifier: Apache-2.0
"""Host programs that are recorded and replayed, and what a test does with them."""

from __future__ import annotations

import contextlib
import os
import pty
import re
import select
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.cmake.built import SANITIZERS, built

from .target import Target

ROOT = Path(__file__).resolve().parents[2]
PROJECT = Path(__file__).resolve().parent / "replayed"


@pytest.fixture(scope="session")
def programs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with the programs of ``replayed``."""
    return build_programs(tmp_path_factory.mktemp("replayed"))


def build_programs(build: Path, *targets: str) -> Path:
    """Builds the programs, or only ``targets``, in the folder ``build``."""
    options = (f"-DCMAKE_C_FLAGS={SANITIZERS}", f"-DCMAKE_CXX_FLAGS={SANITIZERS}")
    return built(PROJECT, build, *options, targets=targets)


def epg(*arguments: str | Path, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "epg", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, timeout=120, check=False)


def record(target: Target, path: Path, *lines: str, seconds: float) -> subprocess.CompletedProcess[str]:
    """Records a running program with ``epg live``, which sends ``lines`` first."""
    sent = [word for line in lines for word in ("--send", line)]
    done = epg("live", target.port, "--record", path, *sent, "--duration", str(seconds))
    assert done.returncode == 0, done.stdout + done.stderr
    return done


def record_at_terminal(target: Target, path: Path, *typed: tuple[float, str], seconds: float) -> str:
    """Records with the screen of ``epg live``, at which a user types lines, each at its time.  Returns the output."""
    process, terminal = pty.fork()
    if process == 0:
        os.chdir(ROOT)
        os.environ["TERM"] = "xterm"
        arguments = ["live", str(target.port), "--record", str(path), "--duration", str(seconds)]
        os.execv(sys.executable, [sys.executable, "-m", "epg", *arguments])
    seen = ""
    left = list(typed)
    begin = 0.0
    with contextlib.suppress(OSError):  # the program has ended
        while True:
            if select.select([terminal], [], [], 0.05)[0]:
                seen += os.read(terminal, 65536).decode("utf-8", "replace")
                begin = begin or time.monotonic()  # a user types at these times
            if left and begin and time.monotonic() - begin > left[0][0]:  # a user types at these times
                os.write(terminal, left.pop(0)[1].encode() + b"\r")
    os.close(terminal)
    assert os.waitpid(process, 0)[1] == 0, seen[-3000:]
    return seen


def cells(text: str, output: str) -> list[str]:
    """The cells of the row of ``output`` in a table."""
    (line,) = [line for line in text.splitlines() if line.startswith(f"{output} ")]
    return re.split(r" {2,}", line)


class Text:
    """A recording as text that a test changes."""

    def __init__(self, path: Path) -> None:
        self.facts, header, *rows = path.read_text().splitlines()
        self.names = header.split(",")
        self.rows = [row.split(",") for row in rows]

    def line_of(self, cycle: int) -> int:
        """The line of a cycle in the file."""
        return self.index(cycle) + 3

    def index(self, cycle: int) -> int:
        return next(i for i, row in enumerate(self.rows) if row[1] == str(cycle))

    def cell(self, cycle: int, name: str) -> str:
        return self.rows[self.index(cycle)][self.names.index(name)]

    def change(self, cycle: int, name: str, text: str) -> None:
        self.rows[self.index(cycle)][self.names.index(name)] = text

    def write(self, path: Path) -> Path:
        lines = [self.facts, ",".join(self.names), *(",".join(row) for row in self.rows)]
        path.write_text("\n".join(lines) + "\n")
        return path
