# SPDX-License-Identifier: Apache-2.0
"""``epg plot`` of one run: what shares a panel, units, marks, bounded pictures, SVG that is the same each time."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from epg.cli.main import main
from epg.generator import bootstrap
from epg.runs.panels import panels_of

bootstrap.ensure("plot")
from matplotlib import image  # noqa: E402  # only after the check that it can be imported

SIGNALS = ["inputs.position_pan", "inputs.setpoint_pan", "inputs.position_tilt", "inputs.setpoint_tilt"]
SIGNALS += ["outputs.pwm_pan", "outputs.pan_logging", "plant.outputs.angle_pan", "outputs.encoder_reset_pan"]


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def write(path: Path, names: list[str], count: int = 200, extra: str = "") -> Path:
    head = ",".join(["time", *names]) + ("," + ",".join(extra.split()) if extra else "")
    rows = []
    for at in range(count):
        state = ["1" if 50 <= at < 150 else "0", "6" if at >= 150 else "0"] if extra else []
        values = [f"{math.sin(at / 30 + number):.5f}" for number in range(len(names))]
        rows.append(",".join([f"{at / 1000}", *values, *state]))
    path.write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    return path


def test_a_setpoint_and_its_position_share_a_panel() -> None:
    found = [panel.names for panel in panels_of(SIGNALS, (), {})]
    assert found == [
        ("inputs.setpoint_pan", "inputs.position_pan", "outputs.pan_logging", "plant.outputs.angle_pan"),
        ("inputs.setpoint_tilt", "inputs.position_tilt"),
        ("outputs.pwm_pan",),
        ("outputs.encoder_reset_pan",),
    ]
    assert [panel.title for panel in panels_of(SIGNALS, (), {})][:2] == ["pan", "tilt"]
    # another unit is another quantity
    units = {"inputs.setpoint_pan": "rad", "inputs.position_pan": "rad", "plant.outputs.angle_pan": "deg"}
    assert panels_of(SIGNALS, (), units)[0].names == (*found[0][:2], "outputs.pan_logging")
    # the topics of a recording, whose file tells which of them are setpoints
    topics = panels_of(["pan_command", "pan_state", "tilt_command", "tilt_state"], {"pan_command", "tilt_command"}, {})
    assert [panel.names for panel in topics] == [("pan_command", "pan_state"), ("tilt_command", "tilt_state")]
    assert [panel.names for panel in panels_of(["speed", "setpoint_speed"], (), {})] == [("setpoint_speed", "speed")]
    assert len(panels_of(["setpoint_speed", "position"], (), {})) == 2


def test_units_and_marks(tmp_path: Path) -> None:
    description = """{"components": {}, "subscriptions": [], "publications": [], "plant": null,
    "inputs": [{"port": "position", "unit": "rad", "component": "e", "component_port": "position",
    "component_unit": "rad"}], "outputs": [{"port": "duty", "unit": "", "component": "p", "component_port": "duty",
    "component_unit": ""}]}"""
    (tmp_path / "servo.json").write_text(description, encoding="utf-8")
    run = write(tmp_path / "trace.csv", ["inputs.position", "outputs.duty"], extra="enabled fault")
    options = ["plot", str(run), "--description", "servo.json", "--output", "one.svg"]
    assert main(options) == 0
    svg = (tmp_path / "one.svg").read_bytes()
    texts = re.findall(r"<!-- (.*?) -->", svg.decode())
    for expected in ("inputs.position (rad)", "outputs.duty", "time (s)", "enabled", "fault: stall"):
        assert expected in texts, texts
    assert "lateness" not in texts
    options[-1] = "two.svg"
    assert main(options) == 0
    assert (tmp_path / "two.svg").read_bytes() == svg
    assert b"<dc:date>" not in svg and str(tmp_path).encode() not in svg


def test_thirty_signals_have_a_bounded_picture(tmp_path: Path) -> None:
    write(tmp_path / "many.csv", [f"outputs.value_{number}" for number in range(30)], 20)
    assert main(["plot", "many.csv"]) == 0
    height, width = image.imread(tmp_path / "many.png").shape[:2]
    assert height <= 2700
    assert width <= 3300
