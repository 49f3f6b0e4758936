# SPDX-License-Identifier: Apache-2.0
"""Builds the robots of ``robots/CMakeLists.txt`` as a user does."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from tests.cmake.built import build, configured
from tests.emulator.toolchain import tool

HERE = Path(__file__).resolve().parent

Build = Callable[[str], Path]
"""``build("follower")``: the host executable of a target."""


def build_robots(folder: Path, flags: str) -> Build:
    """Configures once; a target is built when it is first requested.  Raises Missing."""
    tool("cyclonedds")
    options = [f"-DCMAKE_C_FLAGS={flags}", f"-DCMAKE_CXX_FLAGS={flags}"]
    configured(HERE / "robots", folder, *options)

    def build_one(target: str) -> Path:
        build(folder, f"{target}_host")
        return folder / f"{target}_host"

    return build_one
