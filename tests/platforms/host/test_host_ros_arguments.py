# SPDX-License-Identifier: Apache-2.0
"""The arguments after ``--ros-args``: names, parameters, log level, and the messages about wrong ones.

The messages are those of the program; the meaning of names and rules is that of rcl.
"""

from __future__ import annotations

import signal
import subprocess
from pathlib import Path

import pytest

from .program import PROGRAMS, Program, compile_program, platform_sources

# Names -----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="session")
def renamed(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """A program that prints the names of a node ``/robot_host/arm_node`` and of its topics."""
    folder: Path = tmp_path_factory.mktemp("renamed")
    sources = [PROGRAMS / "renamed.c", *platform_sources(main=False)]
    return Program(compile_program(folder / "renamed", sources))


def names(program: Program, folder: Path, *arguments: str) -> list[str]:
    command = [str(program.path), "--ros-args", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, cwd=folder)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    return done.stdout.split()


@pytest.mark.parametrize(
    ("arguments", "node", "pan", "enable", "diagnostics"),
    [
        ("", "/robot_host/arm_node", "/robot_host/pan", "/robot_host/arm_node/enable", "/diagnostics"),
        ("-r __node:=left", "/robot_host/left", "/robot_host/pan", "/robot_host/left/enable", "/diagnostics"),
        ("--remap __name:=left", "/robot_host/left", "/robot_host/pan", "/robot_host/left/enable", "/diagnostics"),
        ("-r __ns:=/a/b", "/a/b/arm_node", "/a/b/pan", "/a/b/arm_node/enable", "/diagnostics"),
        ("-r __ns:=/", "/arm_node", "/pan", "/arm_node/enable", "/diagnostics"),
        ("-r __ns:=/r_$serial", "/r_host/arm_node", "/r_host/pan", "/r_host/arm_node/enable", "/diagnostics"),
        ("-r __ns:=/ -r pan:=tilt", "/arm_node", "/tilt", "/arm_node/enable", "/diagnostics"),
        ("-r __ns:=/ -r pan:=/cmd/pan", "/arm_node", "/cmd/pan", "/arm_node/enable", "/diagnostics"),
        ("-r __ns:=/ -r pan:=~/pan", "/arm_node", "/arm_node/pan", "/arm_node/enable", "/diagnostics"),
        ("-r __ns:=/ -r ~/enable:=go", "/arm_node", "/pan", "/go", "/diagnostics"),
        ("-r __ns:=/a -r /diagnostics:=d", "/a/arm_node", "/a/pan", "/a/arm_node/enable", "/a/d"),
        ("-r __ns:=/ -r rostopic://pan:=/p", "/arm_node", "/p", "/arm_node/enable", "/diagnostics"),
        ("-r __ns:=/ -r rosservice://pan:=/p", "/arm_node", "/pan", "/arm_node/enable", "/diagnostics"),
        # Rules are expanded with the new names, whichever order they have on the command line.
        ("-r pan:=x -r __ns:=/a -r __node:=n", "/a/n", "/a/x", "/a/n/enable", "/diagnostics"),
        # A rule with a prefix is for this node only.  The first rule that fits counts.
        ("-r __ns:=/ -r arm_node:pan:=x -r pan:=y", "/arm_node", "/x", "/arm_node/enable", "/diagnostics"),
        ("-r __ns:=/ -r other:pan:=x -r pan:=y", "/arm_node", "/y", "/arm_node/enable", "/diagnostics"),
        ("-r other:__node:=n -r __node:=m -r m:__ns:=/a", "/a/m", "/a/pan", "/a/m/enable", "/diagnostics"),
        # A rule of a topic does not rename the node.
        ("-r __ns:=/ -r /arm_node:=/x", "/arm_node", "/pan", "/arm_node/enable", "/diagnostics"),
        ("-r __ns:=/ --ros-args -r pan:=/p -- -r pan:=/q", "/arm_node", "/p", "/arm_node/enable", "/diagnostics"),
    ],
)
def test_names(
    renamed: Program, tmp_path: Path, arguments: str, node: str, pan: str, enable: str, diagnostics: str
) -> None:
    """A topic and a service have the name "enable", and a rule is for both."""
    assert names(renamed, tmp_path, *arguments.split()) == [node, pan, enable, diagnostics, enable]


def test_a_rule_for_services_only(renamed: Program, tmp_path: Path) -> None:
    found = names(renamed, tmp_path, "-r", "__ns:=/", "-r", "rosservice://~/enable:=/go")
    assert found[2:] == ["/arm_node/enable", "/diagnostics", "/go"]
    found = names(renamed, tmp_path, "-r", "__ns:=/", "-r", "rostopic://~/enable:=/go")
    assert found[2:] == ["/go", "/diagnostics", "/arm_node/enable"]


# Parameters ------------------------------------------------------------------------------------------------------


def duty(program: Program, folder: Path, *arguments: str) -> float:
    """The duty cycle in the first cycle: the gain times the setpoint of 0.25, at most the limit."""
    return float(program.run_good(folder, 0.003, None, "--ros-args", *arguments, "--").trace["outputs.duty"][0])


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ("", 0.2),
        ("-p PID.kp:=0.4", 0.1),
        ("--param PID.kp:=1e1", 0.9),
        ("-p PID.kp:=2 -p PID.limit:=.3", 0.3),
        ("-p PID.kp:=2 -p PID.kp:=0.4", 0.1),
        ("-p motor_node:PID.kp:=0.4", 0.1),
        ("-p other:PID.kp:=0.4", 0.2),
        ("-p use_sim_time:=false -p start_type_description_service:=true -p qos_overrides./x.publisher.depth:=1", 0.2),
    ],
)
def test_parameters(motor: Program, tmp_path: Path, arguments: str, expected: float) -> None:
    assert duty(motor, tmp_path, *arguments.split()) == pytest.approx(expected)


