# SPDX-License-Identifier: Apache-2.0
"""Overlay, Kconfig and needs that EPG generates for Zephyr, tested without Zephyr: golden files, and dtc's grammar.

The golden files of the case ``rpi_pico`` are whole.  Those of the other cases are the overlay, and for each other file
its difference from that of ``rpi_pico``.  ``EPG_UPDATE_GOLDEN=1`` rewrites them: review the difference.
"""

from __future__ import annotations

import difflib
import os
import re
import shutil
import subprocess
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pytest

from epg.generator.diagnostics import Diagnostics
from epg.generator.emit.cmake import PathNames
from epg.generator.emit.outputs import application_outputs
from epg.generator.project import Request, load_application
from epg.generator.source import Span

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent.parent
JIWY = ROOT / "examples/jiwy"
GOLDEN = HERE / "golden"
WHOLE = "rpi_pico"
"""The case whose golden files are all whole."""
NO_TOPICS = ("communication.middleware=none", "communication.transport=null", "communication.console=false")

CASES = {
    "rpi_pico": ("rpi_pico_zephyr_jiwy.tcf", ()),
    "rpi_pico2": ("rpi_pico2_zephyr_jiwy.tcf", ()),
    "nucleo_h743zi": ("nucleo_h743zi_zephyr_jiwy.tcf", ()),
    "mps2_an385": ("jiwy.tcf", ("target=mps2_an385_zephyr", *NO_TOPICS)),
    "native_sim": ("native_sim_jiwy.tcf", ()),
    "uarts": ("uarts.tcf", ()),
    "nodes": ("nodes.tcf", ()),
    "pull_ups": ("pull_ups.tcf", ()),
}
"""Name in ``golden``: the configuration, and the settings that are added to it."""


@cache
def generated(name: str) -> Mapping[str, str]:
    return generate(name)


def generate(name: str) -> dict[str, str]:
    """The files that a case generates for Zephyr, by name."""
    tcf, settings = CASES[name]
    request = Request(
        name="jiwy",
        tcf=tcf,
        model=JIWY / "model",
        bindings=JIWY / "jiwy.bindings.yaml",
        settings=[(setting, Span("test")) for setting in settings],
        beside=HERE,
    )
    problems = Diagnostics()
    app = load_application(request, problems)
    assert app is not None, [problem.message for problem in problems]
    files = application_outputs(app, request.roots, PathNames(ROOT))
    return {file: files[file] for file in ("jiwy.overlay", "jiwy.Kconfig", "jiwy_zephyr.cmake", "jiwy_zephyr.c")}


def expected_files(name: str) -> dict[str, str]:
    """The text that each golden file of a case must have, by its path in ``golden``."""
    texts = dict(generated(name))
    result = {f"{name}/jiwy.overlay": texts.pop("jiwy.overlay")}
    if name == WHOLE:
        return result | {f"{name}/{file}": text for file, text in texts.items()}
    for file, text in texts.items():
        lines, others = text.splitlines(keepends=True), generated(WHOLE)[file].splitlines(keepends=True)
        difference = "".join(difflib.unified_diff(others, lines, f"{WHOLE}/{file}", f"{name}/{file}", n=0))
        result[f"{name}/{file}.diff"] = difference
    return result


@pytest.mark.parametrize("name", CASES)
def test_what_is_generated(name: str) -> None:
    expected = expected_files(name)
    if os.environ.get("EPG_UPDATE_GOLDEN"):
        for file, text in expected.items():
            (GOLDEN / file).parent.mkdir(parents=True, exist_ok=True)
            (GOLDEN / file).write_text(text, encoding="utf-8")
    assert {file: (GOLDEN / file).read_text(encoding="utf-8") for file in expected} == expected


@pytest.mark.parametrize("name", CASES)
def test_it_is_the_same_each_time_and_names_no_folder(name: str) -> None:
    first = generated(name)
    assert generate(name) == first
    assert str(ROOT) not in "".join(first.values())


@pytest.mark.parametrize("name", CASES)
def test_dtc_reads_the_overlay(name: str, tmp_path: Path) -> None:
    """dtc checks the grammar, with a number in place of each macro: the macros are defined by Zephyr."""
    if shutil.which("dtc") is None:
        pytest.skip("overlays are read by dtc: sudo apt install device-tree-compiler")
    text = generated(name)["jiwy.overlay"]
    text = re.sub(r"^#.*\n", "", text, flags=re.MULTILINE)
    text = re.sub(r"\b[A-Z][A-Z0-9_]{3,}\b(?![^\"\n]*\"[^\"]*$)", "1", text)
    source = tmp_path / "overlay.dts"
    source.write_text("/dts-v1/;\n/plugin/;\n" + text, encoding="utf-8")
    command = ["dtc", "-I", "dts", "-O", "dts", "-o", "-", str(source)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert 'compatible = "epg,target"' in done.stdout


def test_nodes_of_the_board_give_way_to_components() -> None:
    """JIWY's motors use the pins of a Pico's I2C, and of a Pico 2's second I2C; the console's UART keeps its node."""
    assert re.findall(r'&(\w+) \{\n\tstatus = "disabled"', generated("rpi_pico")["jiwy.overlay"]) == ["i2c0"]
    assert re.findall(r'&(\w+) \{\n\tstatus = "disabled"', generated("rpi_pico2")["jiwy.overlay"]) == ["i2c0", "i2c1"]
    overlay = generated("pull_ups")["jiwy.overlay"]
    assert "&uart0 {\n\tpinctrl-0 = <&epg_jiwy_no_pins>;\n};" in overlay
    assert 'status = "disabled"' not in overlay.partition("&uart0")[2].partition("}")[0]


def test_slices_and_timers_are_those_that_were_assigned() -> None:
    """In a PWM specifier, the channel is twice the slice, plus 1 for B; on an STM32, channels begin with 1."""
    pico = generated("rpi_pico")["jiwy.overlay"]
    assert "pinmux = <PWM_1A_P2>, <PWM_2A_P4>;" in pico
    assert "pwms = <&pwm 2 50000 PWM_POLARITY_NORMAL>, <&pwm 4 50000 PWM_POLARITY_NORMAL>;" in pico
    nucleo = generated("nucleo_h743zi")["jiwy.overlay"]
    assert "pinctrl-0 = <&tim1_ch1_pe9 &tim1_ch2_pe11>;" in nucleo
    assert "<&epg_jiwy_timers1_pwm 1 50000 PWM_POLARITY_NORMAL>, <&epg_jiwy_timers1_pwm 2 50000" in nucleo
