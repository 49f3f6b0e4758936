# SPDX-License-Identifier: Apache-2.0
"""The middleware `dds` and ROS 2 itself, if it is installed and sourced: the command line's tools and rclpy.

Without ROS 2, these tests do not run: tests/ros2/test_dds_node.py tests the same promises with EPG's own peer.
"""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import yaml

from epg.cli.main import main
from tests.doubles.ros2_peer.definitions import type_hash
from tests.ros2.build import Build
from tests.ros2.network import Network, running
from tests.waiting import until

if shutil.which("ros2") is None:
    pytest.skip("ROS 2 is not sourced: install ROS 2 Jazzy and '. /opt/ros/jazzy/setup.bash'", allow_module_level=True)

NODE = "/robot_7/JIWY_node"
DIRECT = ("--no-daemon", "--spin-time", "2")
"""Without the daemon, which could remember the nodes of another test."""
IMPLEMENTATIONS = ["rmw_cyclonedds_cpp", "rmw_fastrtps_cpp"]


@pytest.fixture(params=IMPLEMENTATIONS)
def ros(request: pytest.FixtureRequest, net: Network) -> dict[str, str]:
    """The environment for ROS 2 with one of its DDS implementations."""
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    if not any((Path(prefix) / "share" / request.param).is_dir() for prefix in prefixes):
        package = f"ros-{os.environ.get('ROS_DISTRO', 'jazzy')}-{request.param.replace('_', '-')}"
        pytest.skip(f"ROS 2 is not sourced with {request.param}: sudo apt install {package}")
    environment = {**net.environment, "RMW_IMPLEMENTATION": request.param}
    if request.param != "rmw_cyclonedds_cpp":  # only CycloneDDS supports the tag of the test network
        for mapping in (net.environment, environment):
            mapping.pop("CYCLONEDDS_URI", None)
            mapping["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
            mapping["ROS_DOMAIN_ID"] = str(100 + os.getpid() % 100)
    return environment


@pytest.fixture
def robot(ros: dict[str, str], net: Network, build: Build, tmp_path: Path) -> Iterator[Path]:
    """Runs JIWY; yields the file of its trace, which is complete when JIWY has ended."""
    trace = tmp_path / "trace.csv"
    options = ("--quiet", "--serial", "7", "--duration", "40", "--trace", str(trace))
    with running([net.run(build("jiwy"), *options)]):
        until(lambda: trace.is_file() and trace.read_text())
        yield trace


def ask(environment: dict[str, str], *arguments: str, seconds: float = 30.0) -> str:
    """The output of `ros2`, without its daemon, which would remember nodes of other domains."""
    done = subprocess.run(
        ["ros2", *arguments], env=environment, capture_output=True, text=True, check=False, timeout=seconds
    )
    return done.stdout


def test_ros2_lists_the_node_and_its_topics(robot: Path, ros: dict[str, str]) -> None:
    assert NODE in ask(ros, "node", "list", "--no-daemon", "--spin-time", "4").split()
    topics = ask(ros, "topic", "list", "-t", "--no-daemon", "--spin-time", "4").splitlines()
    for topic in ("pan_publisher", "tilt_publisher", "pan_subscriber", "tilt_subscriber"):
        assert f"/robot_7/{topic} [std_msgs/msg/Float64]" in topics
    assert "/robot_7/JIWY_node/enable [std_msgs/msg/Bool]" in topics
    told = ask(ros, "topic", "info", "--verbose", "/robot_7/pan_publisher", "--no-daemon", "--spin-time", "4")
    assert "Node name: JIWY_node" in told and "Node namespace: /robot_7" in told
    assert type_hash("std_msgs/msg/Float64") in told and "RELIABLE" in told


@pytest.mark.parametrize("ros", ["rmw_cyclonedds_cpp"], indirect=True)
def test_ros2_sets_parameters_and_calls_services(robot: Path, ros: dict[str, str]) -> None:
    assert ask(ros, "param", "set", NODE, "Pan.PID.kp", "3.5", *DIRECT) == "Set parameter successful\n"
    assert ask(ros, "param", "get", NODE, "Pan.PID.kp", *DIRECT) == "Double value is: 3.5\n"
    described = ask(ros, "param", "describe", NODE, "Pan.PID.kp", *DIRECT)
    assert "Description: gain of the pan axis" in described and "Max value: 20.0" in described
    called = ask(ros, "service", "call", f"{NODE}/enable", "std_srvs/srv/SetBool", "{data: false}")
    assert "SetBool_Response(success=True, message='disabled')" in called


def test_ros2_echoes_positions_and_publishes_setpoints(robot: Path, ros: dict[str, str]) -> None:
    echoed = ask(ros, "topic", "echo", "--once", "/robot_7/pan_publisher", "std_msgs/msg/Float64")
    assert echoed.startswith("data: ")
    best_effort = ("--qos-reliability", "best_effort")
    echoed = ask(ros, "topic", "echo", "--once", *best_effort, "/robot_7/tilt_publisher", "std_msgs/msg/Float64")
    assert echoed.startswith("data: ")
    printed = ask(
        ros, "topic", "pub", "-t", "3", "-w", "1", "/robot_7/pan_subscriber", "std_msgs/msg/Float64", "data: 0.5"
    )
    assert "publishing #3" in printed


def test_ros2_echoes_a_message_of_any_type(ros: dict[str, str], net: Network, build: Build, tmp_path: Path) -> None:
    with running([net.run(build("sensors"), "--quiet", "--serial", "7", "--duration", "60")]):
        echoed = ask(ros, "topic", "echo", "--once", "/robot_7/imu/data", "sensor_msgs/msg/Imu")
        told = ask(ros, "topic", "info", "--verbose", "/robot_7/imu/data", "--no-daemon", "--spin-time", "4")
    message = yaml.safe_load(echoed.partition("---")[0])
    assert message["header"]["frame_id"] == "imu_link" and message["orientation"]["w"] == 1.0
    assert abs(message["header"]["stamp"]["sec"] - tmp_path.stat().st_mtime) < 100.0
    assert message["orientation_covariance"] == [-1.0] + [0.0] * 8
    assert message["angular_velocity_covariance"][4] == 0.01
    assert "Topic type: sensor_msgs/msg/Imu" in told and type_hash("sensor_msgs/msg/Imu") in told


RCLPY = """
import sys, time
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from std_msgs.msg import Bool, Float64

rclpy.init()
node = rclpy.create_node("default_qos")
heard, told = [], []
node.create_subscription(Float64, "/robot_7/pan_publisher", heard.append, 10)
node.create_subscription(DiagnosticArray, "/diagnostics", told.append, 10)
enable = node.create_publisher(Bool, "/robot_7/JIWY_node/enable", 10)
while len(heard) < 60 or not told or told[-1].status[0].message != "disabled":
    rclpy.spin_once(node, timeout_sec=0.1)
    if len(heard) == 30:
        enable.publish(Bool(data=False))
print(len(heard), told[-1].status[0].message if told else "nothing")
"""


def test_a_node_of_rclpy_with_default_qos(robot: Path, ros: dict[str, str]) -> None:
    done = subprocess.run(
        [sys.executable, "-c", RCLPY], env=ros, capture_output=True, text=True, check=False, timeout=60
    )
    if "No module named 'rclpy'" in done.stderr:
        pytest.skip("ROS 2 is not sourced for this Python: run the tests with the system's")
    heard, state = done.stdout.split()
    assert int(heard) >= 60 and state == "disabled"


@contextmanager
def launched(ros: dict[str, str], file: Path, *arguments: str) -> Iterator[subprocess.Popen[str]]:
    """A launch file that runs; at the end, what it has left."""
    command = ["ros2", "launch", str(file), *arguments]
    with subprocess.Popen(command, env=ros, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as launch:
        try:
            yield launch
        finally:
            launch.kill()


def process_of(launch: subprocess.Popen[str]) -> int:
    """The process that a launch file has started."""
    assert launch.stdout is not None
    for line in launch.stdout:
        if found := re.search(r"process started with pid \[(\d+)\]", line):
            return int(found[1])
    raise AssertionError("launch has started nothing")


LAUNCH = """
from launch import LaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([Node(
        executable="{program}", name="left", namespace="/fleet", parameters=[{{"Pan.PID.kp": 3.5}}],
        remappings=[("pan_publisher", "/pan")], output="screen")])
"""


def test_launch_starts_a_node_and_ends_it(ros: dict[str, str], build: Build, tmp_path: Path) -> None:
    file = tmp_path / "robot.launch.py"
    file.write_text(LAUNCH.format(program=build("jiwy")))
    with launched(ros, file) as launch:
        process_of(launch)
        assert ask(ros, "topic", "echo", "--once", "/pan", "std_msgs/msg/Float64", seconds=60.0).startswith("data: ")
        assert "/fleet/left" in ask(ros, "node", "list", "--no-daemon", "--spin-time", "4").split()
        launch.send_signal(signal.SIGINT)
        assert "process has finished cleanly" in launch.communicate(timeout=30)[0]


def test_the_file_of_epg_launch_starts_a_program_and_ends_it_when_it_hangs(
    ros: dict[str, str], build: Build, tmp_path: Path
) -> None:
    program = build("jiwy")
    description = program.parent / "epg/jiwy/jiwy.json"
    names = ["--program", f"jiwy={program}", "--remap", "jiwy=pan_publisher:=/pan"]
    assert main(["launch", str(description), *names, "--output", str(tmp_path)]) == 0
    with launched(ros, tmp_path / "agents.launch.py", "jiwy_namespace:=lab/r2") as launch:
        process = process_of(launch)
        assert ask(ros, "topic", "echo", "--once", "/pan", "std_msgs/msg/Float64", seconds=60.0).startswith("data: ")
        assert "/lab/r2/JIWY_node" in ask(ros, "node", "list", "--no-daemon", "--spin-time", "4").split()
        os.kill(process, signal.SIGSTOP)
        launch.send_signal(signal.SIGINT)
        output = launch.communicate(timeout=30)[0]
        assert "escalating to 'SIGTERM'" in output and "escalating to 'SIGKILL'" in output
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)


SIMULATED = """
import time
import rclpy
from rclpy.parameter import Parameter

rclpy.init()
node = rclpy.create_node("follower", parameter_overrides=[Parameter("use_sim_time", value=True)])
fired = []
# the pace of simulated time
node.create_timer(1.0, lambda: fired.append((node.get_clock().now().nanoseconds / 1e9, time.monotonic())))
while len(fired) < 10:
    rclpy.spin_once(node, timeout_sec=0.1)
simulated, real = (after - before for before, after in zip(fired[1], fired[-1]))
print(fired[-1][0], simulated / real)
"""


def test_a_node_follows_simulated_time(ros: dict[str, str], build: Build) -> None:
    command = [str(build("jiwy")), "--pace", "4", "--quiet"]
    with subprocess.Popen(command, env=ros, stderr=subprocess.PIPE, text=True) as robot:
        try:
            done = subprocess.run(
                [sys.executable, "-c", SIMULATED], env=ros, capture_output=True, text=True, timeout=60
            )
            told = ask(ros, "topic", "info", "--verbose", "/clock", "--no-daemon", "--spin-time", "4")
        finally:
            robot.send_signal(signal.SIGINT)
    if "No module named 'rclpy'" in done.stderr:
        pytest.skip("ROS 2 is not sourced for this Python: run the tests with the system's")
    now, pace = map(float, done.stdout.split())
    assert now < 1000.0, "not since 1970"
    assert 1.0 < pace < 8.0
    assert type_hash("rosgraph_msgs/msg/Clock") in told and "BEST_EFFORT" in told
