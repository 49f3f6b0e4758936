# SPDX-License-Identifier: Apache-2.0
"""The READMEs of the Zephyr examples show the same text as the examples' files."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXISTING = ROOT / "examples/existing_zephyr_application"


@pytest.mark.parametrize("file", ["zephyr_jiwy/app", "zephyr_two_boards", "existing_zephyr_application"])
def test_the_import_file_is_epgs(file: str) -> None:
    assert (ROOT / "examples" / file / "epg_import.cmake").read_bytes() == (
        ROOT / "cmake/epg_import.cmake"
    ).read_bytes()


def added(file: str, what: str) -> list[str]:
    """The lines between the marks of an addition to a file."""
    text = (EXISTING / file).read_text(encoding="utf-8")
    return re.findall(rf"^[^\n]*--- {what}, by EPG ---[^\n]*\n(.*?)\n[^\n]*(?:# ---|/\* --- \*/)$", text, re.M | re.S)


def shown() -> list[str]:
    """The additions in the README."""
    readme = (EXISTING / "README.md").read_text(encoding="utf-8")
    return [
        "\n".join(line.removeprefix("+") for line in block.splitlines())
        for block in re.findall(r"```diff\n(.*?)\n```", readme, re.S)
    ]


def test_the_readme_shows_what_was_added() -> None:
    decoder, controller = "the encoder's decoder", "the turntable's controller"
    expected = [*added("boards/rpi_pico.overlay", decoder), *added("prj.conf", decoder)]
    expected += added("CMakeLists.txt", controller)
    assert shown() == expected


def test_one_node_and_two_lines() -> None:
    _, switch, lines = shown()
    assert len(switch.splitlines()) == 1
    assert [line.split("(")[0] for line in lines.splitlines()] == ["include", "epg_add_target"]
