# SPDX-License-Identifier: Apache-2.0
"""Writes the ROS 2 launch file for a set of agents."""

from __future__ import annotations

import json
from collections.abc import Sequence

from epg.ros.agents import Agent
from epg.ros.robot import Robot

FILE_NAME = "agents.launch.py"

_HEAD = '''\
"""Micro-ROS agents of {what}, written by `epg launch`.

    ros2 launch {file} [verbosity:=6]
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, SetEnvironmentVariable
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    verbosity = ["-v", LaunchConfiguration("verbosity")]
    return LaunchDescription(
        [
            DeclareLaunchArgument("verbosity", default_value="4", description="verbosity of the agents: 0 (none) to 6"),
            # Targets without a domain use that of the environment, like all other nodes.
            SetEnvironmentVariable(
                "XRCE_DOMAIN_ID_OVERRIDE", EnvironmentVariable("ROS_DOMAIN_ID", default_value="0")
            ),
'''

_NODE = """\
            {comment}
            Node(
                package="micro_ros_agent",
                executable="micro_ros_agent",
                name={name},
                arguments=[{arguments}, verbosity],
                output="screen",
                respawn=True,
                respawn_delay=1.0,
            ),
"""

_TAIL = """\
        ]
    )
"""


def launch_file(agents: Sequence[Agent], file: str = FILE_NAME) -> str:
    """The text of the launch file.  The same agents always give the same text."""
    names = dict.fromkeys(robot.name for agent in agents for robot in agent.serves)
    parts = [_HEAD.format(what=", ".join(names), file=file)]
    for agent in agents:
        comment = "\n            ".join(f"# {line}" for line in describe(agent))
        arguments = ", ".join(_quoted(argument) for argument in agent.arguments)
        parts.append(_NODE.format(comment=comment, name=_quoted(agent.name), arguments=arguments))
    return "".join([*parts, _TAIL])


def describe(agent: Agent) -> list[str]:
    """Lines for the user that name the robots of the agent and their topics."""
    return [f"{robot.full_node}: {_topics(robot)}" for robot in agent.serves]


def _topics(robot: Robot) -> str:
    subscribed = ", ".join(robot.topic(topic) for topic in robot.subscriptions if topic.role == "values")
    published = ", ".join(robot.topic(topic) for topic in robot.publications if topic.role == "values")
    return "; ".join(
        f"{verb} {topics}" for verb, topics in (("subscribes to", subscribed), ("publishes", published)) if topics
    )


def _quoted(text: str) -> str:
    """A string literal of Python.  Each string literal of JSON is one."""
    return json.dumps(text, ensure_ascii=False)
