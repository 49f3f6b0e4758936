# SPDX-License-Identifier: Apache-2.0
"""The tools that emulator tests need besides Python, found where EPG looks for them, or a reason to skip.

>>> # sdk = pico_sdk()            # folder of the Pico SDK
>>> # package = rp2040js()        # folder of the npm package, installed into EPG's cache once
>>> # rom = stand_in_rom()        # ELF of the boot ROM, compiled once per version of its sources
"""

from __future__ import annotations

import hashlib
import importlib
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from epg.generator.bootstrap import cache_folder
from epg.generator.diagnostics import Diagnostics
from epg.generator.tools.find_tool import Surroundings, find_tool
from epg.generator.tools.tools import load_tools

ROOT = Path(__file__).resolve().parents[2]
RP2040 = Path(__file__).resolve().parent / "rp2040"
OLDEST_NODE = 18
UNICORN = "2.1.4"


class Missing(Exception):
    """A tool is not installed; the message is one sentence with the command that installs it."""


def skip_if_missing(*needs: object) -> None:
    """Calls each of ``needs``.  If one raises :class:`Missing`, skips the test with its message."""
    for need in needs:
        try:
            need()  # type: ignore[operator]
        except Missing as problem:
            pytest.skip(str(problem))


def tool(name: str) -> Path:
    """The path of a tool of ``targets/tools``."""
    described = load_tools([ROOT / "targets"], Diagnostics())[name]
    found = find_tool(described, Surroundings.here(cache_folder()))
    if found.status != "found" or found.path is None:
        command = described.get.get("apt") or described.get.get("any", "")
        state = {"old": "is too old", "wrong": "is not where its variable says"}.get(found.status, "is not installed")
        raise Missing(f"{described.title} {state}: {command.replace('{cache}', str(cache_folder()))}")
    return found.path


def pico_sdk() -> Path:
    """The folder of the Pico SDK, with TinyUSB."""
    folder = tool("pico_sdk")
    if not (folder / "lib" / "tinyusb" / "src").is_dir():
        raise Missing(f"the Pico SDK has no TinyUSB: git -C {folder} submodule update --init lib/tinyusb")
    return folder


def arm_gcc() -> Path:
    """The compiler for Arm microcontrollers."""
    return tool("arm_gcc")


def xrce_libraries() -> tuple[Path, Path]:
    """The folders of eProsima's client and of Micro-CDR."""
    return tool("micro_xrce_dds_client"), tool("micro_cdr")


def binutils(program: str, *arguments: str) -> str:
    """The output of a program of the toolchain."""
    path = arm_gcc().parent / f"arm-none-eabi-{program}"
    return subprocess.run([path, *arguments], capture_output=True, text=True, check=True).stdout


def cmake_and_ninja() -> None:
    """Raises :class:`Missing` if one of them is not installed."""
    for program, package in (("cmake", "cmake"), ("ninja", "ninja-build")):
        if not shutil.which(program):
            raise Missing(f"{program} is not installed: sudo apt install {package}")


def node() -> str:
    """The program node."""
    program = shutil.which("node")
    if program is None:
        raise Missing("Node.js with npm is not installed: sudo apt install nodejs npm")
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    if int(version.lstrip("v").split(".")[0]) < OLDEST_NODE:
        raise Missing(f"Node.js {version} is older than {OLDEST_NODE}: install a newer one from https://nodejs.org")
    return program


def rp2040js() -> Path:
    """The folder of the npm package rp2040js."""
    return npm_package(RP2040, "rp2040js")


def npm_package(locked_by: Path, name: str) -> Path:
    """The folder of an npm package that the lock file in ``locked_by`` names.

    All packages of the lock file are installed into EPG's cache once.
    """
    title = json.loads((locked_by / "package.json").read_text(encoding="utf-8"))["name"]
    digest = hashlib.sha256((locked_by / "package-lock.json").read_bytes()).hexdigest()[:12]
    folder = cache_folder() / f"{title}-{digest}"
    package = folder / "node_modules" / name
    with locked(folder):
        if not (package / "package.json").is_file():
            _install_package(locked_by, name, folder)
    return package


