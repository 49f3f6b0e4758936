# SPDX-License-Identifier: Apache-2.0
"""The middleware `xrce` and ROS 2 itself, through each agent that is installed.

`micro_ros_agent` is used where ROS 2 is sourced with it, and eProsima's agent where ``EPG_XRCE_AGENT`` names it.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.doubles.toolchain import Missing
from tests.doubles.xrce_agent.real_agent import CYCLONE, RealAgent, program
from tests.ros2.build import Build
from tests.ros2.network import running

if shutil.which("ros2") is None:
    pytest.skip("ROS 2 is not sourced: install ROS 2 Jazzy and '. /opt/ros/jazzy/setup.bash'", allow_module_level=True)

GRAPH_AGENT = "micro_ros_agent"  # it adds boards to the list of nodes of ROS 2
IMPLEMENTATIONS = ["rmw_cyclonedds_cpp", "rmw_fastrtps_cpp"]
SERIALS = (1, 2, 3)


def graph_agent() -> Path:
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        found = Path(prefix) / "lib" / GRAPH_AGENT / GRAPH_AGENT
        if found.is_file():
            return found
    raise Missing(f"ROS 2 is not sourced with {GRAPH_AGENT}: docs/agent.md says how to install it")


@pytest.fixture(params=[GRAPH_AGENT, "MicroXRCEAgent"])
def agent(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[RealAgent]:
    try:
        found = graph_agent() if request.param == GRAPH_AGENT else program()
    except Missing as missing:
        pytest.skip(str(missing))
    with RealAgent.udp(tmp_path, found) as started:
        yield started


@contextmanager
def boards(robot: Path, agent: RealAgent, *serials: int) -> Iterator[dict[int, subprocess.Popen[str]]]:
    started = {
        serial: subprocess.Popen(
            [str(robot), "--realtime", "--quiet", "--agent", agent.address, "--serial", str(serial)],
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        for serial in serials
    }
    with running(list(started.values())):
        yield started


NODE = """
import json, os, signal, sys, time
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from std_msgs.msg import Bool, Float64
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data

rclpy.init()
node = rclpy.create_node("watch")

def wait(condition, seconds):
    "The seconds until the condition is true; None if that takes longer than `seconds`."
    began = time.monotonic()  # the time that a user waits
    while (took := time.monotonic() - began) < seconds:  # the time that a user waits
        if condition():
            return took
        rclpy.spin_once(node, timeout_sec=0.05)
    return None

def here(*serials):
    return all(node.count_publishers(f"/robot_{serial}/pan_publisher") == 1 for serial in serials)

def nodes():
    found = node.get_node_names_and_namespaces()
    return sorted(f"{space.rstrip('/')}/{name}" for name, space in found if name != "watch")

