# SPDX-License-Identifier: Apache-2.0
"""Builds the robots of ``robots/CMakeLists.txt`` as a user does."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from tests.cmake.built import build, configured
from tests.doubles.toolchain import Missing, skip_if_missing, tool, xrce_libraries

HERE = Path(__file__).resolve().parent

Build = Callable[[str], Path]
"""``build("follower")``: the host executable of a target."""


def build_robots(folder: Path, flags: str) -> Build:
    """Configures once; a target is built when it is first requested.  Raises Missing.

    A test that requests a target with an agent is skipped where the client for agents is missing.
    """
    tool("cyclonedds")
    with_agent = _is_there("micro_xrce_dds_client") and _is_there("micro_cdr")
    options = [f"-DCMAKE_C_FLAGS={flags}", f"-DCMAKE_CXX_FLAGS={flags}", f"-DWITH_AGENT={with_agent}"]
    configured(HERE / "robots", folder, *options)

    def build_one(target: str) -> Path:
        if target.startswith("agent_"):
            skip_if_missing(xrce_libraries)
        build(folder, f"{target}_host")
        return folder / f"{target}_host"

    return build_one


def _is_there(name: str) -> bool:
    try:
        tool(name)
    except Missing:
        return False
    return True
