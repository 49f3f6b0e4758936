# SPDX-License-Identifier: Apache-2.0
"""Wrong options and setpoint files: the message and the exit status."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from .program import Program, rows


def call(program: Program, *arguments: str) -> tuple[int, str, str]:
    done = subprocess.run([str(program.path), *arguments], capture_output=True, text=True, timeout=60, check=False)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("0.1,motor_setpoint", "this row has 2 fields: it must have the form 'time,topic,value'"),
        ("0.1", "this row has 1 field: it must have the form 'time,topic,value'"),
        ("0.1,motor_setpoint,1,2", "this row has 4 fields: it must have the form 'time,topic,value'"),
        ("soon,motor_setpoint,1", "'soon' is not a time in seconds"),
        ("-0.1,motor_setpoint,1", "'-0.1' is not a time in seconds"),
        ("nan,motor_setpoint,1", "'nan' is not a time in seconds"),
        ("inf,motor_setpoint,1", "'inf' is not a time in seconds"),
        ("1e10,motor_setpoint,1", "'1e10' is not a time in seconds"),
        (",motor_setpoint,1", "'' is not a time in seconds"),
        ("0.1,motor_setpoint,", "'' is not a number"),
        ("0.1,motor_setpoint,fast", "'fast' is not a number"),
        ("0.1,motor_setpoint,1.2.3", "'1.2.3' is not a number"),
        ("0.1,motor_setpoint,0x10", "'0x10' is not a number"),
        ("0.1,motor_setpoint,1e999", "'1e999' is not a number"),
        ("0.1,motor_setpoint,1 2", "'1 2' is not a number"),
        ("0.1,motor_setpoint,infinity", "'infinity' is not a number"),
        ("0.1,$enable,2", "'2' must be 0 or 1"),
        ("0.1,motor_enable,nan", "'nan' must be 0 or 1"),
        ("0.1,$component:emergency_stop,0.5", "'0.5' must be one of 0, 1, open, plant"),
        ("0.1,$component:emergency_stop,off", "'off' must be one of 0, 1, open, plant"),
        ("0.1,$component:emergency_stop,", "'' must be one of 0, 1, open, plant"),
        ("0.1,$stall,-1", "'-1' is not a time in seconds"),
        ("0.1,$stall,inf", "'inf' is not a time in seconds"),
    ],
)
def test_bad_row(motor: Program, tmp_path: Path, row: str, message: str) -> None:
    run = motor.run(tmp_path, 0.2, rows("0.05,motor_setpoint,1", row))
    assert run.status == 2
    assert run.stderr == f"{tmp_path / 'setpoints.csv'}:3: error: {message}\n"
    assert run.stdout == ""


def test_unknown_topic_lists_the_known_ones(motor: Program, tmp_path: Path) -> None:
    run = motor.run(tmp_path, 0.2, rows("0.05,motor_setpiont,1"))
    assert run.status == 2
    assert run.stderr == (
        f"{tmp_path / 'setpoints.csv'}:2: error: unknown topic 'motor_setpiont'\n"
        "hint: the target subscribes to 'motor_setpoint', 'motor_enable', and has '$enable', '$component:<name>' and "
        "'$stall'\n"
    )


def test_an_unknown_digital_input_lists_the_known_ones(motor: Program, tmp_path: Path) -> None:
    run = motor.run(tmp_path, 0.2, rows("0.05,$component:emergency,1"))
    assert run.status == 2
    assert run.stderr == (
        f"{tmp_path / 'setpoints.csv'}:2: error: the target has no digital input 'emergency'\n"
        "hint: its digital inputs: 'emergency_stop'\n"
    )


def test_names_for_programs(motor: Program) -> None:
    status, stdout, stderr = call(motor, "--interface")
    assert (status, stderr) == (0, "")
    lines = stdout.splitlines()
    names = ["topic,motor_setpoint", "topic,motor_enable", "input,emergency_stop"]
    assert lines[: len(names)] == names
    components = [line for line in lines if line.startswith("component,")]
    assert {"component,encoder", "component,emergency_stop"} <= set(components)
    assert lines[len(names) : len(names) + len(components)] == components
    assert lines[len(names) + len(components)] == "signal,inputs.position"


def test_times_must_not_fall(motor: Program, tmp_path: Path) -> None:
    run = motor.run(tmp_path, 0.2, rows("0.1,motor_setpoint,1", "0.1,motor_setpoint,2", "0.09,motor_setpoint,3"))
    assert run.status == 2
    assert run.stderr == f"{tmp_path / 'setpoints.csv'}:4: error: time 0.09 is earlier than in the row above\n"


@pytest.mark.parametrize("text", ["", "0,motor_setpoint,1\n", "time;topic;value\n"])
def test_header_is_required(motor: Program, tmp_path: Path, text: str) -> None:
    run = motor.run(tmp_path, 0.2, text)
    assert run.status == 2
    assert run.stderr == f"{tmp_path / 'setpoints.csv'}:1: error: the first line must be 'time,topic,value'\n"


def test_the_first_wrong_line_is_the_only_message(motor: Program, tmp_path: Path) -> None:
    run = motor.run(tmp_path, 0.2, rows(*(f"{k},motor_setpoint,x" for k in range(100))))
    assert run.status == 2
    assert run.stderr == f"{tmp_path / 'setpoints.csv'}:2: error: 'x' is not a number\n"


def test_a_row_without_end_is_wrong(motor: Program, tmp_path: Path) -> None:
    """Such a row is longer than the reader's buffer."""
    run = motor.run(tmp_path, 0.2, rows(f"0.1,motor_setpoint,{'1' * 3000}"))
    assert run.status == 2
    assert f"{tmp_path / 'setpoints.csv'}:2: error: " in run.stderr


