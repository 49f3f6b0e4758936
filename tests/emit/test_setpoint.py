# SPDX-License-Identifier: Apache-2.0
"""A target's settings of a setpoint reach the table that the runtime reads."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from epg.cli.main import main

COMMON = Path(__file__).resolve().parents[1] / "errors" / "common"
TOPIC = "{kind: ros_subscriber, topic: target"
FILES = ["--tcf", "robot.tcf", "--model", "model", "--bindings", "bindings.yaml"]


@pytest.mark.parametrize(
    ("stated", "timeout_ns", "action"),
    [
        ("", 0, "HOLD"),
        (", timeout: 250 ms", 250_000_000, "HOLD"),
        (", timeout: 1 s, on_timeout: zero", 1_000_000_000, "ZERO"),
        (", timeout: 1 s, on_timeout: disable", 1_000_000_000, "DISABLE"),
    ],
)
def test_the_effect_of_a_setpoint_that_is_too_old(
    stated: str, timeout_ns: int, action: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(COMMON, tmp_path, dirs_exist_ok=True)
    robot = tmp_path / "robot.tcf"
    text = robot.read_text(encoding="utf-8")
    assert TOPIC in text
    robot.write_text(text.replace(TOPIC, TOPIC + stated), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert main(["generate", "robot", *FILES, "--output", "out"]) == 0
    code = "".join(path.read_text(encoding="utf-8") for path in sorted((tmp_path / "out").glob("*.c")))
    assert re.findall(r"\.timeout_ns = (\d+)", code) == [str(timeout_ns)]
    assert re.findall(r"\.action = EPG_TIMEOUT_(\w+)", code) == [action]
