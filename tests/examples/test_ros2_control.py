# SPDX-License-Identifier: Apache-2.0
"""``examples/ros2_control``: xacro and a parser of URDF read the files, and robots obey the plugin's messages."""

from __future__ import annotations

import ast
import json
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

pytest.importorskip("tests.doubles.ros2_peer.packages", exc_type=ImportError)

from epg.cli.main import main
from tests.doubles.ros2_peer.messages import Bool_, DiagnosticArray_, JointState_
from tests.doubles.ros2_peer.peer import Peer
from tests.doubles.toolchain import cmake_and_ninja, skip_if_missing, tool
from tests.examples.pico_project import configure, run
from tests.ros2.network import Network, network, running

EXAMPLE = Path(__file__).resolve().parents[2] / "examples/ros2_control"
JOINTS = {"jiwy": ["pan", "tilt"], "relbot": ["left", "right"]}
NODES = {"jiwy": "JIWY_node", "relbot": "RELbot_node"}
PERIOD = 0.033  # s


@pytest.fixture(scope="module")
def build(tmp_path_factory: pytest.TempPathFactory) -> Path:
    skip_if_missing(lambda: tool("cyclonedds"))
    skip_if_missing(cmake_and_ninja)
    folder = tmp_path_factory.mktemp("ros2_control")
    configure(EXAMPLE, build=folder)
    run(folder, "cmake", "--build", ".")
    return folder


@pytest.fixture
def net() -> Iterator[Network]:
    with network() as found:
        yield found


def expanded(build: Path, robot: str, folder: Path) -> Any:
    """The description of a robot as xacro expands it."""
    xacro = pytest.importorskip("xacro", reason="xacro is not installed: pip install xacro")
    describe(build, robot, folder)
    hardware = folder / f"{robot}.ros2_control.xacro"
    return xacro.process_file(str(EXAMPLE / f"{robot}.urdf.xacro"), mappings={"ros2_control": str(hardware)})


def describe(build: Path, robot: str, folder: Path) -> None:
    description = build / f"epg/{robot}/{robot}.json"
    assert main(["describe", str(description), "--ros2-control", "--output", str(folder)]) == 0


@pytest.mark.parametrize("robot", JOINTS)
def test_a_urdf_parser_reads_the_description(build: Path, robot: str, tmp_path: Path) -> None:
    """PyPI has the parser only as sources, which EPG does not install."""
    reason = "urdf-parser-py is not installed: pip install urdf-parser-py"
    urdf = pytest.importorskip("urdf_parser_py.urdf", reason=reason)
    parsed = urdf.URDF.from_xml_string(expanded(build, robot, tmp_path).toxml())
    assert parsed.get_root() == "base_link"
    assert [joint.name for joint in parsed.joints] == JOINTS[robot]
    assert all(joint.limit.velocity > 0 and joint.limit.effort > 0 for joint in parsed.joints)


@pytest.mark.parametrize("robot", JOINTS)
def test_xacro_reads_the_description(build: Path, robot: str, tmp_path: Path) -> None:
    document = expanded(build, robot, tmp_path)
    [system] = document.getElementsByTagName("ros2_control")
    parameters = {item.getAttribute("name"): item.firstChild.data for item in system.getElementsByTagName("param")}
    assert parameters == {
        "joint_commands_topic": f"/{NODES[robot]}/joint_commands",
        "joint_states_topic": f"/{NODES[robot]}/joint_states",
        "trigger_joint_command_threshold": "-1",
    }
    joints = {
        joint.getAttribute("name"): [
            (item.tagName, item.getAttribute("name")) for item in joint.childNodes if item.nodeType == item.ELEMENT_NODE
        ]
        for joint in system.getElementsByTagName("joint")
    }
    interfaces = [("command_interface", "position"), ("state_interface", "position")]
    assert joints == dict.fromkeys(JOINTS[robot], interfaces)
    controllers = yaml.safe_load((tmp_path / f"{robot}.controllers.yaml").read_text())
    assert controllers["controller_manager"]["ros__parameters"]["update_rate"] == 30
    trajectory = controllers["joint_trajectory_controller"]["ros__parameters"]
    assert (trajectory["joints"], trajectory["command_interfaces"]) == (JOINTS[robot], ["position"])
    ast.parse((tmp_path / f"{robot}.ros2_control.launch.py").read_text())


