# SPDX-License-Identifier: Apache-2.0
"""The page about wiring an emergency stop: its wiring gives no warning on any chip, and its table is correct."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from epg.cli.main import main

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "emergency-stop.md").read_text(encoding="utf-8")
WIRING = next(block for block in re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL) if block.startswith("version:"))
PULL = "pull: up, invert: true"
PINS = {"rpi_pico_bare_metal": "14", "rpi_pico2_bare_metal": "14", "nucleo_h743zi_zephyr": "PC13"}


def said(text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> set[str]:
    """The ids of the diagnostics of ``epg check`` for a .tcf."""
    path = folder / "robot.tcf"
    path.write_text(text, encoding="utf-8")
    main(["check", "--tcf", str(path)])
    return set(re.findall(r"\[([a-z-]+)\]$", capsys.readouterr().err, re.MULTILINE))


@pytest.mark.parametrize("target", PINS)
@pytest.mark.parametrize(
    ("pull", "expected"),
    [
        (PULL, set()),
        ("pull: up", {"open-fail-safe"}),
        ("pull: none", {"open-fail-safe"}),
        ("invert: true", {"open-fail-safe"}),
        ("pull: down, invert: true", {"open-fail-safe"}),
        ("pull: down", set()),
    ],
)
def test_pulls_of_the_chips(
    target: str, pull: str, expected: set[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert PULL in WIRING
    text = WIRING.replace("rpi_pico2_bare_metal", target).replace("value: 14", f"value: {PINS[target]}")
    found = said(text.replace(PULL, pull), tmp_path, capsys)
    if "pull: down" in pull and target == "rpi_pico2_bare_metal":
        assert "unsupported-value" in found, "RP2350-E9"
    else:
        assert found == expected
