# SPDX-License-Identifier: Apache-2.0
"""The committed words are pioasm's output for the source, and have the documented lengths and cycles."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from tests.doubles.toolchain import ROOT, arm_gcc, pico_sdk, pioasm, skip_if_missing

LIBRARY = ROOT / "targets" / "libraries" / "pico_quadrature"
HEADER = LIBRARY / "include" / "epg" / "pico_quadrature_program.h"


def number(name: str) -> int:
    found = re.search(rf"#define EPG_PICO_QUADRATURE_{name} (\d+)u", HEADER.read_text())
    assert found, name
    return int(found[1])


def words(variant: str) -> list[int]:
    found = re.search(rf"epg_pico_quadrature_{variant}_program\[\w+\] = {{(.*?)}}", HEADER.read_text(), re.DOTALL)
    assert found
    return [int(word, 16) for word in re.findall(r"0x[0-9a-f]{4}", found[1])]


@pytest.fixture(scope="module")
def assembled() -> str:
    skip_if_missing(pico_sdk, pioasm)
    command = [str(pioasm()), "-o", "c-sdk", str(LIBRARY / "src" / "pico_quadrature.pio"), "-"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize("variant", ["count", "velocity"])
def test_header_matches_source(assembled: str, variant: str) -> None:
    name = f"epg_quadrature_{variant}"
    array = re.search(rf"{name}_program_instructions\[\] = {{(.*?)}};", assembled, re.DOTALL)
    assert array
    assert words(variant) == [int(word, 16) for word in re.findall(r"0x[0-9a-f]{4}", array[1])]
    constants = {
        key: int(value)
        for key, value in re.findall(rf"#define {name}_(wrap_target|wrap|offset_sample) (\d+)", assembled)
    }
    upper = variant.upper()
    assert number(f"{upper}_WRAP_TARGET") == constants["wrap_target"]
    assert number(f"{upper}_WRAP") == constants["wrap"]
    assert number(f"{upper}_START") == constants["offset_sample"]
    assert f".pio_version = {name}_pio_version" in assembled
    assert f"#define {name}_pio_version 0" in assembled  # RP2040's instructions, which RP2350 has too


@pytest.mark.parametrize(("variant", "length"), [("count", 28), ("velocity", 32)])
def test_lengths(variant: str, length: int) -> None:
    assert len(words(variant)) == number(f"{variant.upper()}_LENGTH") == length


def paths(variant: str) -> dict[str, int]:
    """Cycles from one IN to the next, by the change of the pins; the words are executed like in a state machine."""
    program = words(variant)
    start, top = number(f"{variant.upper()}_START"), number(f"{variant.upper()}_WRAP")
    kinds = {0: "none", 1: "forward", 2: "backward", 3: "both"}
    result = {}
    for index, kind in kinds.items():
        at, cycles = index, 0
        while at != start:
            word = program[at]
            cycles += 1 + (word >> 8 & 0x1F)
            jump = word >> 13 == 0  # counters are not 0 here, and X-- continues with the next instruction in both cases
            at = word & 0x1F if jump else start if at == top else at + 1
        result[kind] = cycles + 4
    return result


def test_cycles() -> None:
    """As documented in the source.

    The longest path plus one cycle for the synchroniser is the shortest edge distance.
    """
    assert paths("count") == {"none": 7, "forward": 8, "backward": 6, "both": 9}
    assert paths("velocity") == {"none": 9, "forward": 9, "backward": 7, "both": 11}
    for variant in ("count", "velocity"):
        assert number(f"{variant.upper()}_EDGE_CYCLES") == max(paths(variant).values()) + 1
    assert number("VELOCITY_SAMPLE_CYCLES") == paths("velocity")["none"]


@pytest.mark.parametrize("language", ["c11", "c++17"])
def test_program_header_needs_nothing(language: str, tmp_path: Path) -> None:
    """Zephyr's driver also includes it."""
    skip_if_missing(arm_gcc)
    source = tmp_path / ("alone.cpp" if "+" in language else "alone.c")
    source.write_text(
        f'#include "{HEADER}"\n#include "{HEADER}"\n'
        "unsigned used(void);\nunsigned used(void)\n"
        "{ return (unsigned)(epg_pico_quadrature_count_program[0] + epg_pico_quadrature_velocity_program[0]); }\n"
    )
    compiler = str(arm_gcc()).replace("gcc", "g++") if "+" in language else str(arm_gcc())
    options = [f"-std={language}", "-mcpu=cortex-m0plus", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror"]
    subprocess.run([compiler, *options, "-c", str(source), "-o", str(tmp_path / "alone.o")], check=True)
