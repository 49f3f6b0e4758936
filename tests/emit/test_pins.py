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


PLATFORM = """api: 1
platform: registers
summary: writes registers
families: [stm32, rp2]
classes: [digital_input, digital_output, pwm, quadrature, uart, periodic_tick]
middlewares: {none: []}
tick: {class: periodic_tick}
builds: true
templates: [NAME_registers.c.j2]
"""
TEMPLATE = """{% for claim in claims %}
{% for signal, pin in claim.pins.items() %}
{{ claim.component|comment }} {{ signal|comment }}: {{ pin.name|comment }} {{ pin.number }} {{ pin.function or 0 }}
{% endfor %}
{% if claim.clock %}
{{ claim.component|comment }}: {{ claim.instance_name|comment }} {{ claim.clock|int }}
{% endif %}
{% endfor %}
tick: {{ tick.instance_name|comment }} {{ tick.clock|int }}
"""
ROBOT = """version: 1
target: {board}_registers
node: robot
control: {{period: 1 ms}}
clocks: {clocks}
components:
  encoder: {{kind: quadrature_encoder, pins: {{a: {a}, b: {b}}}, counts_per_revolution: 4096}}
  motor: {{kind: pwm, pins: {{value: {value}}}}}
  button: {{kind: digital_input, pins: {{value: {button}}}}}
  target: {{kind: constant, value: 1}}
  position: {{kind: digital_output, pins: {{value: {lamp}}}}}
"""
NUCLEO = """encoder a: PD12 60 2
encoder b: PD13 61 2
motor value: PE9 73 1
motor: TIM1 240000000
button value: PE2 66 0
position value: PE3 67 0
tick: TIM6 200000000
"""
PICO = """encoder a: 10 10 0
encoder b: 11 11 0
motor value: 2 2 0
motor: 1 133000000
button value: 3 3 0
position value: 4 4 0
tick: 7 133000000
"""


@pytest.mark.parametrize(
    ("board", "clocks", "pins", "expected"),
    [
        ("nucleo_h743zi", "{apb2_timers: 240 MHz}", ("PD12", "PD13", "PE9", "PE2", "PE3"), NUCLEO),
        ("rpi_pico", "{sys: 133 MHz}", (10, 11, 2, 3, 4), PICO),
    ],
)
def test_templates_get_alternate_functions_and_clocks(
    board: str, clocks: str, pins: tuple[object, ...], expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A platform of a user for two families; the chip RP2040 has no numbers of alternate functions."""
    shutil.copytree(COMMON, tmp_path, dirs_exist_ok=True)
    folder = tmp_path / "targets" / "platforms" / "registers"
    folder.mkdir(parents=True)
    for name, text in {"platform.yaml": PLATFORM, "platform.cmake": "", "NAME_registers.c.j2": TEMPLATE}.items():
        (folder / name).write_text(text, encoding="utf-8")
    wiring = dict(zip(("a", "b", "value", "button", "lamp"), pins))
    (tmp_path / "robot.tcf").write_text(ROBOT.format(board=board, clocks=clocks, **wiring), encoding="utf-8")
    monkeypatch.setenv("EPG_TARGETS_PATH", str(tmp_path / "targets"))
    monkeypatch.chdir(tmp_path)
    assert main(["generate", "robot", *FILES]) == 0
    _, _, text = (tmp_path / "out" / "robot_registers.c").read_text(encoding="utf-8").partition("\n")  # the licence
    assert text == expected
