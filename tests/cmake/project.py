# SPDX-License-Identifier: Apache-2.0
"""Small CMake projects for tests: configure, build, and see the effects."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
PROJECTS = Path(__file__).resolve().parent / "projects"
CMAKE_DIR = ROOT / "cmake"
NINJA = shutil.which("ninja")


def copy_jiwy(folder: Path, *parts: str) -> None:
    """Copies parts of examples/jiwy with their bindings into ``folder``: "model", "plant"."""
    for part in parts:
        shutil.copytree(ROOT / "examples/jiwy" / part, folder / part)
        bindings = {"model": "jiwy", "plant": "plant"}[part]
        shutil.copy(ROOT / "examples/jiwy" / f"{bindings}.bindings.yaml", folder)


@dataclass
class Project:
    """A copy of ``projects/<name>`` with the folders beside it, and a build folder next to it."""

    folder: Path
    name: str
    environment: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        shutil.copytree(PROJECTS, self.folder / "projects", dirs_exist_ok=True)

    @property
    def source(self) -> Path:
        return self.folder / "projects" / self.name

    @property
    def build_folder(self) -> Path:
        return self.folder / "build"

    def configure(self, *arguments: str, generator: str = "", epg_dir: bool = True, check: bool = True) -> str:
        """Configures; returns the whole output.  Without ``generator``: Ninja if it is installed, else Make."""
        generator = generator or ("Ninja" if NINJA else "Unix Makefiles")
        if generator.startswith("Ninja") and not NINJA:
            pytest.skip("Ninja is not installed: sudo apt install ninja-build")
        command = ["cmake", "-S", str(self.source), "-B", str(self.build_folder), "-G", generator, *arguments]
        command += [f"-DPython3_EXECUTABLE={sys.executable}"] if not any("Python3_" in a for a in arguments) else []
        command += [f"-DEPG_DIR={CMAKE_DIR}"] if epg_dir else []
        return self._run(command, check)

    def build(self, *arguments: str, check: bool = True) -> str:
        """Builds; returns the whole output."""
        return self._run(["cmake", "--build", str(self.build_folder), "--verbose", *arguments], check)

    def fails_to_configure(self, *arguments: str, **options: object) -> str:
        """Configures, expects an error, and returns the output."""
        output = self.configure(*arguments, check=False, **options)  # type: ignore[arg-type]
        assert "CMake Error" in output, output
        return output

    def edit(self, file: str, old: str, new: str) -> None:
        """Replaces text in a file of the project."""
        path = self.source / file
        text = path.read_text(encoding="utf-8")
        assert old in text
        path.write_text(text.replace(old, new), encoding="utf-8")
        # some file systems, and make, compare only whole seconds
        later = path.stat().st_mtime + 2
        os.utime(path, (later, later))

    def _run(self, command: list[str], check: bool) -> str:
        environment = {k: v for k, v in os.environ.items() if k not in ("EPG_DIR", "EPG_PATH", "EPG_TARGETS_PATH")}
        done = subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment | self.environment
        )
        assert not check or done.returncode == 0, done.stdout
        return done.stdout


def compiled(output: str) -> set[str]:
    """The names of the sources that a build has compiled."""
    return {Path(found).name for found in re.findall(r" -c (?:\S*/)?(\S+\.(?:c|cpp))\b", output)}


def snapshot(folder: Path) -> dict[str, bytes]:
    """All files below a folder with their contents."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}
