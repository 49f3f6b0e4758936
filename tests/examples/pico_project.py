# SPDX-License-Identifier: Apache-2.0
"""Pico projects in temporary folders: the tools to build them, configuring and building."""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path

from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.tools.tools import load_tools
from tests.doubles.toolchain import Missing, arm_gcc, pico_sdk, skip_if_missing, tool

ROOT = Path(__file__).resolve().parent.parent.parent


def version_tested_with(name: str) -> str:
    return load_tools(targets_roots(), Diagnostics())[name].tested


def picotool() -> Path:
    return tool("picotool")


def freertos_kernel() -> Path:
    return tool("freertos_kernel")


def sdk_of_new_projects() -> Path:
    """The Pico SDK in the version that new projects use."""
    folder, version = pico_sdk(), version_tested_with("pico_sdk")
    text = (folder / "pico_sdk_version.cmake").read_text(encoding="utf-8")
    if not all(f"{part} {number})" in text for part, number in zip(("MAJOR", "MINOR", "REVISION"), version.split("."))):
        raise Missing(f"the Pico SDK in {folder} is not {version}: see 'epg doctor'")
    return folder


def skip_unless_buildable(*more: object) -> None:
    skip_if_missing(pico_sdk, arm_gcc, picotool, *more)


def environment(**changes: str | None) -> dict[str, str]:
    """This process's environment without variables of EPG or an SDK, and with a fixed date, which images contain."""
    dropped = ("EPG_DIR", "EPG_PATH", "EPG_TARGETS_PATH", "PICO_", "picotool", "FREERTOS_", "CMAKE_", "CC", "CXX")
    kept = {key: value for key, value in os.environ.items() if not key.startswith(dropped)}
    wanted = {"SOURCE_DATE_EPOCH": "1767225600", **changes}
    return {**{k: v for k, v in kept.items() if k not in wanted}, **{k: v for k, v in wanted.items() if v is not None}}


def run(folder: Path, *command: str | Path, check: bool = True, env: dict[str, str] | None = None) -> str:
    """The output of a command, which must succeed, or may fail if not ``check``."""
    done = subprocess.run(
        command, cwd=folder, env=env or environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    assert (done.returncode == 0) == check, done.stdout
    return done.stdout


def configure(
    source: Path, *options: str, build: Path | None = None, check: bool = True, env: dict[str, str] | None = None
) -> str:
    """Configures with EPG's checkout and this Python, Ninja as the generator."""
    where = ("-S", source, "-B", build or source / "build", "-G", "Ninja")
    return run(
        source, "cmake", *where, f"-DEPG_PATH={ROOT}", f"-DPython3_EXECUTABLE={sys.executable}", *options,
        check=check, env=env,
    )  # fmt: skip


def commands(build: Path) -> dict[str, dict[str, str]]:
    """The compile commands, by their object files."""
    entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    return {re.findall(r" -o (\S+)", entry["command"])[0]: entry for entry in entries}


def digests(build: Path, *folders: str) -> dict[str, tuple[str, int]]:
    """Contents and time of change of every file in some folders of a build folder."""
    found = {}
    for folder in folders:
        for path in sorted((build / folder).rglob("*")):
            if path.is_file() and path.suffix in (".obj", ".o", ".elf", ".uf2", ".bin", ".hex", ".dis", ".map"):
                data = hashlib.sha256(path.read_bytes()).hexdigest()
                found[path.relative_to(build).as_posix()] = data, path.stat().st_mtime_ns
    return found