"""
"""The beginning of a ROS 2 node, which the tests continue.  It prints its result as JSON."""


def node_script(agent: RealAgent, implementation: str, script: str, *arguments: object) -> subprocess.Popen[str]:
    """Starts a script as a ROS 2 node in the agent's domain."""
    pytest.importorskip("rclpy", reason="ROS 2 is not sourced for this Python: run the tests with the system's")
    command = [sys.executable, "-c", NODE + script, *map(str, arguments)]
    return subprocess.Popen(
        command, env=environment(agent, implementation), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def environment(agent: RealAgent, implementation: str) -> dict[str, str]:
    """The environment of ROS 2 in the agent's domain."""
    return {
        **os.environ,
        "RMW_IMPLEMENTATION": implementation,
        "ROS_DOMAIN_ID": str(agent.domain),
        "CYCLONEDDS_URI": CYCLONE,
        "FASTRTPS_DEFAULT_PROFILES_FILE": str(agent.folder / "fast_dds.xml"),
    }


def ask(agent: RealAgent, implementation: str, script: str, *arguments: object) -> object:
    """Runs a script as a ROS 2 node in the agent's domain; returns its result."""
    process = node_script(agent, implementation, script, *arguments)
    output, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    result: object = json.loads(output)
    return result


THREE = """
wait(lambda: here(1, 2, 3) and len(nodes()) >= 3, 20)
names = nodes()
endpoints = {}
for serial in (1, 2, 3):
    try:
        found = node.get_publisher_names_and_types_by_node("JIWY_node", f"/robot_{serial}")
        found += node.get_subscriber_names_and_types_by_node("JIWY_node", f"/robot_{serial}")
        endpoints[serial] = sorted(name for name, _ in found)
    except Exception as error:
        endpoints[serial] = str(error)
print(json.dumps({"nodes": names, "endpoints": endpoints, "here": here(1, 2, 3)}))
"""


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_three_boards_on_one_agent(agent: RealAgent, build: Build, implementation: str) -> None:
    with boards(build("agent_jiwy"), agent, *SERIALS):
        told = ask(agent, implementation, THREE)
    assert isinstance(told, dict) and told["here"]
    if agent.agent is not None and agent.agent.name != GRAPH_AGENT:
        return  # eProsima's agent makes topics only
    names = [f"/robot_{serial}/JIWY_node" for serial in SERIALS]
    assert told["nodes"] == names
    for serial, name in zip(SERIALS, names):
        topics = ("pan_publisher", "pan_subscriber", "tilt_publisher", "tilt_subscriber")
        own = {f"/robot_{serial}/{topic}" for topic in topics} | {f"{name}/enable", "/diagnostics", "/parameter_events"}
        assert set(told["endpoints"][str(serial)]) == own


KILLED = """
other, killed = 1, int(sys.argv[1])
assert wait(lambda: here(1, 2), 20) is not None, "the boards have not been found"
graph = bool(nodes())
os.kill(killed, signal.SIGKILL)
gone = wait(lambda: node.count_publishers("/robot_2/pan_publisher") == 0, 20)
left = wait(lambda: "/robot_2/JIWY_node" not in nodes(), 20)
print(json.dumps({"endpoints": gone, "node": gone + left, "other": here(1)}))
"""


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_a_killed_board_leaves_the_graph(agent: RealAgent, build: Build, implementation: str) -> None:
    """The limit is docs/ros2.md's, with a second for the discovery."""
    with boards(build("agent_jiwy"), agent, 1, 2) as started:
        told = ask(agent, implementation, KILLED, started[2].pid)
    assert isinstance(told, dict) and told["other"]
    print(f"{agent.agent}: endpoints {told['endpoints']:.1f} s, node {told['node']:.1f} s after the last frame")
    assert 3.0 <= told["node"] <= 5.0


IMU = """
from sensor_msgs.msg import Imu

heard = []
node.create_subscription(Imu, "/robot_1/imu/data", heard.append, 10)
wait(lambda: len(heard) > 20, 20)
last = heard[-1]
print(json.dumps({
    "frame": last.header.frame_id,
    "covariance": list(last.orientation_covariance),
    "w": last.orientation.w,
    "rising": all(a.header.stamp.nanosec != b.header.stamp.nanosec for a, b in zip(heard, heard[1:])),
    "messages": len(heard),
}))
"""


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_a_message_of_any_type(agent: RealAgent, build: Build, implementation: str) -> None:
    with boards(build("agent_sensors"), agent, 1):
        told = ask(agent, implementation, IMU)
    assert isinstance(told, dict) and told.pop("messages") > 20
    assert told == {"frame": "imu_link", "covariance": [-1.0] + [0.0] * 8, "w": 1.0, "rising": True}


DISABLED = """
heard, told, kept = [], [], []
durable = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_subscription(Float64, "/robot_1/tilt_publisher", kept.append, durable)
node.create_subscription(Float64, "/robot_1/pan_publisher", heard.append, qos_profile_sensor_data)
node.create_subscription(DiagnosticArray, "/diagnostics", told.append, 10)
setpoint = node.create_publisher(Float64, "/robot_1/pan_subscriber", qos_profile_sensor_data)
enable = node.create_publisher(Bool, "/robot_1/JIWY_node/enable", 10)
assert wait(lambda: here(1) and setpoint.get_subscription_count() == 1 and len(heard) > 10, 20) is not None

def follow():
    setpoint.publish(Float64(data=0.4))
    return abs(heard[-1].data - 0.4) < 0.02

moved = wait(follow, 20)
enable.publish(Bool(data=False))
disabled = wait(lambda: told and told[-1].status[0].message == "disabled", 10)
print(json.dumps({"moved": moved, "kept": len(kept), "disabled": disabled, "level": told[-1].status[0].level[0]}))
"""


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_a_node_moves_and_disables_a_board(agent: RealAgent, build: Build, implementation: str) -> None:
    with boards(build("agent_jiwy"), agent, 1):
        told = ask(agent, implementation, DISABLED)
    assert isinstance(told, dict)
    assert told["moved"] is not None and told["disabled"] is not None
    assert told["level"] == 1 and told["kept"] > 0


SERVED = """
from std_srvs.srv import SetBool, Trigger
told = []
node.create_subscription(DiagnosticArray, "/diagnostics", told.append, 10)
enable = node.create_client(SetBool, "/robot_1/JIWY_node/enable")
reset = node.create_client(Trigger, "/robot_1/JIWY_node/reset")
assert wait(lambda: here(1) and enable.service_is_ready() and reset.service_is_ready() and told, 20) is not None

def call(client, request, seconds):
    "The reply, and the seconds until it came; None for both if none came."
    future = client.call_async(request)
    waited = wait(future.done, seconds)
    return None if waited is None else [future.result().success, future.result().message, waited]

seconds = float(sys.argv[1])
answers = [call(enable, SetBool.Request(data=data), seconds) for data in (False, True, False)]
answers.append(call(reset, Trigger.Request(), seconds))
values = lambda: {pair.key: pair.value for pair in told[-1].status[0].values}
wait(lambda: int(values()["malformed"]) >= int(sys.argv[2]), 10)
print(json.dumps({"answers": answers, "malformed": values()["malformed"], "reconnects": values()["reconnects"]}))
"""


def test_services_answer_their_own_rmw(agent: RealAgent, build: Build) -> None:
    with boards(build("agent_jiwy"), agent, 1):
        told = ask(agent, "rmw_fastrtps_cpp", SERVED, 10, 0)
    assert isinstance(told, dict)
    assert [answer[:2] for answer in told["answers"]] == [
        [True, "disabled"],
        [True, "enabled"],
        [True, "disabled"],
        [True, "disabled, without a fault"],
    ]
    print(f"{agent.agent}: replies after {[round(1000 * answer[2]) for answer in told['answers']]} ms")
    assert (told["malformed"], told["reconnects"]) == ("0", "0")


def test_requests_of_the_other_rmw_are_counted(agent: RealAgent, build: Build) -> None:
    with boards(build("agent_jiwy"), agent, 1):
        told = ask(agent, "rmw_cyclonedds_cpp", SERVED, 1, 4)
    assert isinstance(told, dict)
    assert told["answers"] == [None] * 4
    assert (told["malformed"], told["reconnects"]) == ("4", "0")


TUNED = """
from rcl_interfaces.msg import ParameterEvent
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
events = []
node.create_subscription(ParameterEvent, "/parameter_events", events.append, 1000)
client = AsyncParameterClient(node, "/robot_1/JIWY_node")
assert wait(lambda: here(1) and client.services_are_ready() and node.count_publishers("/parameter_events") >= 2, 20)

def result(future):
    "The response of a service, and the seconds that it took."
    waited = wait(future.done, 10)
    assert waited is not None, "no response"
    return future.result(), waited

listed, *times = result(client.list_parameters())
names = list(listed.result.names)
read, seconds = result(client.get_parameters(names))
times.append(seconds)
wanted = [Parameter(name, value=value.double_value + 0.5) for name, value in zip(names, read.values)]
changed, seconds = result(client.set_parameters_atomically(wanted))
times.append(seconds)
again, seconds = result(client.get_parameters(names))
same = [value.double_value for value in again.values] == [parameter.value for parameter in wanted]
described, seconds = result(client.describe_parameters(names))
times.append(seconds)
refused, _ = result(client.set_parameters([Parameter("Pan.PID.kp", value=3)]))
own = lambda: [name.name for event in events if event.node == "/robot_1/JIWY_node" for name in event.changed_parameters]
wait(lambda: len(own()) >= len(names), 10)
print(json.dumps({
    "count": len(names),
    "described": [descriptor.name for descriptor in described.descriptors] == names,
    "changed": changed.result.successful,
    "same": same,
    "refused": [each.successful for each in refused.results],
    "events": sorted(own()) == sorted(names),
    "times": [round(1000 * each) for each in times],
}))
"""


def test_parameters_are_those_of_a_ros_node(agent: RealAgent, build: Build) -> None:
    """All parameters in each request, by rclpy."""
    with boards(build("agent_jiwy"), agent, 1):
        told = ask(agent, "rmw_fastrtps_cpp", TUNED)
    assert isinstance(told, dict)
    print(f"{agent.agent}: list, get, set, describe after {told.pop('times')} ms")
    assert told == {
        "count": 30,
        "described": True,
        "changed": True,
        "same": True,
        "refused": [False],
        "events": True,
    }
