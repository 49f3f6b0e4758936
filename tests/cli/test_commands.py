# SPDX-License-Identifier: Apache-2.0
"""The subcommands, called as a user calls them."""

from __future__ import annotations

import errno
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from epg.cli.main import COMMANDS, main
from epg.generator import install

ROOT = Path(__file__).resolve().parent.parent.parent
JIWY = ROOT / "examples" / "jiwy"
MODEL = ["--model", str(JIWY / "model"), "--bindings", str(JIWY / "jiwy.bindings.yaml")]
FILES = ["--tcf", "rpi_pico2_freertos_jiwy", *MODEL]
ROBOT = ["--tcf", "robot.tcf", "--model", "model", "--bindings", "bindings.yaml"]
HOST = ["--tcf", "host.tcf", *ROBOT[2:]]


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The files for tests of messages, in the current folder."""
    shutil.copytree(ROOT / "tests/errors/common", tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_without_a_command_help_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 2
    assert "explain" in capsys.readouterr().out


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, "--help"]) == 0
    assert "usage: epg" in capsys.readouterr().out


def test_a_wrong_command_line_is_status_2(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["chekc"]) == 2
    assert main(["generate"]) == 2
    assert main(["check"]) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_a_bug_is_status_3_and_says_so(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    import epg.cli.targets

    def fail(*_: object) -> int:
        raise KeyError("a bug")

    monkeypatch.setattr(epg.cli.targets, "run", fail)
    assert main(["targets"]) == 3
    assert "this is a bug in EPG" in capsys.readouterr().err


def test_a_package_that_cannot_be_loaded_is_not_a_bug(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: object) -> None:
        raise ImportError("DLL load failed while importing rpds", name="rpds.rpds")

    monkeypatch.setattr("epg.cli.targets.run", fail)
    assert main(["targets"]) == 4
    assert capsys.readouterr().err.startswith("epg: the Python package 'rpds' cannot be used: DLL load failed")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "module 'yaml' has no attribute 'SafeLoader'"),
        ("raise ImportError('its DLL is missing')", "its DLL is missing"),
        ("import ctypes\nctypes.CDLL('libnone.so')", "libnone.so: cannot open shared object file"),
    ],
)
def test_a_package_from_pythonpath_is_blamed(robot: Path, tmp_path: Path, text: str, said: str) -> None:
    package = tmp_path / "shell" / "yaml"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text(text + "\n")
    command = [sys.executable, str(ROOT / "epg"), "check", "--tcf", "robot.tcf", "--model", "model"]
    command += ["--bindings", "bindings.yaml"]
    # The tests' own packages stay on the path: a Python without EPG's packages would take them from EPG's cache first.
    path = os.pathsep.join([str(package.parent), *(entry for entry in sys.path if entry)])
    environment = {**os.environ, "PYTHONPATH": path}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=robot, check=False)
    assert done.returncode == 4
    problem, hint = done.stderr.splitlines()
    assert problem.startswith(f"epg: the Python package 'yaml' cannot be used: {said}")
    assert hint.startswith("hint: the variable PYTHONPATH has put it in the place of another one: unset PYTHONPATH (")


def test_a_folder_that_cannot_be_written_is_status_4(
    robot: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (robot / "host.tcf").write_text((robot / "robot.tcf").read_text().replace("rpi_pico_bare_metal", "host"))
    (robot / "out").write_text("a file where the folder should be")
    assert main(["generate", "robot", *HOST, "--output", "out"]) == 4
    assert capsys.readouterr().err == f"epg: out: {os.strerror(errno.EEXIST)}\n"
    monkeypatch.setattr(install, "system", lambda: "windows")
    assert main(["generate", "robot", *HOST, "--output", "out/" + "/".join(["deep"] * 60)]) == 4
    assert "\nhint: Windows opens paths of up to 259 characters, and this one has " in capsys.readouterr().err


@pytest.mark.parametrize("name", ["cmake", "examples"])
def test_the_folder_of_data(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([f"--{name}-dir"]) == 0
    assert capsys.readouterr().out == f"{(ROOT / name).as_posix()}\n"


def test_check_alone_and_together(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "robot.tcf"]) == 0
    assert main(["check", *ROBOT]) == 0
    assert main(["check", *FILES]) == 0
    assert capsys.readouterr().out == "no errors\n" * 3


def test_check_says_what_was_not_checked(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Files that are given without the other files of their target are also checked, each by itself."""
    by_itself = "no errors in each file separately; to check them together, add "
    assert main(["check", "--plant", "model"]) == 0
    assert capsys.readouterr().out == f"{by_itself}--tcf, --model, --bindings, --plant-bindings\n"
    assert main(["check", "--tcf", "robot.tcf", "--model", "model"]) == 0
    assert capsys.readouterr().out == f"{by_itself}--bindings\n"
    assert main(["check", *FILES, "--plant", "model"]) == 0
    assert capsys.readouterr().out == f"{by_itself}--plant-bindings\n"
    for option in ("--plant", "--plant-bindings"):
        assert main(["check", "--tcf", "robot.tcf", option, "nothing"]) == 1
        assert "nothing" in capsys.readouterr().err