def test_files_of_other_systems_are_read(motor: Program, tmp_path: Path) -> None:
    text = "\ufefftime,topic,value\r\n 0.01 , motor_setpoint , 0.5 \r\n\r\n0.02,motor_setpoint,+7.5e-1"
    assert motor.run_good(tmp_path, 0.03, text).trace["inputs.setpoint"] == [0.25] * 10 + [0.5] * 10 + [0.75] * 10


def test_large_setpoint_file(motor: Program, tmp_path: Path) -> None:
    run = motor.run_good(tmp_path, 1, rows(*(f"{k / 20000},motor_setpoint,{k}e-5" for k in range(20000))))
    assert run.trace["inputs.setpoint"][500] == pytest.approx(0.1)


def test_setpoint_file_that_cannot_be_read(motor: Program, tmp_path: Path) -> None:
    missing = tmp_path / "missing.csv"
    status, _, stderr = call(motor, "--duration", "1", "--setpoints", str(missing))
    assert (status, stderr) == (2, f"{missing}: error: cannot read the setpoint file: No such file or directory\n")
    status, _, stderr = call(motor, "--duration", "1", "--setpoints", str(tmp_path))
    assert (status, stderr) == (2, f"{tmp_path}: error: cannot read the setpoint file: Is a directory\n")


@pytest.mark.parametrize("option", ["--topics", "--trace", "--statistics"])
def test_output_that_cannot_be_written(motor: Program, tmp_path: Path, option: str) -> None:
    path = tmp_path / "missing" / "out"
    status, stdout, stderr = call(motor, "--duration", "1", option, str(path))
    assert (status, stdout) == (1, "")
    assert stderr == f"{path}: error: cannot write this file: No such file or directory\n"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")
@pytest.mark.parametrize("option", ["--topics", "--trace", "--statistics"])
def test_full_disk(motor: Program, option: str) -> None:
    status, _, stderr = call(motor, "--duration", "1", option, "/dev/full")
    assert status == 1
    assert stderr == "/dev/full: error: cannot write this file: No space left on device\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "error: --duration is missing\nhint: give the number of seconds, for example --duration 10\n"),
        (["--duration"], "error: option --duration needs a value\n"),
        (["--duration", ""], "error: option --duration needs a value\n"),
        (["--duration", "long"], "error: --duration 'long' is not a time in seconds above 0\n"),
        (["--duration", "0"], "error: --duration '0' is not a time in seconds above 0\n"),
        (["--duration=-1"], "error: --duration '-1' is not a time in seconds above 0\n"),
        (["--duration=nan"], "error: --duration 'nan' is not a time in seconds above 0\n"),
        (["--quiet=1", "--duration=1"], "error: option --quiet must not have a value\n"),
        (["--duraton", "1"], "error: unknown option '--duraton'\nhint: --help lists the options\n"),
        (["--dur", "1"], "error: unknown option '--dur'\nhint: --help lists the options\n"),
        (["10"], "error: unknown option '10'\nhint: --help lists the options\n"),
    ],
)
def test_wrong_options(motor: Program, arguments: list[str], message: str) -> None:
    assert call(motor, *arguments) == (2, "", message)


def test_help(motor: Program) -> None:
    status, stdout, stderr = call(motor, "--help")
    assert (status, stderr) == (0, "")
    for option in ("--duration", "--realtime", "--setpoints", "--topics", "--trace", "--statistics", "--quiet"):
        assert option in stdout


def test_summary_and_quiet(motor: Program) -> None:
    status, stdout, stderr = call(motor, "--duration=0.25")
    assert (status, stderr) == (0, "")
    assert stdout.startswith("motor: 0.250 s simulated, wall time ")
    assert "  cycles       250, overruns 0, missed 0\n" in stdout
    assert "  state        enabled, faults 0, fault: none\n" in stdout
    assert call(motor, "--duration=0.25", "--quiet") == (0, "", "")
