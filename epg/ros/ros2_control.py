# SPDX-License-Identifier: Apache-2.0
"""Describes a target as hardware of ros2_control, for the plugin ``topic_based_ros2_control/TopicBasedSystem``.

The plugin publishes commands and receives states as sensor_msgs/msg/JointState, and finds joints by name.  Two of its
properties matter for safety.  Its commands are 0 until a controller is active, so the target must be enabled after the
controllers.  It sends a command only if the command differs from the state, unless ``trigger_joint_command_threshold``
is negative; without that, a robot that stands still would receive nothing, and its setpoints would time out.

Sources: topic_based_ros2_control 0.3, topic_based_system.cpp and doc/user.md; ros2_controllers of ROS 2 Jazzy,
parameters of joint_trajectory_controller and joint_state_broadcaster.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import yaml

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span
from epg.runs.robot import Robot, RobotTopic

_JOINT_STATE = "sensor_msgs/msg/JointState"
_QUANTITIES = ("position", "velocity", "effort")
_TRAJECTORY = "joint_trajectory_controller"
_BROADCASTER = "joint_state_broadcaster"


@dataclass(frozen=True)
class Joint:
    """A joint with the quantities that the target receives, and the quantities that it publishes."""

    name: str
    commands: tuple[str, ...]
    states: tuple[str, ...]


@dataclass(frozen=True)
class ControlledTarget:
    """A target as ros2_control sees it.  Topics have their full names; ``rate`` is in Hz."""

    name: str
    commands: str
    states: str
    enable: str
    rate: int
    joints: tuple[Joint, ...]


def hardware_of(robot: Robot, diagnostics: Diagnostics) -> ControlledTarget | None:
    """The target as hardware of ros2_control.  None, after errors, if it cannot be controlled safely in that way."""
    span = Span(str(robot.file))
    commands = _only(robot, robot.subscriptions, "subscribes to", "subscriber", diagnostics)
    states = _only(robot, robot.publications, "publishes", "publisher", diagnostics)
    if commands is not None and not (commands.timeout > 0 and commands.on_timeout == "disable"):
        message = f"'{commands.component}' keeps its last values when ros2_control stops"
        hint = "add timeout: 0.5 s and on_timeout: disable to this component of the .tcf"
        diagnostics.error("ros2-control-timeout", span, message, hint=hint)
    if robot.enable_at_start:
        message = "the target is enabled at its start, when the commands of ros2_control are still 0"
        hint = "set control.enable_at_start to false, and enable the target when its controllers are active"
        diagnostics.error("ros2-control-enabled", span, message, hint=hint)
    if commands is None or states is None:
        return None
    received, published = _joints(commands), _joints(states)
    for joint in received:
        if "position" not in published.get(joint, ()):
            message = f"'{states.component}' does not publish the position of the joint '{joint}'"
            hint = f"a trajectory begins at the measured position: bind a port of the model to '{joint}.position'"
            diagnostics.error("ros2-control-joint", span, message, hint=hint)
    return ControlledTarget(
        name=robot.name,
        commands=robot.topic(commands),
        states=robot.topic(states),
        enable=next((robot.topic(topic) for topic in robot.subscriptions if topic.role == "enable"), ""),
        rate=max(1, round(1 / robot.period)),
        joints=tuple(Joint(name, received.get(name, ()), states_of) for name, states_of in published.items()),
    )


def _only(
    robot: Robot, topics: Sequence[RobotTopic], verb: str, kind: str, diagnostics: Diagnostics
) -> RobotTopic | None:
    """The only topic with joints.  None, after an error, if there are none or several."""
    states = [topic for topic in topics if topic.type == _JOINT_STATE and topic.role == "values"]
    if len(states) == 1:
        return states[0]
    message = f"the target {verb} {len(states) or 'no'} topics of the type {_JOINT_STATE}, and ros2_control needs one"
    hint = f"use one component of the kind ros_joint_state_{kind} for all joints"
    diagnostics.error("ros2-control-topics", Span(str(robot.file)), message, hint=hint)
    return None


def _joints(topic: RobotTopic) -> dict[str, tuple[str, ...]]:
    """The bound quantities of each joint: {"pan": ("position",)}."""
    bound = {value.removeprefix(f"{topic.name}/") for value in topic.values}
    names = dict.fromkeys(element.rpartition(".")[0] for element in topic.elements)
    found = {name: tuple(part for part in _QUANTITIES if f"{name}.{part}" in bound) for name in names}
    return {name: parts for name, parts in found.items() if parts}


def xacro_file(hardware: ControlledTarget) -> str:
    """The macro ``<name>_ros2_control``, which the URDF includes.  Limits are those of the URDF's joints."""
    root = Element("robot", {"xmlns:xacro": "http://www.ros.org/wiki/xacro"})
    macro = SubElement(root, "xacro:macro", name=f"{hardware.name}_ros2_control")
    system = SubElement(macro, "ros2_control", name=hardware.name, type="system")
    plugin = SubElement(system, "hardware")
    SubElement(plugin, "plugin").text = "topic_based_ros2_control/TopicBasedSystem"
    for name, value in (
        ("joint_commands_topic", hardware.commands),
        ("joint_states_topic", hardware.states),
        ("trigger_joint_command_threshold", "-1"),
    ):
        SubElement(plugin, "param", name=name).text = value
    for joint in hardware.joints:
        element = SubElement(system, "joint", name=joint.name)
        for quantity in joint.commands:
            SubElement(element, "command_interface", name=quantity)
        for quantity in joint.states:
            SubElement(element, "state_interface", name=quantity)
    ElementTree.indent(root)
    return f'<?xml version="1.0"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'