def test_the_launch_file_has_the_processes_in_their_order(build: Path, tmp_path: Path) -> None:
    """ROS 2's own loader reads the file.  It does not start ros2_control."""
    if shutil.which("ros2") is None:
        pytest.skip("ROS 2 is not sourced: install ROS 2 Jazzy and '. /opt/ros/jazzy/setup.bash'")
    describe(build, "jiwy", tmp_path)
    script = (
        "import runpy, sys; from launch import LaunchContext;"
        "found = runpy.run_path(sys.argv[1])['generate_launch_description']();"
        "print([type(action).__name__ for action in found.entities])"
    )
    file = tmp_path / "jiwy.ros2_control.launch.py"
    done = subprocess.run([sys.executable, "-c", script, str(file)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert ast.literal_eval(done.stdout) == [
        "DeclareLaunchArgument",
        "Node",
        "Node",
        "ExecuteProcess",
        "RegisterEventHandler",
    ]


def test_a_robot_obeys_the_messages_of_the_plugin(build: Path, net: Network) -> None:
    """The joints of the commands have another order than the target's.  Without commands the target is disabled."""
    goals = {"right": 1.0, "left": -0.5}
    with (
        running([net.run(build / "relbot_host", "--quiet", "--duration", "40")]),
        Peer(net.domain, "plugin") as peer,
    ):
        states = peer.subscription("/RELbot_node/joint_states", JointState_, reliable=False)
        told = peer.subscription("/diagnostics", DiagnosticArray_)
        commands = peer.publisher("/RELbot_node/joint_commands", JointState_)
        enable = peer.publisher("/RELbot_node/enable", Bool_)
        assert peer.spin_until(lambda: bool(states.messages) and commands.matched == 1 and enable.matched == 1)

        def command(values: list[float]) -> None:
            header = states.messages[-1].header
            commands.publish(JointState_(header, list(goals), values, [], []))

        def positions() -> dict[str, float]:
            return dict(zip(states.messages[-1].name, states.messages[-1].position))

        def follow() -> bool:
            command(list(goals.values()))
            return all(abs(positions()[joint] - goal) < 0.05 for joint, goal in goals.items())

        def stopped() -> bool:
            """The target may find the writers later than they find it: messages before that are lost."""
            enable.publish(Bool_(False))
            values = {pair.key: pair.value for pair in told.messages[-1].status[0].values} if told.messages else {}
            return values.get("stopped_by") == "topic"

        assert peer.spin_until(stopped)
        command([0.0, 0.0])
        enable.publish(Bool_(True))
        assert peer.spin_until(follow), positions()
        assert peer.spin_until(lambda: any(one.status[0].message == "setpoint timeout" for one in told.messages))


def changed(build: Path, folder: Path, change: Any) -> Path:
    data = json.loads((build / "epg/jiwy/jiwy.json").read_text())
    change(data)
    file = folder / "jiwy.json"
    file.write_text(json.dumps(data))
    return file


def _no_timeout(data: dict[str, Any]) -> None:
    data["subscriptions"][0]["on_timeout"] = "hold"


def _enabled(data: dict[str, Any]) -> None:
    data["control"]["enable_at_start"] = True


def _no_commands(data: dict[str, Any]) -> None:
    data["subscriptions"] = [topic for topic in data["subscriptions"] if topic["role"] == "enable"]


def _no_position(data: dict[str, Any]) -> None:
    states = next(topic for topic in data["publications"] if topic["type"] == "sensor_msgs/msg/JointState")
    states["values"] = [value for value in states["values"] if "pan" not in value]


@pytest.mark.parametrize(
    ("change", "id"),
    [
        (_no_timeout, "ros2-control-timeout"),
        (_enabled, "ros2-control-enabled"),
        (_no_commands, "ros2-control-topics"),
        (_no_position, "ros2-control-joint"),
    ],
)
def test_an_unsafe_target_is_refused(
    build: Path, tmp_path: Path, change: Any, id: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = changed(build, tmp_path, change)
    assert main(["describe", str(file), "--ros2-control", "--output", str(tmp_path / "out")]) == 1
    captured = capsys.readouterr()
    assert f"[{id}]" in captured.err and "hint: " in captured.err
    assert not (tmp_path / "out").exists()
