# SPDX-License-Identifier: Apache-2.0
"""The library's C passes other tools."""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest

from tests.doubles.toolchain import ROOT

LIBRARY = ROOT / "targets" / "libraries" / "pico_quadrature"
SOURCES = sorted(LIBRARY.rglob("*.c"))


@pytest.mark.skipif(shutil.which("cppcheck") is None, reason="cppcheck is not installed: sudo apt install cppcheck")
def test_cppcheck_finds_nothing() -> None:
    command = ["cppcheck", "--std=c11", "--language=c", "--enable=warning,style,performance,portability"]
    command += ["--error-exitcode=1", "--quiet", "--suppress=missingInclude", "--suppress=unusedStructMember"]
    command += ["-DPICO_RP2350=1", "-DPICO_PIO_USE_GPIO_BASE=1", f"-I{LIBRARY / 'include'}"]
    command += map(str, SOURCES)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_hot_path_is_not_in_flash() -> None:
    """The functions that control loops call are inline or in RAM."""
    header = (LIBRARY / "include" / "epg" / "pico_quadrature.h").read_text()
    for name in ("newest", "take_skipped", "follow", "read", "preset"):
        assert re.search(rf"static inline [\w ]+epg_pico_quadrature_{name}\(", header), name
    source = (LIBRARY / "src" / "pico_quadrature_velocity.c").read_text()
    assert "__not_in_flash_func(epg_pico_quadrature_velocity_read)" in source