def controllers_file(hardware: ControlledTarget) -> str:
    """Parameters of the controller manager: joint states, and trajectories for all joints with commands."""
    moved = [joint for joint in hardware.joints if joint.commands]
    trajectory = {
        "joints": [joint.name for joint in moved],
        "command_interfaces": _common([joint.commands for joint in moved]),
        "state_interfaces": [part for part in _common([joint.states for joint in moved]) if part != "effort"],
        "open_loop_control": False,  # a trajectory begins at the measured position
    }
    parameters = {
        "controller_manager": {
            "ros__parameters": {
                "update_rate": hardware.rate,
                _BROADCASTER: {"type": f"{_BROADCASTER}/JointStateBroadcaster"},
                _TRAJECTORY: {"type": f"{_TRAJECTORY}/JointTrajectoryController"},
            }
        },
        _TRAJECTORY: {"ros__parameters": trajectory},
    }
    return yaml.safe_dump(parameters, sort_keys=False)


def _common(quantities: Sequence[Sequence[str]]) -> list[str]:
    """The quantities that all joints have."""
    return [part for part in _QUANTITIES if all(part in found for found in quantities)]


def control_launch_file(hardware: ControlledTarget) -> str:
    """A launch file that makes the controllers active after the first joint state."""
    return _LAUNCH.format(
        name=hardware.name,
        states=json.dumps(hardware.states),
        enable=hardware.enable,
        broadcaster=_BROADCASTER,
        trajectory=_TRAJECTORY,
    )


_LAUNCH = '''\
"""ros2_control for {name}, written by `epg describe`.

    ros2 launch ./{name}.ros2_control.launch.py urdf:=<robot>.urdf.xacro

The target must be disabled until the controllers are active.  Then:

    ros2 service call {enable} std_srvs/srv/SetBool "{{data: true}}"
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, RegisterEventHandler
from launch.event_handlers import OnProcessExit
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

HERE = Path(__file__).resolve().parent
STATES = {states}


def generate_launch_description():
    hardware = str(HERE / "{name}.ros2_control.xacro")
    urdf = Command(["xacro ", LaunchConfiguration("urdf"), " ros2_control:=", hardware])
    description = {{"robot_description": ParameterValue(urdf, value_type=str)}}
    # A controller that is active before the first joint state takes 0 for the position of each joint.
    first_state = ExecuteProcess(
        cmd=["ros2", "topic", "echo", "--once", STATES, "sensor_msgs/msg/JointState"]
        + ["--qos-reliability", "best_effort"]
    )
    spawner = Node(package="controller_manager", executable="spawner", arguments=["{broadcaster}", "{trajectory}"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("urdf", description="URDF or xacro file of the robot"),
            Node(package="robot_state_publisher", executable="robot_state_publisher", parameters=[description]),
            Node(
                package="controller_manager",
                executable="ros2_control_node",
                parameters=[str(HERE / "{name}.controllers.yaml")],
                remappings=[("~/robot_description", "/robot_description")],
                output="screen",
            ),
            first_state,
            RegisterEventHandler(OnProcessExit(target_action=first_state, on_exit=[spawner])),
        ]
    )
'''
