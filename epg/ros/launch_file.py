# SPDX-License-Identifier: Apache-2.0
"""Writes the ROS 2 launch file for agents and host programs."""

from __future__ import annotations

import json
from collections.abc import Sequence

from epg.ros.agents import Agent
from epg.ros.programs import Program
from epg.runs.robot import Robot

FILE_NAME = "agents.launch.py"

_HEAD = '''\
"""{what} of {names}, written by `epg launch`.

    ros2 launch {file}{usage}
"""

from launch import LaunchDescription
from launch.actions import {actions}
from launch.substitutions import {substitutions}
from launch_ros.actions import Node

# Ctrl-C sends SIGINT.  A process that hangs gets SIGTERM after 3 s, and SIGKILL 2 s later.
END = {{"sigterm_timeout": "3", "sigkill_timeout": "2"}}


def generate_launch_description():
'''

_VERBOSITY = """\
    verbosity = ["-v", LaunchConfiguration("verbosity")]
"""

_BEGIN = """\
    return LaunchDescription(
        [
"""

_AGENTS = """\
            DeclareLaunchArgument("verbosity", default_value="4", description="verbosity of the agents: 0 (none) to 6"),
            # Targets without a domain use that of the environment, like all other nodes.
            SetEnvironmentVariable(
                "XRCE_DOMAIN_ID_OVERRIDE", EnvironmentVariable("ROS_DOMAIN_ID", default_value="0")
            ),
"""

_NODE = """\
            {comment}
            Node(
                package={program},
                executable={program},
                name={name},
                arguments=[{arguments}, verbosity],
                output="screen",
                respawn=True,
                respawn_delay=1.0,
                **END,
            ),
"""

_PROGRAM = """\
            DeclareLaunchArgument({argument}, default_value={namespace}, description={description}),
            {comment}
            Node(
                executable={executable},
                name={name},
                namespace=LaunchConfiguration({argument}),
{lists}                output="screen",
                **END,
            ),
"""

_TAIL = """\
        ]
    )
"""


def launch_file(agents: Sequence[Agent], programs: Sequence[Program] = (), file: str = FILE_NAME) -> str:
    """The text of the launch file.  The same agents and programs always give the same text."""
    robots = [*(robot for agent in agents for robot in agent.serves), *(program.robot for program in programs)]
    arguments = _argument_names(programs)
    parts = [_head(robots, agents, programs, arguments, file), _VERBOSITY if agents else "", _BEGIN]
    parts.append(_AGENTS if agents else "")
    for agent in agents:
        words = ", ".join(_quoted(argument) for argument in agent.arguments)
        program, name = _quoted(agent.program), _quoted(agent.name)
        parts.append(_NODE.format(comment=_comment(describe(agent)), program=program, name=name, arguments=words))
    parts += [_program(program, argument) for program, argument in zip(programs, arguments, strict=True)]
    return "".join([*parts, _TAIL])


def _head(
    robots: Sequence[Robot], agents: Sequence[Agent], programs: Sequence[Program], arguments: Sequence[str], file: str
) -> str:
    what = [text for text, items in (("agents", agents), ("host programs", programs)) if items]
    actions = ["DeclareLaunchArgument", *(["SetEnvironmentVariable"] if agents else [])]
    substitutions = [*(["EnvironmentVariable"] if agents else []), "LaunchConfiguration"]
    if any(not program.path.startswith("/") for program in programs):
        substitutions += ["PathJoinSubstitution", "ThisLaunchFileDir"]
    usage = " [verbosity:=6]" if agents else ""
    usage += "".join(f" [{argument}:=robot_2]" for argument in arguments)
    return _HEAD.format(
        what=_capital(" and ".join(what)),
        names=", ".join(dict.fromkeys(robot.name for robot in robots)),
        file=file,
        usage=usage,
        actions=", ".join(actions),
        substitutions=", ".join(substitutions),
    )


def _argument_names(programs: Sequence[Program]) -> list[str]:
    """The names of the launch arguments: ``jiwy_namespace``, and ``jiwy_2_namespace`` for a second program."""
    names: list[str] = []
    for program in programs:
        count = 1 + sum(name.startswith(f"{program.robot.name}_") for name in names)
        names.append(f"{program.robot.name}_namespace" if count == 1 else f"{program.robot.name}_{count}_namespace")
    return names


def _program(program: Program, argument: str) -> str:
    """The entry of one program.

    Its namespace has no leading slash, so that a launch file that includes this one can push a namespace before it.
    """
    robot = program.robot
    path = _quoted(program.path)
    words = ", ".join(_quoted(word) for word in program.arguments)
    rules = ", ".join(f"({_quoted(old)}, {_quoted(new)})" for old, new in program.remappings)
    lists = [
        f"                {key}=[{items}],\n" for key, items in (("arguments", words), ("remappings", rules)) if items
    ]
    return _PROGRAM.format(
        argument=_quoted(argument),
        namespace=_quoted(robot.namespace.lstrip("/")),
        description=_quoted(f"namespace of {robot.name}"),
        comment=_comment(_robot_lines([robot])),
        executable=path if program.path.startswith("/") else f"PathJoinSubstitution([ThisLaunchFileDir(), {path}])",
        name=_quoted(robot.node),
        lists="".join(lists),
    )


def _capital(text: str) -> str:
    return text[0].upper() + text[1:]


def _comment(lines: Sequence[str]) -> str:
    return "\n            ".join(f"# {line}" for line in lines)


def describe(agent: Agent) -> list[str]:
    """Lines for the user that name the robots of the agent and their topics."""
    return _robot_lines(agent.serves)


def _robot_lines(robots: Sequence[Robot]) -> list[str]:
    return [f"{robot.full_node}: {_topics(robot)}" for robot in robots]


def _topics(robot: Robot) -> str:
    subscribed = ", ".join(robot.topic(topic) for topic in robot.subscriptions if topic.role == "values")
    published = ", ".join(robot.topic(topic) for topic in robot.publications if topic.role == "values")
    return "; ".join(
        f"{verb} {topics}" for verb, topics in (("subscribes to", subscribed), ("publishes", published)) if topics
    )


def _quoted(text: str) -> str:
    """A string literal of Python.  Each string literal of JSON is one."""
    return json.dumps(text, ensure_ascii=False)
