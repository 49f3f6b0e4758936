# SPDX-License-Identifier: Apache-2.0
"""Builds Pico SDK projects for tests, in folders of EPG's cache that are kept: a second build takes half a second.

>>> # build("tests/doubles/rp2040/programs", board="pico", targets=["serial"]) / "serial.elf"
"""

from __future__ import annotations

import hashlib
import os
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from epg.generator.bootstrap import cache_folder
from tests.doubles.toolchain import ROOT, Missing, arm_gcc, locked, pico_sdk, tool

HERE = Path(__file__).resolve().parent


class BuildError(Exception):
    """CMake or the compiler failed; the message is their output."""


def build(
    project: str | Path,
    *,
    board: str = "pico",
    targets: Sequence[str] = (),
    variables: Mapping[str, str] | None = None,
    environment: Mapping[str, str] | None = None,
    stock_arithmetic: bool = False,
) -> Path:
    """Configures and builds ``targets`` (all targets, if empty) and returns the build folder.

    ``project`` is relative to the repository.  RP2040 images use the compiler's float and double arithmetic unless
    ``stock_arithmetic``.  Raises :class:`BuildError`, or :class:`Missing` if the SDK or the compiler is missing.
    """
    source = (ROOT / project).resolve()
    settings = {"PICO_BOARD": board, "PICO_SDK_PATH": str(pico_sdk()), "CMAKE_BUILD_TYPE": "Release"}
    settings.update(variables or {})
    settings.setdefault("EPG_PATH", str(ROOT))
    settings["PICO_COMPILER"] = "pico_arm_cortex_m33_gcc" if board.startswith("pico2") else "pico_arm_cortex_m0plus_gcc"
    settings["PICO_TOOLCHAIN_PATH"] = str(arm_gcc().parent)
    try:
        settings["picotool_DIR"] = str(tool("picotool"))
    except Missing:
        settings["PICO_NO_PICOTOOL"] = "1"
    if not board.startswith("pico2") and not stock_arithmetic:
        settings["CMAKE_PROJECT_INCLUDE"] = str(HERE / "compiler_arithmetic.cmake")
    digest = hashlib.sha256(repr((str(source), sorted(settings.items()))).encode()).hexdigest()[:16]
    folder = cache_folder() / "test-build" / f"{source.name}-{board}-{digest}"
    with locked(folder):
        if not (folder / "build.ninja").is_file():
            command = ["cmake", "-S", str(source), "-B", str(folder), "-G", "Ninja"]
            _run([*command, *(f"-D{name}={value}" for name, value in settings.items())], environment)
        command = ["cmake", "--build", str(folder), "--parallel", "2"]
        _run([*command, *(["--target", *targets] if targets else [])], environment)
    return folder


def _run(command: Sequence[str], environment: Mapping[str, str] | None) -> None:
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env={**os.environ, **(environment or {})}
    )
    if done.returncode != 0:
        raise BuildError(f"{' '.join(command)}\n{done.stdout}\n{done.stderr}")
