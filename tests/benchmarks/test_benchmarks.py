# SPDX-License-Identifier: Apache-2.0
"""Each benchmark runs, with counts too small for a measurement, and prints its tables."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from tests.connect.browser.conftest import NAMES
from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js, skip_if_missing, tool, unicorn, xrce_libraries
from tests.platforms.firmware.builds import PROCESSORS

ROOT = Path(__file__).resolve().parents[2]
BENCHMARKS = ROOT / "benchmarks"
PAGE = ROOT / "docs" / "benchmarks.md"

SMALLEST = {
    "generator": ["--rounds", "1"],
    "configure": ["--rounds", "1"],
    "scaling": ["--rounds", "1", "--components", "40", "--targets", "2", "--system", "4"],
    "system": ["--rounds", "1", "--targets", "2", "--seconds", "1", "--steps", "100"],
    "runtime": ["--cycles", "200", "--trace", "6000"],
    "pico_timing": ["--seeds", "1", "--milliseconds", "100", "--programs", "1", "--loads", "1"],
    "pico_cycle": ["--cycles", "20"],
    "pico_closed_loop": ["--short", "1"],
    "pico_communication": ["--targets", "1"],
    "firmware_size": [],
    "setpoint_latency": ["--steps", "20", "--platforms", "1"],
    "pico_polls": ["--milliseconds", "30", "--platforms", "1"],
    "network_situations": ["--only", "4", "--seconds", "3", "--systems", "0"],
    "live_stop": ["--count", "3"],
    "ping_pong": ["--pings", "5", "--flat", "20"],
}
PROGRAMS = sorted(
    path.stem
    for path in BENCHMARKS.glob("*.py")
    if '__name__ == "__main__"' in path.read_text(encoding="utf-8")
    and not path.stem.startswith("zephyr")  # test_zephyr.py
)


@cache
def run(program: str) -> str:
    command = [sys.executable, str(BENCHMARKS / f"{program}.py"), *SMALLEST[program]]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600, env=dict(os.environ))
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("program", PROGRAMS)
def test_it_runs_and_prints_what_the_page_shows(program: str) -> None:
    """The programs write the page: it has the same tables in the same order."""
    if program == "runtime" and shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed: sudo apt install valgrind")
    if program == "live_stop":
        pytest.importorskip("playwright", reason="playwright is not installed: pip install playwright")
        if not any(map(shutil.which, NAMES)):
            pytest.skip("Chromium is not installed: sudo apt install chromium")
    if program in ("configure", "scaling", "system", "live_stop") and shutil.which("cmake") is None:
        pytest.skip("CMake is not installed: sudo apt install cmake")
    if program.startswith("pico") or program == "setpoint_latency":
        skip_if_missing(pico_sdk, arm_gcc, node, rp2040js, unicorn, lambda: tool("freertos_kernel"))
    if program == "firmware_size":
        skip_if_missing(lambda: PROCESSORS["m4f"].tool("gcc"), xrce_libraries)
    if program in ("network_situations", "ping_pong"):
        pytest.importorskip("cyclonedds", reason="CycloneDDS for Python is not installed: pip install cyclonedds")
        skip_if_missing(lambda: tool("cyclonedds"))
    if program == "setpoint_latency":
        skip_if_missing(xrce_libraries)
    printed = run(program)
    titles = re.findall(r"^(.+)\n-+$", printed, flags=re.MULTILINE)
    section = re.search(rf"<!-- begin {program} -->(.*?)<!-- end {program} -->", PAGE.read_text(encoding="utf-8"), re.S)
    assert section is not None, f"docs/benchmarks.md has no section for {program}"
    assert titles == re.findall(r"^### (.+)$", section[1], flags=re.MULTILINE)
    assert f"python benchmarks/{program}.py" in section[1]


@pytest.mark.skipif(shutil.which("valgrind") is None, reason="valgrind is not installed: sudo apt install valgrind")
def test_generated_code_costs_little_more_than_code_written_by_hand() -> None:
    """Counts instructions instead of time: the result does not depend on the load of the machine."""
    found = re.search(r"everything else +[\d.]+ +[\d.]+ +([\d.]+) x", run("runtime"))
    assert found is not None
    assert float(found[1]) <= 1.1


def test_a_debug_build_needs_little_more_flash_than_a_release_build() -> None:
    skip_if_missing(lambda: PROCESSORS["m4f"].tool("gcc"), xrce_libraries)
    rows = re.findall(
        r"^(none|console|xrce and console) +([\d,]+) +([\d,]+) +([\d,]+) ", run("firmware_size"), re.MULTILINE
    )
    assert len(rows) == 3
    for name, release, debug, not_optimised in rows:
        of_release, of_debug, of_both = (int(size.replace(",", "")) for size in (release, debug, not_optimised))
        assert of_debug <= 1.05 * of_release, name
        assert of_both > 1.4 * of_release, name


def test_the_two_programs_are_compared_through_faults() -> None:
    """A difference would end the program; the compared run must contain enough events."""
    if shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed: sudo apt install valgrind")
    found = re.search(r"have ([\d,]+) cycles; in ([\d,]+) of these, the target was disabled", run("runtime"))
    assert found is not None
    assert int(found[1].replace(",", "")) == 6000
    assert int(found[2].replace(",", "")) > 100