def _install_package(locked_by: Path, name: str, folder: Path) -> None:
    npm = shutil.which("npm")
    if npm is None:
        raise Missing("Node.js with npm is not installed: sudo apt install nodejs npm")
    if os.environ.get("EPG_NO_INSTALL"):
        raise Missing(f"{name} is not in EPG's cache and EPG_NO_INSTALL is set: npm ci --prefix {folder}")
    folder.mkdir(parents=True, exist_ok=True)
    for file in ("package.json", "package-lock.json"):
        shutil.copy(locked_by / file, folder / file)
    command = [npm, "ci", "--no-audit", "--no-fund", "--ignore-scripts"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        said = (done.stderr.strip().splitlines() or ["npm has failed"])[-1]
        raise Missing(f"{name} could not be installed ({said}): npm ci --prefix {folder}")


def unicorn() -> Any:
    """The Python module of the CPU emulator Unicorn; installed into EPG's cache once."""
    try:
        return importlib.import_module("unicorn")
    except ImportError:
        pass
    folder = cache_folder() / f"unicorn-{UNICORN}"
    with locked(folder):
        if not (folder / "unicorn").is_dir():
            command = [sys.executable, "-m", "pip", "install", "--target", str(folder), f"unicorn=={UNICORN}"]
            remedy = f"python -m pip install unicorn=={UNICORN}"
            if os.environ.get("EPG_NO_INSTALL"):
                raise Missing(f"unicorn is not installed and EPG_NO_INSTALL is set: {remedy}")
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                shutil.rmtree(folder, ignore_errors=True)
                raise Missing(f"unicorn could not be installed: {remedy}")
    sys.path.append(str(folder))
    importlib.invalidate_caches()
    return importlib.import_module("unicorn")


def pioasm() -> Path:
    """The SDK's assembler for PIO programs, compiled once per SDK."""
    installed = sorted((Path.home() / ".pico-sdk" / "tools").glob("*/pioasm/pioasm"))
    if installed:
        return installed[-1]
    source = pico_sdk() / "tools" / "pioasm"
    digest = hashlib.sha256(str(source).encode()).hexdigest()[:16]
    folder = cache_folder() / "test-build" / f"pioasm-{digest}"
    with locked(folder):
        if not (folder / "pioasm").is_file():
            configure = ["cmake", "-S", str(source), "-B", str(folder), "-G", "Ninja", "-DPIOASM_VERSION_STRING=test"]
            for command in (configure, ["cmake", "--build", str(folder), "--parallel", "2"]):
                done = subprocess.run(command, capture_output=True, text=True, check=False)
                if done.returncode != 0:
                    raise Missing(f"the SDK's pioasm does not compile here: {' '.join(command)}")
    return folder / "pioasm"


def stand_in_rom() -> Path:
    """The ELF file of the boot ROM that EPG provides for the emulator, in place of the chip's own."""
    sources = [RP2040 / "rom" / name for name in ("rom.S", "rom.c", "rom.ld")]
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]
    output = cache_folder() / "test-build" / f"stand-in-rom-{digest}.elf"
    with locked(output):
        if not output.is_file():
            output.parent.mkdir(parents=True, exist_ok=True)
            temporary = output.with_suffix(f".{os.getpid()}")
            options = ["-mcpu=cortex-m0plus", "-mthumb", "-Os", "-std=c11", "-ffreestanding", "-nostdlib"]
            options += ["-fno-tree-loop-distribute-patterns", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
            command = [str(arm_gcc()), *options, "-T", str(sources[2]), str(sources[0]), str(sources[1])]
            subprocess.run([*command, "-o", str(temporary)], check=True)
            temporary.rename(output)
    return output


def stock_rom() -> Path | None:
    """The dump of the real boot ROM that ``EPG_RP2040_BOOTROM`` names; None if it is not set."""
    named = os.environ.get("EPG_RP2040_BOOTROM")
    return Path(named) if named else None


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Holds a lock beside ``path`` against other test processes."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path.parent / f".{path.name}.lock", "w", encoding="utf-8") as file:
        if os.name != "nt":
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX)
        yield