FILES = {
    "as launch_ros writes it": "/**:\n  ros__parameters:\n    PID.kp: 0.4\n",
    "as ros2 param dump writes it": "/motor_node:\n  ros__parameters:\n    PID:\n      kp: 0.4\n      limit: 0.9\n",
    "a name without a slash": "motor_node:\n  ros__parameters: {}\n\nmotor_node: # again\n"
    " 'ros__parameters':\n  \"PID\":\n            kp:   0.4 # rad\n",
    "by its new name": "/robot:\n  arm:\n    ros__parameters:\n      PID.kp: 0.4\n"
    "  leg:\n    ros__parameters:\n      x: [1]\n",
    "wildcards": "\ufeff/*/arm:\r\n  ros__parameters:\r\n    PID.kp: 4e-1\r\n",
    "parameters of other nodes": "---\nplanner:\n  ros__parameters:\n    plugins:\n    - a\n    - {b: 1}\n    text: |\n"
    "       kp: 1\n/**/arm:\n  ros__parameters:\n    PID.kp: 0.4\n",
}


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_parameters(motor: Program, tmp_path: Path, name: str) -> None:
    file = tmp_path / "parameters.yaml"
    file.write_text(FILES[name], newline="", encoding="utf-8")
    rename = [] if "motor_node" in FILES[name] else ["-r", "__ns:=/robot", "-r", "__node:=arm"]
    assert duty(motor, tmp_path, *rename, "--params-file", str(file)) == pytest.approx(0.1)
    assert duty(motor, tmp_path, *rename, "--params-file", str(file), "-p", "PID.kp:=0.8") == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("motor_node:\n  ros__parameters:\n    PID:\n      kd: 1\n", "4: error: there is no parameter 'PID.kd'"),
        ("motor_node:\n  ros__parameters:\n    PID.kp: fast\n", "3: error: parameter 'PID.kp' must be a number"),
        ("motor_node:\n  ros__parameters:\n    PID.kp: '1'\n", "3: error: parameter 'PID.kp' must be a number"),
        ("motor_node:\n  ros__parameters:\n    PID.kp: true\n", "3: error: parameter 'PID.kp' must be a number"),
        ("motor_node:\n  ros__parameters:\n    PID.kp: [1]\n", "3: error: parameter 'PID.kp' must be a number"),
        ("motor_node:\n  ros__parameters:\n    PID.kp: .inf\n", "3: error: parameter 'PID.kp' must be finite"),
        ("motor_node:\n  ros__parameters:\n    PID.kp:\n    PID.limit: 1\n", "3: error: this key has no value"),
        ("motor_node:\n  ros__parameters:\n    PID.kp:\n", "3: error: this key has no value"),
        ("motor_node:\n  ros__parameters:\n    PID.kp:\n    - 1\n", "4: error: this form of YAML is not supported"),
        ("motor_node:\n  ros__parameters:\n  - 1\n", "3: error: this form of YAML is not supported"),
        ("motor_node:\n  ros__parameters:\n    - 1\n", "3: error: this form of YAML is not supported"),
        ("motor_node:\n  ros__parameters:\n    PID.kp 1\n", "3: error: this line must have the form 'key: value'"),
        (
            "motor_node:\n  ros__parameters:\n    PID.kp: 1\n   PID.limit: 1\n",
            "4: error: this line is indented wrongly",
        ),
        ("motor_node:\n\tros__parameters:\n", "2: error: this line is indented by a tab"),
        ("motor_node: {ros__parameters: {PID.kp: 1}}\n", "1: error: a value must be below 'ros__parameters'"),
        ("motor_node:\n  ros__parameters: {PID.kp: 1}\n", "2: error: 'ros__parameters' must be a mapping"),
        ("{motor_node: 1}\n", "1: error: this form of YAML is not supported"),
        ("PID.kp: 1\n", "1: error: a value must be below 'ros__parameters'"),
        ("a:\n b:\n" + "".join(f"{' ' * k}c:\n" for k in range(2, 20)), "17: error: the keys are nested too deeply"),
        ("x" * 2000 + "\n", "1: error: this line is too long"),
    ],
)
def test_a_wrong_file_of_parameters(motor: Program, tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "parameters.yaml"
    file.write_text(text)
    run = motor.run(tmp_path, 0.003, None, "--ros-args", "--params-file", str(file), "--")
    assert run.status == 2 and run.stdout == ""
    assert run.stderr.startswith(f"{file}:{message}")
    assert run.stderr.count("error:") == 1


def test_unknown_parameters_for_all_nodes_are_a_warning(motor: Program, tmp_path: Path) -> None:
    file = tmp_path / "parameters.yaml"
    file.write_text(
        "/**:\n  ros__parameters:\n    use_sim_time: true\n    frame: map\n    list:\n    - 1\n    PID.kp: 0.4\n"
    )
    arguments = ["--ros-args", "--params-file", str(file)]
    run = motor.run(tmp_path, 0.003, None, *arguments, "--")
    assert run.status == 0 and run.trace["outputs.duty"][0] == pytest.approx(0.1)
    assert run.stderr.splitlines() == [
        f"{file}:3: warning: use_sim_time has no effect: this program does not read /clock",
        f"{file}:4: warning: this target has no parameter 'frame'",
    ]
    assert motor.run_good(tmp_path, 0.003, None, *arguments, "--log-level", "error", "--").status == 0


def test_parameters_enable_nothing(motor: Program, tmp_path: Path) -> None:
    for name in ("enable", "enabled", "motor_enable", "$enable"):
        run = motor.run(tmp_path, 0.003, None, "--ros-args", "-p", f"{name}:=1", "--")
        assert (run.status, run.stderr.splitlines()[0]) == (2, f"error: -p: there is no parameter '{name}'")
    gain = ["--ros-args", "-p", "PID.kp:=0.4", "--"]
    run = motor.run_good(tmp_path, 0.003, "time,topic,value\n0,$enable,0\n", *gain)
    assert run.trace["enabled"] == [0.0, 0.0, 0.0]
    run = motor.run_good(tmp_path, 0.003, "time,topic,value\n0,$enable,0\n0.001,$enable,1\n", *gain)
    assert run.trace["enabled"] == [0.0, 0.0, 1.0]  # a stop disables two cycles
    assert run.trace["outputs.duty"][-1] == pytest.approx(0.1), "the value stays when the model is initialised"


# The command line ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("--remote", "error: unknown argument '--remote' after --ros-args\n"),
        ("PID.kp:=1", "error: unknown argument 'PID.kp:=1' after --ros-args\nhint: write -r PID.kp:=1 to change"),
        ("-p", "error: argument -p needs a value\nhint: write -p NAME:=VALUE\n"),
        ("-p PID.kp", "error: -p 'PID.kp' does not set a parameter\n"),
        ("-p :=1", "error: -p ':=1' does not set a parameter\n"),
        ("-p PID.kp:=", "error: -p 'PID.kp:=' does not set a parameter\n"),
        ("-p PID.kp:=nan", "error: -p: parameter 'PID.kp' must be finite, not nan\n"),
        (
            "-p PID.kd:=1",
            "error: -p: there is no parameter 'PID.kd'\nhint: the parameters of this target: PID.kp, PID.limit\n",
        ),
        ("-p PID\\kp:=1", "error: -p: there is no parameter 'PID\\kp'\n"),
        ("--params-file missing.yaml", "missing.yaml: error: cannot read the file of parameters: No such file"),
        ("--params-file .", ".: error: cannot read the file of parameters: Is a directory"),
        ("-r pan", "error: -r 'pan': this is not a rule\n"),
        ("-r 9:=b", "error: -r '9:=b': a name of a topic has letters"),
        ("-r a/:=b", "error: -r 'a/:=b': a name of a topic has letters"),
        ("-r /*:=/b", "error: -r '/*:=/b': a name of a topic has letters"),
        ("-r a:={node}", "error: -r 'a:={node}': a name of a topic has letters"),
        (f"-r a:={'b' * 200}", f"error: -r 'a:={'b' * 200}': a name is too long\n"),
        ("-r __ns:=robot", "error: -r '__ns:=robot': this is not a namespace\n"),
        ("-r __node:=a/b", "error: -r '__node:=a/b': this is not the name of a node\n"),
        ("--log-level loud", "error: --log-level 'loud' is not a level\n"),
        ("--enclave /robot", "error: --enclave '/robot': this program does not support the security of ROS 2"),
        ("-- --quite", "error: unknown option '--quite'\n"),
        ("-r a:=b " * 129, "error: more than 128 arguments after --ros-args\n"),
    ],
)
def test_wrong_arguments(motor: Program, tmp_path: Path, arguments: str, message: str) -> None:
    command = [str(motor.path), "--duration", "1", "--ros-args", *arguments.split()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(message), done.stderr


def test_the_old_form_of_a_rule_gets_a_hint(motor: Program, tmp_path: Path) -> None:
    run = motor.run(tmp_path, 0.003, None, "pan:=tilt")
    assert run.status == 2
    assert run.stderr == "error: unknown option 'pan:=tilt'\nhint: write --ros-args -r pan:=tilt\n"


def test_arguments_that_launch_files_write(motor: Program, tmp_path: Path) -> None:
    arguments = "--ros-args --log-level warn --log-level other:=fatal --log-config-file f --log-file-name n -e /"
    arguments += " --disable-rosout-logs --enable-stdout-logs --disable-external-lib-logs --ros-args -r __node:=n --"
    assert motor.run_good(tmp_path, 0.003, None, *arguments.split(), "--quiet").stdout == ""


def test_a_node_runs_in_real_time_and_ends_like_a_node(connected_motor: Program, tmp_path: Path) -> None:
    """Launch files give no options of the program.  launch reports every exit status but 0 as an error."""
    for arguments, status in (["--ros-args", "-r", "__node:=n"], 0), (["--realtime"], 130):
        with subprocess.Popen([str(connected_motor.path), *arguments], stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None and process.stdout.readline() == "connected\n"
            process.send_signal(signal.SIGINT)
            rest = process.communicate(timeout=30)[0]
            assert process.returncode == status
            assert "s in real time" in rest