def test_all_predefined_configurations_are_right(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["targets", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    clocks = {target["name"]: target["clocks"] for target in data["targets"]}
    assert clocks["rpi_pico2_zephyr"] == {"sys": 150e6, "peri": 150e6}
    assert clocks["firmware"] == {"timers": None}, "only the user's program knows it"
    names = data["tcf"]
    complete = [
        name for name in names if name.startswith(("host_", "rpi_pico2_f", "rpi_pico2_b", "rpi_pico_f", "rpi_pico_b"))
    ]
    assert len(complete) >= 7
    assert main(["check", *complete]) == 0


def test_check_as_json(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "robot.tcf", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"diagnostics": []}
    (robot / "robot.tcf").write_text("version: 1\n")
    assert main(["check", "robot.tcf", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)["diagnostics"]
    assert {d["id"] for d in found} == {"missing-key"}
    assert found[0]["file"] == "robot.tcf"


def test_ports(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["ports", "model"]) == 0
    assert "input   setpoint  rad   real" in capsys.readouterr().out
    assert main(["ports", str(JIWY / "model"), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["name"] == "JIWY_Control"
    assert data["step"] == 0.001
    assert [port["name"] for port in data["inputs"]] == [
        "position_pan",
        "position_tilt",
        "setpoint_pan",
        "setpoint_tilt",
    ]
    assert {"name": "Pan\\PID\\kp", "value": 2.6, "unit": ""} in data["parameters"]


def test_targets(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["targets"]) == 0
    text = capsys.readouterr().out
    assert "rpi_pico2_freertos " in text
    assert "host_jiwy.tcf" in text
    assert main(["targets", "--kinds"]) == 0
    assert "position (source, rad), reset (sink)" in capsys.readouterr().out


def test_explain_shows_the_whole_way(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", "position_pan", "--name", "jiwy", *FILES]) == 0
    text = capsys.readouterr().out
    assert text.startswith("jiwy (rpi_pico2_freertos)\n")
    for words in (
        "position_pan [rad], real",
        "JIWY_Control: u[0]",
        "jiwy_inputs.position_pan",
        "encoder_pan.position [rad]",
        "quadrature_encoder, EPG:robots/jiwy/rpi_pico_jiwy.tcf:",
        "PIO block 0, state machine 0",
        "GPIO 10",
        "GPIO 11",
        "jiwy_encoder_pan",
    ):
        assert words in text


def test_explain_names_the_pins_as_the_chip_does(capsys: pytest.CaptureFixture[str]) -> None:
    files = ["nucleo_h743zi_zephyr_jiwy.tcf", *MODEL]
    assert main(["explain", "position_pan", "--name", "jiwy", "--tcf", *files]) == 0
    text = capsys.readouterr().out
    rows = [line.split() for line in text.splitlines() if line.split()[0] == "pin"]
    assert rows == [["pin", "PD12", "a"], ["pin", "PD13", "b"]]
    assert "GPIO" not in text
    assert main(["check", "--hardware", files[0]]) == 0
    assert "a PD12, b PD13" in capsys.readouterr().out


def test_explain_tells_the_frequency_that_is_reached(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (robot / "robot.tcf").read_text()
    assert text.count("frequency: 20 kHz") == 1
    assert main(["explain", "motor", *ROBOT]) == 0
    assert "frequency     20 kHz                  pwm: 6250 steps\n" in capsys.readouterr().out + "\n"
    (robot / "robot.tcf").write_text(text.replace("20 kHz", "1.5 MHz"))
    assert main(["explain", "motor", *ROBOT]) == 0
    shown = capsys.readouterr().out
    assert "1.50602 MHz" in shown  # 125 MHz / 83
    assert "pwm: 83 steps; 1.5 MHz requested, +0.4 %" in shown
    for pin in ("GPIO 2                  value", "GPIO 7                  direction_a", "direction_b"):
        assert pin in shown
    assert main(["explain", "motor", "--json", *ROBOT]) == 0
    divider = json.loads(capsys.readouterr().out)[0]["resources"]["dividers"]["pwm"]
    assert divider["reached"] == 125e6 / 83
    assert divider["error"] == pytest.approx(125 / 83 / 1.5 - 1)


def test_check_lists_the_hardware(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--hardware", "rpi_pico2_freertos_jiwy.tcf"]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert "encoder_pan.encoder PIO block 0, state machine 0 a 10, b 11".split() in lines
    assert "pwm_pan.pwm PWM slice 1, channel A value 2 20 kHz 7500 steps".split() in lines
    assert "(control loop) PWM slice 8 1 kHz exactly".split() in lines
    assert ["no", "errors"] in lines
    assert main(["check", "--hardware", "--json", *FILES]) == 0
    (hardware,) = json.loads(capsys.readouterr().out)["hardware"].values()
    loop = next(entry for entry in hardware if entry["component"] is None)
    assert loop["divider"] == {"asked": 1000.0, "reached": 1000.0, "error": 0.0, "steps": 50000}


def test_the_start_of_outputs_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    files = ["nucleo_h743zi_bare_metal_jiwy.tcf", *MODEL]
    assert main(["check", "--hardware", files[0]]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert "pwm_pan.pwm timer TIM1, channel CH1 value PE9 20 kHz 10000 steps; started by TIM15".split() in lines
    assert main(["explain", "pwm_pan", "--name", "jiwy", "--tcf", *files]) == 0
    (row,) = {line for line in capsys.readouterr().out.splitlines() if line.split()[0] == "start"}
    assert row.split() == "start started by TIM15 pwm: with the timer of the control loop".split()
    assert main(["explain", "pwm_pan", "--name", "jiwy", "--json", "--tcf", *files]) == 0
    assert json.loads(capsys.readouterr().out)[0]["resources"]["starts"] == {"pwm": "started by TIM15"}


def test_explain_a_component_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", "encoder_pan", "--json", *FILES]) == 0
    wires = json.loads(capsys.readouterr().out)
    assert [(wire["port"], wire["direction"]) for wire in wires] == [
        ("position_pan", "input"),
        ("encoder_reset_pan", "output"),
    ]
    assert wires[0]["resources"]["pins"] == {"a": 10, "b": 11}


def test_explain_shows_conversions(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (robot / "bindings.yaml").read_text()
    (robot / "bindings.yaml").write_text(
        text.replace("angle: encoder", "angle: {from: encoder, unit: deg, limits: [-90, 90]}")
    )
    assert main(["explain", "angle", *ROBOT]) == 0
    shown = capsys.readouterr().out
    assert "value * 57.29577951308232" in shown
    assert "rad -> deg" in shown
    assert "limited to [-90.0, 90.0]" in shown


def test_explain_reads_a_build_folder(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", "angle", "--build", "."]) == 1
    assert "there is no generated target here" in capsys.readouterr().err
    (robot / "host.tcf").write_text((robot / "robot.tcf").read_text().replace("rpi_pico_bare_metal", "host"))
    assert main(["generate", "robot", *HOST, "--output", "build/epg/robot"]) == 0
    assert main(["explain", "angle"]) == 0
    assert "robot (host)" in capsys.readouterr().out
    assert main(["explain", "angel"]) == 1
    assert "did you mean 'angle'?" in capsys.readouterr().err


def test_generate_says_what_it_wrote(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (robot / "host.tcf").write_text((robot / "robot.tcf").read_text().replace("rpi_pico_bare_metal", "host"))
    arguments = ["generate", "robot", *HOST, "--output", "out", "--json"]
    assert main(arguments) == 0
    first = json.loads(capsys.readouterr().out)
    assert set(first["written"]) == set(first["files"]) >= {"robot.h", "robot_app.c", "robot.cmake", "robot.json"}
    assert main(arguments) == 0
    assert json.loads(capsys.readouterr().out)["written"] == []


def test_bind_writes_what_matches_and_comments_the_rest(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bind", "model", "robot.tcf"]) == 0
    text = capsys.readouterr().out
    assert text == (
        "version: 1\n"
        "model: Controller\n"
        "# inputs:    # remove this '#' with the first below it\n"
        "  # angle:    # no name matches; possible: encoder, target, button\n"
        "  # go:    # no name matches; possible: button\n"
        "  # setpoint:    # no name matches; possible: target, encoder, button\n"
        "outputs:\n"
        "  duty: motor\n"
        "  # log:    # no name matches; possible: position, encoder.reset\n"
        "  reset: encoder.reset\n"
    )
    assert main(["bind", str(JIWY / "model"), "host_jiwy"]) == 0
    assert "  encoder_reset_pan: encoder_pan.reset\n" in capsys.readouterr().out


def test_bind_does_not_overwrite(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = (robot / "bindings.yaml").read_text()
    assert main(["bind", "model", "robot.tcf", "-o", "bindings.yaml"]) == 1
    assert "--update" in capsys.readouterr().err
    assert (robot / "bindings.yaml").read_text() == before


UPDATES = {
    "block": (
        """\
version: 1
model: Controller   # mine
inputs:
  # the load
  angle: encoder   # rad
  old:
    from: button
    scale: 2
  setpoint: target
outputs:
  log: position
  gone: motor
""",
        """\
version: 1
model: Controller   # mine
inputs:
  # the load
  angle: encoder   # rad
  # go:    # no name matches; possible: button
  # old:   # no longer a port of the model
  #   from: button
  #   scale: 2
  setpoint: target
outputs:
  duty: motor
  log: position
  reset: encoder.reset
  # gone: motor   # no longer a port of the model
""",
    ),
    "flow": (
        """\
version: 1
model: Controller
inputs: {angle: encoder, go: button, setpoint: target}
outputs: {log: [position], gone: {to: motor, scale: 2}}
# the end
""",
        """\
version: 1
model: Controller
inputs: {angle: encoder, go: button, setpoint: target}
outputs: {duty: motor, log: [position], reset: encoder.reset}
  # gone: {to: motor, scale: 2}   # no longer a port of the model
# the end
""",
    ),
    "sections without ports": (
        """\
version: 1
model: Controller
# outputs:    # remove this '#' with the first below it
    # duty:    # no name matches; possible: encoder.reset
    # log:    # no name matches; possible: encoder.reset
inputs:
    gone: motor
parameters: {}""",
        """\
version: 1
model: Controller
outputs:
    duty: motor
    # log:    # no name matches; possible: encoder.reset
    reset: encoder.reset
inputs: {}
    # gone: motor   # no longer a port of the model
    # angle:    # no name matches; possible: encoder, target, button
    # go:    # no name matches; possible: button
    # setpoint:    # no name matches; possible: target, encoder, button
parameters: {}""",
    ),
    "a section that is missing": (
        """\
version: 1
model: Controller
outputs: {log: position, gone: motor}
""",
        """\
version: 1
model: Controller
# inputs:    # remove this '#' with the first below it
  # angle:    # no name matches; possible: encoder, target, button
  # go:    # no name matches; possible: button
  # setpoint:    # no name matches; possible: target, encoder, button
outputs: {duty: motor, log: position, reset: encoder.reset}
  # gone: motor   # no longer a port of the model
""",
    ),
}


@pytest.mark.parametrize("style", UPDATES)
def test_bind_update_keeps_everything_else(robot: Path, style: str, capsys: pytest.CaptureFixture[str]) -> None:
    before, after = UPDATES[style]
    (robot / "bindings.yaml").write_text(before)
    arguments = ["bind", "model", "robot.tcf", "-o", "bindings.yaml", "--update"]
    assert main(arguments) == 0
    assert (robot / "bindings.yaml").read_text() == after
    text = capsys.readouterr().out
    assert "added:   duty\nadded:   reset\n" in text
    assert "removed: gone\n" in text
    assert main(arguments) == 0
    assert (robot / "bindings.yaml").read_text() == after, "a second update changes nothing"


def test_bind_update_does_not_touch_a_file_with_a_mistake(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = "version: 1\nmodel: Controller\ninputs: [angle]\n"
    (robot / "bindings.yaml").write_text(text)
    assert main(["bind", "model", "robot.tcf", "-o", "bindings.yaml", "--update"]) == 1
    assert "bindings.yaml:3:9: error: expected a map" in capsys.readouterr().err
    assert (robot / "bindings.yaml").read_text() == text


def test_bind_update_leaves_a_file_it_cannot_edit(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = "version: 1\nmodel: Controller\noutputs:\n  ? log\n  : position\n"
    (robot / "bindings.yaml").write_text(text)
    assert main(["bind", "model", "robot.tcf", "-o", "bindings.yaml", "--update"]) == 1
    assert capsys.readouterr().err.startswith("epg bind: bindings.yaml was not changed: ")
    assert (robot / "bindings.yaml").read_text() == text


def test_bind_update_on_a_complete_file(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = (robot / "bindings.yaml").read_bytes()
    assert main(["bind", "model", "robot.tcf", "-o", "bindings.yaml", "--update"]) == 0
    assert capsys.readouterr().out == "all ports of the model are bound\n"
    assert (robot / "bindings.yaml").read_bytes() == before


def test_null_deletes_any_key_of_an_extended_file(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (robot / "robot.tcf").read_text().replace("node: robot", "node: robot\nnamespace: /a")
    (robot / "robot.tcf").write_text(text)
    (robot / "mine.tcf").write_text(
        "version: 1\nextends: robot.tcf\nnamespace: null\ncontrol: {period: null}\n"
        "components: {button: null, motor: {frequency: null}}\n"
    )
    assert main(["check", "mine.tcf"]) == 0, capsys.readouterr().err
    (robot / "mine.tcf").write_text("version: 1\nextends: robot.tcf\nnode: null\n")
    assert main(["check", "mine.tcf"]) == 1
    assert "'node' is missing" in capsys.readouterr().err
    (robot / "mine.tcf").write_text("version: 1\nextends: robot.tcf\nnamspace: null\n")
    assert main(["check", "mine.tcf"]) == 1
    assert "unknown key 'namspace'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("build", "cmake -S . -B build, then cmake --build build"),
        ("init", "'epg new' writes a project"),
        ("genrate", "did you mean 'generate'?"),
    ],
)
def test_a_word_that_is_not_a_command_names_what_to_do(
    command: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([command, "robot"]) == 2
    assert f"epg: error: there is no command '{command}' (" in (text := capsys.readouterr().err)
    assert said in text


def test_a_misspelt_option_gets_the_usage_of_its_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--modell", "servo"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("usage: epg check ")
    assert "epg check: error: unrecognized arguments: --modell (did you mean '--model'?)" in said


@pytest.mark.parametrize("id", ["unbound-input", "[unbound-input]"])
def test_explain_explains_a_message_without_a_build(
    id: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["explain", id]) == 0
    remedy = "Bind it to a component; the kind `constant` gives a fixed value."
    assert " ".join(capsys.readouterr().out.split()) == f"An input of the model is not bound. {remedy}"
    assert main(["explain", "--json", id]) == 0
    assert json.loads(capsys.readouterr().out)["id"] == "unbound-input"
    assert main(["explain", "timer-used-twice"]) == 0
    assert "](" not in capsys.readouterr().out
