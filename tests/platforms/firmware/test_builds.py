# SPDX-License-Identifier: Apache-2.0
"""JIWY as a library in a program for any chip: it compiles with strict warnings, and needs little from outside."""

from __future__ import annotations

import re
import subprocess
from functools import partial

import pytest

from tests.doubles.toolchain import skip_if_missing, tool

from .builds import HERE, PROCESSORS, build, needed

XRCE = (partial(tool, "micro_xrce_dds_client"), partial(tool, "micro_cdr"))

HELPERS = re.compile(r"__aeabi_[a-z0-9]+|__[a-z]+[ds][if]([ds][if])?[23]?")
"""The compiler's own arithmetic: libgcc's functions for integers of 64 bits and for floating point."""

NONE = {"memcpy", "memset", "strlen"}
CONSOLE = NONE | {"memchr", "memcmp", "memmove", "strchr", "strcmp", "strcspn", "strncmp", "strspn", "strstr"}
STRINGS = {"none": NONE, "console": CONSOLE, "xrce": CONSOLE | {"strrchr"}}
"""The functions of <string.h> that a target with this middleware needs.  None of them allocates or keeps anything."""


@pytest.mark.parametrize("name", [name for name in PROCESSORS if name != "m3"])
def test_it_builds_and_needs_little(name: str) -> None:
    """Any other symbol would be a part of the C library or of an operating system: malloc, printf, __atomic_load_8."""
    processor = PROCESSORS[name]
    skip_if_missing(lambda: processor.tool("gcc"), *XRCE)
    folder = build(processor, HERE / "builds")
    for middleware, strings in STRINGS.items():
        symbols = needed(processor, folder, f"jiwy_{middleware}_program")
        outside = {symbol for symbol in symbols if not HELPERS.fullmatch(symbol)}
        assert "memcpy" in outside and outside <= strings, middleware  # compilers put short copies in place


def test_the_stubs_run_on_this_computer() -> None:
    """The empty drivers are good enough to start, to run cycles, and to stop.  Their clock stands still."""
    skip_if_missing(lambda: PROCESSORS["host"].tool("gcc"), *XRCE)
    folder = build(PROCESSORS["host"], HERE / "builds")
    for middleware in STRINGS:
        assert subprocess.run([folder / f"jiwy_{middleware}_program"], timeout=60, check=False).returncode == 0
