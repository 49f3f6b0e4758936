# SPDX-License-Identifier: Apache-2.0
"""Compiles programs against the host platform and runs them."""

from __future__ import annotations

import csv
import json
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.runtime.program import build_program

TARGETS = Path(__file__).resolve().parents[3] / "targets"
HOST = TARGETS / "platforms" / "host"
RUNTIME = TARGETS / "runtime"
CONSOLE = TARGETS / "middlewares" / "console"
SCAN = [CONSOLE / "scan.c", CONSOLE / "frame.c"]
PROGRAMS = Path(__file__).resolve().parent / "programs"
SYSTEMS = {
    "linux": ("posix", "realtime", "linux"),
    "macos": ("posix", "realtime", "macos"),
    "windows": ("realtime", "windows"),
}
"""System -> the folders of its sources."""

WARNINGS = ["-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Wshadow", "-pedantic", "-Werror"]
ADDRESS_SANITIZER = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer"]
THREAD_SANITIZER = ["-fsanitize=thread"]


def compile_program(
    output: Path,
    sources: Sequence[Path],
    *,
    defines: Sequence[str] = (),
    sanitize: Sequence[str] = ADDRESS_SANITIZER,
) -> Path:
    """Compiles ``sources`` with the project's warning flags into the executable ``output``."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    assert compiler is not None, "a C compiler is needed"
    defines = ["EPG_HOST_TARGET=epg_host_application", *defines]
    command = [compiler, "-std=c11", "-O1", "-g", *WARNINGS, *sanitize]
    command += [f"-I{folder}" for folder in include_folders()] + [f"-D{define}" for define in defines]
    return build_program(command, output, sources)


def include_folders(system: str = "linux") -> list[Path]:
    """The folders of headers of the runtime and the host platform, for a program of ``system``."""
    links = [HOST / "src/links" / name for name in SYSTEMS[system]]
    return [RUNTIME / "include", HOST / "include", HOST / "src", CONSOLE, *links]


def platform_sources(*, main: bool = True, system: str = "linux") -> list[Path]:
    """All sources of the runtime and the host platform, as the build system would compile them."""
    parts = ("control", "communication", "model")
    folders = [RUNTIME / "src" / part for part in parts]
    folders += [*sorted((HOST / "src").iterdir())]
    folders += [folder for name in SYSTEMS[system] for folder in sorted((HOST / "src").glob(f"*/{name}"))]
    sources = [source for folder in folders for source in sorted(folder.glob("*.c"))] + SCAN
    return [source for source in sources if main or source.name != "main.c"]


@dataclass(frozen=True)
class Run:
    """A run that has ended, and the files that it wrote."""

    status: int
    stdout: str
    stderr: str
    folder: Path

    @property
    def statistics(self) -> dict[str, Any]:
        loaded: dict[str, Any] = json.loads((self.folder / "statistics.json").read_text())
        return loaded

    @property
    def trace(self) -> dict[str, list[float]]:
        """The columns of the trace by name."""
        with (self.folder / "trace.csv").open(newline="") as file:
            rows = list(csv.reader(file))
        return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}

    @property
    def topics(self) -> list[tuple[float, str, float]]:
        with (self.folder / "topics.csv").open(newline="") as file:
            rows = list(csv.reader(file))
        assert rows[0] == ["time", "topic", "value"]
        return [(float(time), topic, float(value)) for time, topic, value in rows[1:]]


@dataclass(frozen=True)
class Program:
    """A host executable."""

    path: Path

    def arguments(self, folder: Path, duration: float, setpoints: str | None, *more: str) -> list[str]:
        """Arguments that write every file into ``folder``; ``setpoints`` is the text of the setpoint file."""
        folder.mkdir(parents=True, exist_ok=True)
        command = [str(self.path), "--duration", str(duration), *more]
        for name, suffix in (("topics", "csv"), ("trace", "csv"), ("statistics", "json")):
            command += [f"--{name}", str(folder / f"{name}.{suffix}")]
        if setpoints is not None:
            (folder / "setpoints.csv").write_text(setpoints, newline="")
            command += ["--setpoints", str(folder / "setpoints.csv")]
        return command

    def run(self, folder: Path, duration: float, setpoints: str | None = None, *more: str) -> Run:
        done = subprocess.run(
            self.arguments(folder, duration, setpoints, *more),
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
            cwd=folder,
        )
        return Run(done.returncode, done.stdout, done.stderr, folder)

    def run_good(self, folder: Path, duration: float, setpoints: str | None = None, *more: str) -> Run:
        """Like ``run``, for a run that must succeed and must not print to stderr."""
        run = self.run(folder, duration, setpoints, *more)
        assert (run.status, run.stderr) == (0, "")
        return run


def rows(*events: str) -> str:
    """The text of a setpoint file."""
    return "\n".join(("time,topic,value", *events)) + "\n"
