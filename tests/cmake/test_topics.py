# SPDX-License-Identifier: Apache-2.0
"""Topics of several values, from CSV files and the console to the model and back, with sanitizers."""

from __future__ import annotations

import csv
import json
import subprocess
from pathlib import Path

import pytest

from epg.cli.main import main
from tests.cmake.project import PROJECTS, Project

SETPOINTS = """time,topic,value
0.1,cmd_vel/linear_x,2
0.1,cmd_vel/angular_z,0.5
0.1,numbers/second,7
0.1,wanted/right.position,-3
0.7,cmd_vel/linear_x,1
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    project = Project(tmp_path_factory.mktemp("topics"), "topics")
    project.configure()
    project.build()
    return project.build_folder


@pytest.fixture(scope="module")
def published(folder: Path) -> dict[tuple[str, float], float]:
    (folder / "in.csv").write_text(SETPOINTS)
    files = ["--setpoints", "in.csv", "--topics", "topics.csv"]
    subprocess.run([folder / "by_files_host", "--quiet", "--duration", "0.8", *files], cwd=folder, check=True)
    with (folder / "topics.csv").open(newline="") as file:
        return {(row["topic"], round(float(row["time"]), 3)): float(row["value"]) for row in csv.DictReader(file)}


def test_values_of_a_message_are_called_after_their_ports(published: dict[tuple[str, float], float]) -> None:
    assert sorted({name for name, _ in published}) == [
        "/all/c",
        "joint_states/left.position",
        "joint_states/left.velocity",
        "joint_states/right.velocity",
        "~/moving",
    ]


def test_values_reach_the_model_and_come_back(published: dict[tuple[str, float], float]) -> None:
    assert published["joint_states/left.velocity", 0.08] == 0.0
    assert published["joint_states/left.velocity", 0.14] == 1.5
    assert published["joint_states/right.velocity", 0.14] == 2.5
    assert published["joint_states/left.position", 0.14] == published["/all/c", 0.14] == 7 - 3
    assert published["~/moving", 0.14] == 1.0


def test_initial_values_are_those_of_the_component(published: dict[tuple[str, float], float]) -> None:
    assert published["/all/c", 0.08] == 1.0


def test_velocities_time_out_and_positions_do_not(folder: Path) -> None:
    """Twist has velocities, with a timeout of 0.5 s unless the .tcf sets another; a JointState's positions stay."""
    text = (folder / "epg" / "by_files" / "by_files_app.c").read_text()
    setpoints = text[text.index("static const epg_setpoint_t setpoints") : text.index("static epg_setpoint_sample_t")]
    timeouts = [line.split("=")[1].strip(" ,") for line in setpoints.splitlines() if ".timeout_ns" in line]
    assert timeouts == ["500000000u", "500000000u", "0u", "0u"]


def test_unknown_values_are_told_with_those_there_are(folder: Path) -> None:
    (folder / "wrong.csv").write_text("time,topic,value\n0.1,cmd_vel,2\n")
    command = [folder / "by_files_host", "--quiet", "--duration", "0.1", "--setpoints", "wrong.csv"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "unknown topic 'cmd_vel'" in done.stderr
    assert "'cmd_vel/linear_x', 'cmd_vel/angular_z', 'numbers/second', 'wanted/right.position'" in done.stderr


def test_console(folder: Path) -> None:
    """The console uses the same names; if it is already the middleware, an additional console is the same one."""
    command = [folder / "by_console_host", "--realtime", "--console", "--serial", "A1", "--duration", "0.5"]
    lines = "cmd_vel/linear_x=2 cmd_vel/angular_z=0.5\nget node\nget namespace\nports\n"
    done = subprocess.run(command, input=lines, capture_output=True, text=True, check=False, cwd=folder)
    assert "ready node=robot_A1 " in done.stdout
    assert "ok get node=robot_$serial name=robot_A1" in done.stdout
    assert "ok get namespace=/fleet name=/fleet" in done.stdout
    ports = [line.split()[2] for line in done.stdout.splitlines() if line.startswith("port publication")]
    assert ports[-2:] == ["/all/c", "~/moving"]


def test_description(folder: Path) -> None:
    data = json.loads((folder / "epg" / "by_files" / "by_files.json").read_text())
    assert [(t["topic"], t["type"], t["role"], t["depth"]) for t in data["publications"]] == [
        ("joint_states", "sensor_msgs/msg/JointState", "values", 10),
        ("/all", "std_msgs/msg/Float64MultiArray", "values", 3),
        ("~/moving", "std_msgs/msg/Bool", "values", 10),
        ("/pong", "std_msgs/msg/Int32", "echo", 10),
    ]
    assert [(t["topic"], t["type"], t["values"]) for t in data["subscriptions"]] == [
        ("cmd_vel", "geometry_msgs/msg/Twist", ["cmd_vel/linear_x", "cmd_vel/angular_z"]),
        ("numbers", "std_msgs/msg/Float64MultiArray", ["numbers/second"]),
        ("wanted", "sensor_msgs/msg/JointState", ["wanted/right.position"]),
        ("/ping", "std_msgs/msg/Int32", []),
    ]
    assert data["namespace"] == "/fleet"


def test_a_ros_2_node_has_more_topics(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only generated, because not every computer can compile this middleware."""
    monkeypatch.chdir(PROJECTS / "topics")
    command = ["generate", "robot", "--tcf", "robot.tcf", "--model", "model", "--bindings", "bindings.yaml"]
    assert main([*command, "--output", str(tmp_path), "--set", "communication.middleware=xrce"]) == 0
    data = json.loads((tmp_path / "robot.json").read_text())
    assert [(t["topic"], t["role"]) for t in data["subscriptions"]][-1] == ("~/enable", "enable")
    assert [(t["topic"], t["role"], t["qos"]) for t in data["publications"]][-1] == (
        "/diagnostics",
        "diagnostics",
        "reliable",
    )
    text = (tmp_path / "robot_app.c").read_text()
    for line in (
        ".domain = 3,",
        ".console = &epg_console,",
        ".console_options = &console_options,",
        "static double capture_memory[512];",
        ".trigger = EPG_TOPIC_CHANGE,",
        ".cycles = 10,",
        ".period_ns = 2000000000u,",
    ):
        assert line in text
