# SPDX-License-Identifier: Apache-2.0
"""A kind's file says which pins are outputs, which the firmware makes safe."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from epg.cli.main import main

COMMON = Path(__file__).resolve().parents[1] / "errors" / "common"
FILES = ["--tcf", "robot.tcf", "--model", "model", "--bindings", "bindings.yaml", "--output", "out"]
KIND = """api: 1
kind: lamp
summary: a lamp
pins: [value]
ports:
  level: {{direction: source, type: real, default: true}}
claims:
  level: {{class: {resource_class}, output: {output}, signals: {{value: value}}}}
"""


@pytest.mark.parametrize(
    ("resource_class", "output", "safe"),
    [("digital_output", "true", True), ("digital_output", "false", False), ("digital_input", "true", True)],
)
def test_pins_of_outputs_are_made_safe(
    resource_class: str, output: str, safe: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(COMMON, tmp_path, dirs_exist_ok=True)
    folder = tmp_path / "targets" / "components" / "lamp"
    folder.mkdir(parents=True)
    (folder / "code.c.j2").write_text("", encoding="utf-8")
    (folder / "component.yaml").write_text(KIND.format(resource_class=resource_class, output=output))
    with (tmp_path / "robot.tcf").open("a", encoding="utf-8") as robot:
        robot.write("  lamp: {kind: lamp, pins: {value: 22}}\n")
    monkeypatch.setenv("EPG_TARGETS_PATH", str(tmp_path / "targets"))
    monkeypatch.chdir(tmp_path)
    assert main(["generate", "robot", *FILES]) == 0
    code = (tmp_path / "out" / "robot_pico.c").read_text(encoding="utf-8")
    outputs = re.findall(r"\.pin = (\d+)", code)
    assert outputs[:3] == ["2", "7", "8"]  # of the motor
    assert ("22" in outputs) is safe
